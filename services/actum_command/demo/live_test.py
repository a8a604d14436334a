"""Simulated people who act one after another before router and services, each a process of its own, and are heard."""

import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from rich.markup import escape

from actum import keys
from actum.messages import Message
from actum.runtime import Client, Listening
from actum.settings import ServiceSettings
from actum_command import processes
from actum_command.supervising import Program, Supervisor

READY_S = 30.0  # enough for all processes to start, also on a slow machine
POLL_S = 0.01  # a third of a frame's interval
PAGE_S = 10.0  # the page's service starts in a second or two; the demo does without it
SUBSCRIBER_POLL_S = 0.5  # how soon a stop takes effect while the services start

Tell = Callable[[str], object]
"""Called with each line of console markup that says what has happened."""


class ExperimentError(RuntimeError):
    """The experiment did not finish; the text says why and names its log."""


class TerminatedError(Exception):
    """The experiment was asked to stop."""


def log_file(here: ServiceSettings) -> Path:
    """Return the path of the file for the output of the demo's processes."""
    return Path(tempfile.gettempdir()) / f"actum-demo-{here.instance}.log"


class Witness(Protocol):
    """Hears everything that is put while one person acts."""

    @property
    def longest_s(self) -> float:
        """Seconds after which nothing more can come."""
        ...

    @property
    def satisfied(self) -> bool:
        """Whether everything that has to come has come."""
        ...

    def receive(self, message: Message) -> list[str]:
        """Receive a message; return lines of console markup that say what has happened."""
        ...


@dataclass(frozen=True)
class Appearance:
    """One person's scene: the settings of the simulator by flag, and who hears what comes of it."""

    scene: Mapping[str, object]
    witness: Witness

    @property
    def arguments(self) -> list[str]:
        """The simulator's arguments."""
        return [word for flag, value in self.scene.items() for word in (flag, str(value))]


class LiveTest:
    """Runs router, services and simulated scene as processes of their own."""

    def __init__(self, here: ServiceSettings, stop: threading.Event, tell: Tell) -> None:
        self._here = here
        self._stop = stop
        self._tell = tell
        self._log = log_file(here)

    def run(self, programs: Sequence[Program], listened: keys.Topic, appearances: Iterable[Appearance]) -> None:
        """Start every program, and once somebody listens to a topic let one person after the other act.

        Raises:
            ExperimentError: the services do not come up.
            TerminatedError: the run was asked to stop.
            RouterUnreachableError, SettingsError, UnusableError: the processes cannot run as they are set.
        """
        with Supervisor(self._log) as supervisor:
            supervisor.start(processes.router(self._here), *programs)
            with Client(self._here, READY_S) as client:
                self._wait_until_ready(client, listened)
                if processes.PAGE in {program.name for program in programs}:
                    self._tell_page(client)
                self._tell(f"router, {', '.join(processes.SERVICES)} and scene_simulator run as processes of their own")
                listening = client.listen(keys.everything(self._here.sensor))
                for appearance in appearances:
                    simulator = processes.simulator(self._here, appearance.arguments)
                    supervisor.start(simulator)
                    self._hear(listening, appearance.witness, supervisor)
                    supervisor.end(simulator)

    def _wait_until_ready(self, client: Client, listened: keys.Topic) -> None:
        deadline_s = time.monotonic() + READY_S
        while time.monotonic() < deadline_s:
            self._end_if_stopped()
            running = {key.split("/")[-2] for key in client.alive()}
            if running >= set(processes.SERVICES) and client.wait_for_subscriber(listened, SUBSCRIBER_POLL_S):
                return
        raise ExperimentError(f"some services did not start within {READY_S:g} s: see the log {self._log}")

    def _tell_page(self, client: Client) -> None:
        deadline_s = time.monotonic() + PAGE_S
        while time.monotonic() < deadline_s:
            self._end_if_stopped()
            for page in (info.page for info in client.infos() if info.page is not None):
                self._tell(f"watch it in a browser: [bold]{escape(page)}[/bold]")
                return
            time.sleep(SUBSCRIBER_POLL_S)

    def _hear(self, listening: Listening, witness: Witness, supervisor: Supervisor) -> None:
        """Let a witness hear what is put until it is satisfied, or the person takes too long."""
        deadline_s = time.monotonic() + witness.longest_s + READY_S
        while not witness.satisfied and time.monotonic() < deadline_s:
            self._end_if_stopped()
            received = listening.receive()
            if received is None:
                time.sleep(POLL_S)
                for ended in supervisor.restart_ended():
                    self._tell(f"[yellow]{escape(ended)}[/yellow]")
            elif received.message is not None:
                for line in witness.receive(received.message):
                    self._tell(line)

    def _end_if_stopped(self) -> None:
        if self._stop.is_set():
            raise TerminatedError
