"""Teaching by real queries to real processes, a kill at any moment, and a classifier that takes the model."""

import subprocess
import sys
import threading
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

import pytest

from actum.recording import Recording
from actum.runtime import NotAnsweredError
from actum_examples.take import read_take
from live import PATIENCE_S, System, wait_until
from model_trainer.set_store import MAKING
from people import reaches
from teaching import mark

EXAMPLE = Path(__file__).parents[2] / "examples" / "teach_by_queries.py"
KILLS = 8
pytestmark = pytest.mark.system


@pytest.mark.long
@pytest.mark.timeout(240)
def test_three_actions_are_taught_and_recognised_by_queries_alone(running: System) -> None:
    running.start_router()
    model = running.folder / "in-use.npz"
    for name in ("pose_preprocessor", "action_fusion"):
        running.start(name)
    running.start("som_classifier", "--model", str(model))
    running.start("model_trainer", "--model", str(model))
    running.start("scene_simulator", "--driven", "--image-hz", "0")
    with running.client() as client:
        running.wait_for_services(client, "pose_preprocessor", "action_fusion", "som_classifier", "model_trainer")
        running.wait_for_services(client, "sensor_gateway")
    done = subprocess.run(
        [sys.executable, str(EXAMPLE), running.settings.connect, running.settings.sensor],
        env={"PATH": "/usr/bin"},
        capture_output=True,
        text=True,
        timeout=220,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    assert lines.count("  5 of 5") == 3
    assert [line for line in lines if line.startswith("recognised")] == [
        "recognised: lift",
        "recognised: push",
        "recognised: put",
    ]


@pytest.mark.thorough
def test_a_trainer_that_is_killed_at_any_moment_leaves_whole_files(running: System) -> None:
    """Sets are made, renamed and filled, examples mended, while the process is killed again and again."""
    running.start_router()
    folder = running.folder / "teaching"
    with running.client() as client:
        for attempt in range(KILLS):
            trainer = running.start("model_trainer", "--take-over")
            running.wait_for_services(client, "model_trainer")
            sent = threading.Semaphore(0)
            asking = threading.Thread(target=busy, args=(running, attempt, sent), daemon=True)
            asking.start()
            for _ in range(1 + 3 * attempt):
                assert sent.acquire(timeout=PATIENCE_S), "the trainer answers"
            trainer.process.kill()
            trainer.process.wait()
            asking.join(timeout=20)
            taken = [take for take in (folder / "sets").glob("*/*.mcap") if take.parent.name != MAKING]
            assert all(read_take(Recording(take)).examples for take in taken)
        running.start("model_trainer", "--take-over")
        running.wait_for_services(client, "model_trainer")
        listed = client.ask("model_trainer", "list")
        assert listed["sets"] and not [each for each in listed["sets"] if each["unreadable"]]
        assert sum(len(each["takes"]) for each in listed["sets"]) >= KILLS
    assert not list(folder.rglob("*.part")) and not (folder / "sets" / MAKING).exists(), "what was unfinished is gone"


def busy(running: System, attempt: int, sent: threading.Semaphore) -> None:
    """Teach and mend without a pause, until nobody answers any more; release `sent` before each command."""
    name = f"set {attempt}"
    with running.client() as client, suppress(NotAnsweredError):

        def ask(command: str, **fields: Any) -> Any:
            sent.release()
            return client.ask("model_trainer", command, timeout_s=2, **fields)

        def recording() -> Any:
            return client.ask("model_trainer", "state", timeout_s=2)["recording"]

        ask("create_set", set=name)
        for number in count():
            ask("record", set=name, label="wave", count=2)
            first_ns = (number + 1) * 10**10
            for frame in reaches(30, first_ns):
                client.put(frame.model_copy(update={"seq": None}))
            wait_until(lambda: recording()["seconds"] > 0.7, "the frames have come")
            client.put(mark("start", f"s{number}", first_ns + 3 * 10**8))
            client.put(mark("end", f"s{number}", first_ns + 7 * 10**8))
            wait_until(lambda: recording()["counted"] == 1, "the marks have come")
            ask("stop")
            for example in ask("examples", set=name)["examples"]:
                ask("relabel", set=name, example=example["id"], label=f"wave {number}")
                ask("mirror", set=name, example=example["id"])
