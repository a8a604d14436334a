"""Child processes, kept alive and stopped together."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import IO, Self

from actum.run_folder import RunFolder
from actum.runtime.serving import TAKEN, UNUSABLE
from actum.runtime.stopping import PARENT

STATE = "ACTUM_STATE"
"""The environment variable with the folder in which services keep their last answers."""

RESTART_S = (0.5, 1.0, 2.0, 4.0, 8.0)
"""The back-off (s): how long a program that has ended waits for its first, second … restart."""

ELSEWHERE_S = 30.0
"""Interval (s) between attempts to start a service that runs elsewhere already."""

STEADY_S = 30.0
"""A program that has run for this long (s) restarts with the shortest back-off."""

TERM_S = 5.0
"""How long (s) a program may take to end after SIGTERM, before it is killed."""


class UnusableError(RuntimeError):
    """A program that cannot run with its settings; the text names it and says where its output is."""


@dataclass(frozen=True)
class Program:
    """A Python module to run as a process of its own, with its environment."""

    name: str
    module: str
    arguments: Sequence[str] = ()
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass
class _Child:
    program: Program
    process: subprocess.Popen[bytes]
    started_s: float
    restarts: int = 0
    due_s: float | None = None


class Supervisor:
    """Starts programs, restarts those that end by themselves, and stops all at the end.

    Programs end with this process, even if it is killed. Their output goes to `log`, or to this process's own output.
    Services keep their last answers in a folder of this run, so that one that is restarted goes on where it ended.
    """

    def __init__(self, log: Path | None = None) -> None:
        self._log: IO[bytes] | None = log.open("ab") if log else None
        self._state = RunFolder("actum-state-")
        self._children: list[_Child] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        self.stop()

    def start(self, *programs: Program) -> None:
        """Start programs, one after the other."""
        for program in programs:
            self._children.append(_Child(program, self._spawn(program), time.monotonic()))

    def pids(self) -> dict[int, str]:
        """Return the names of the programs by their processes' ids."""
        return {child.process.pid: child.program.name for child in self._children}

    def restart_ended(self) -> list[str]:
        """Restart what has ended, with back-off; return a line for each program that has ended since the last call.

        Raises:
            UnusableError: a program's settings or arguments cannot be used.
        """
        lines = []
        now_s = time.monotonic()
        for child in self._children:
            if child.due_s is None and child.process.poll() is not None:
                lines.append(self._ended(child, now_s))
            elif child.due_s is not None and now_s >= child.due_s:
                child.process, child.started_s, child.due_s = self._spawn(child.program), now_s, None
                child.restarts += 1
        return lines

    def _ended(self, child: _Child, now_s: float) -> str:
        """Schedule the restart of a program that has ended, and return a line that says so."""
        if child.process.returncode == UNUSABLE:  # a restart would end the same way
            where = f"in {self._log.name}" if self._log else "above"
            raise UnusableError(
                f"{child.program.name} did not start, because one of its settings is wrong: see the error message of "
                f"{child.program.name} {where}"
            )
        if child.process.returncode == TAKEN:
            child.due_s = now_s + ELSEWHERE_S
            return f"{child.program.name} already runs elsewhere: it starts here when that instance ends"
        steady = now_s - child.started_s > STEADY_S
        child.restarts = 0 if steady else child.restarts
        delay_s = RESTART_S[min(child.restarts, len(RESTART_S) - 1)]
        child.due_s = now_s + delay_s
        return f"{child.program.name} ended with code {child.process.returncode} and restarts in {delay_s:g} s"

    def process_id(self, program: Program) -> int:
        """Return the id of the process that runs a program, or of the last one that did.

        Raises:
            KeyError: it was never started, or was ended.
        """
        return {id(child.program): child.process.pid for child in self._children}[id(program)]

    def end(self, program: Program) -> None:
        """Stop one program for good."""
        ending = [child for child in self._children if child.program is program]
        self._children = [child for child in self._children if child.program is not program]
        stop_processes([child.process for child in ending])

    def stop(self) -> None:
        """Send every process SIGTERM, and kill those that do not end."""
        stop_processes([child.process for child in self._children])
        self._children.clear()
        self._state.delete()
        if self._log:
            self._log.close()
            self._log = None

    def _spawn(self, program: Program) -> subprocess.Popen[bytes]:
        return subprocess.Popen(
            [sys.executable, "-m", program.module, *program.arguments],
            env={STATE: str(self._state.path), **os.environ, **program.environment, PARENT: str(os.getpid())},
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=subprocess.STDOUT if self._log else None,
            process_group=0,  # a terminal's Ctrl-C then reaches this process alone, which ends the others with SIGTERM
        )


def stop_processes(processes: Sequence[subprocess.Popen[bytes]]) -> None:
    """Send processes SIGTERM together, and kill those that do not end within `TERM_S`."""
    for process in processes:
        if process.poll() is None:
            process.send_signal(signal.SIGTERM)
    deadline_s = time.monotonic() + TERM_S
    for process in processes:
        try:
            process.wait(timeout=max(deadline_s - time.monotonic(), 0.01))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
