"""Programs that end are started again, unless they say that they cannot be used as they are set."""

import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer

from actum.runtime.serving import TAKEN, UNUSABLE
from actum_command.commands.system_commands import supervise
from actum_command.model_in_use import ModelInUse, Reminder
from actum_command.supervising import ELSEWHERE_S, Program, Supervisor, UnusableError
from live import free_endpoint, wait_until

NOTHING_MISSING = Reminder(ModelInUse(Path("model.npz")), 0.0)


@pytest.fixture
def ending(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[type[Program]]:
    (tmp_path / "ending.py").write_text("import sys; print('mode: no such thing'); sys.exit(int(sys.argv[1]))")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    return Program


def outcome(supervisor: Supervisor) -> list[str]:
    lines: list[str] = []
    wait_until(lambda: bool(lines) or bool(lines.extend(supervisor.restart_ended())), "the supervisor notices")
    return lines


def test_what_ends_is_announced_and_started_again(ending: type[Program], tmp_path: Path) -> None:
    with Supervisor(tmp_path / "log") as supervisor:
        supervisor.start(ending("worker", "ending", ["1"]))
        assert outcome(supervisor) == ["worker ended with code 1 and restarts in 0.5 s"]


KILLED = """
import os, signal
from actum_command.supervising import Supervisor
running = Supervisor()
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_last_answers_of_a_killed_run_are_deleted_by_the_next(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with Supervisor():
        running = {*tmp_path.iterdir()}
        subprocess.run([sys.executable, "-c", KILLED], env={**os.environ, "TMPDIR": str(tmp_path)}, check=False)
        assert len(list(tmp_path.iterdir())) == 2
        with Supervisor():
            assert running < {*tmp_path.iterdir()} and len(list(tmp_path.iterdir())) == 2
    assert list(tmp_path.iterdir()) == []


def test_what_is_killed_is_another_process_afterwards(tmp_path: Path) -> None:
    (tmp_path / "waiting.py").write_text("import time; time.sleep(60)")
    waiting = Program("worker", "waiting", environment={"PYTHONPATH": str(tmp_path)})
    with Supervisor(tmp_path / "log") as supervisor:
        supervisor.start(waiting)
        first = supervisor.process_id(waiting)
        os.kill(first, signal.SIGKILL)
        outcome(supervisor)
        wait_until(lambda: supervisor.restart_ended() == [] and supervisor.process_id(waiting) != first, "it is back")
    with pytest.raises(KeyError):
        supervisor.process_id(waiting)


@pytest.mark.skipif(sys.platform == "win32", reason="has no process groups")
def test_a_terminals_interrupt_reaches_the_supervisor_alone(tmp_path: Path) -> None:
    (tmp_path / "waiting.py").write_text("import time; time.sleep(60)")
    waiting = Program("worker", "waiting", environment={"PYTHONPATH": str(tmp_path)})
    with Supervisor(tmp_path / "log") as supervisor:
        supervisor.start(waiting)
        assert os.getpgid(supervisor.process_id(waiting)) != os.getpgrp()


def test_what_runs_elsewhere_is_tried_again_now_and_then(
    ending: type[Program], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Supervisor(tmp_path / "log") as supervisor:
        supervisor.start(ending("worker", "ending", [str(TAKEN)]))
        assert outcome(supervisor) == ["worker already runs elsewhere: it starts here when that instance ends"]
        now_s = time.monotonic()
        monkeypatch.setattr(time, "monotonic", lambda: now_s + ELSEWHERE_S - 5)
        assert supervisor.restart_ended() == []
        assert (tmp_path / "log").read_text().count("\n") == 1
        monkeypatch.setattr(time, "monotonic", lambda: now_s + ELSEWHERE_S + 5)
        assert supervisor.restart_ended() == []
        monkeypatch.undo()
        wait_until(lambda: (tmp_path / "log").read_text().count("\n") == 2, "it was started again")


def test_what_cannot_be_used_as_it_is_set_is_not_started_again(ending: type[Program], tmp_path: Path) -> None:
    with Supervisor(tmp_path / "log") as supervisor:
        supervisor.start(ending("worker", "ending", [str(UNUSABLE)]))
        with pytest.raises(
            UnusableError,
            match=f"because one of its settings is wrong: see the error message of worker in {tmp_path / 'log'}",
        ):
            outcome(supervisor)
    assert (tmp_path / "log").read_text() == "mode: no such thing\n"


@pytest.mark.timeout(30)
def test_a_system_ends_with_the_line_of_the_program_that_cannot_be_used(
    ending: type[Program], capfd: pytest.CaptureFixture[str]
) -> None:
    with Supervisor() as supervisor, pytest.raises(typer.Exit) as ended:
        supervise(supervisor, [ending("worker", "ending", [str(UNUSABLE)])], threading.Event(), NOTHING_MISSING)
    told = capfd.readouterr()
    assert ended.value.exit_code == 1
    assert told.out == "mode: no such thing\n"
    assert "worker did not start, because one of its settings is wrong" in told.err


SUPERVISING = """
import sys, time
from actum_command.supervising import Program, Supervisor

with Supervisor() as supervisor:
    supervisor.start(Program(sys.argv[1], sys.argv[1], sys.argv[2:]))
    print(supervisor._children[0].process.pid, flush=True)
    time.sleep(600)
"""


def runs(pid: int) -> bool:
    """Whether a process is there and not merely waiting to be collected."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.mark.system
@pytest.mark.skipif(not Path("/proc/self").exists(), reason="looks for processes in /proc")
@pytest.mark.parametrize("program", [["pose_preprocessor"], ["actum_command", "scene"]])
def test_what_waits_for_a_router_ends_even_where_its_supervisor_is_killed(
    program: list[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("ACTUM_CONNECT", free_endpoint())
    log = tmp_path / "log"
    with log.open("w") as output:
        supervising = subprocess.Popen(
            [sys.executable, "-c", SUPERVISING, *program], stdout=output, stderr=subprocess.STDOUT
        )
    wait_until(lambda: log.read_text().endswith("waiting for a router\n"), "the child runs")
    child = int(log.read_text().split()[0])
    assert runs(child)
    supervising.kill()
    supervising.wait()
    try:
        wait_until(lambda: not runs(child), "the child has ended, too", patience_s=15)
    finally:
        if runs(child):
            os.kill(child, signal.SIGKILL)
