"""Teaching by real queries to real processes, a kill at any moment, and a classifier that takes the model."""

import subprocess
import sys
import threading
from itertools import count
from pathlib import Path

import pytest

from actum.commands import Refusal
from actum.messages import Message
from actum.recording import Recording
from actum.runtime import NotAnsweredError
from actum_examples.take import read_take
from live import System
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


def test_a_trainer_that_is_killed_at_any_moment_leaves_whole_files(running: System) -> None:
    """Sets are made, renamed and filled, examples mended, while the process is killed again and again."""
    running.start_router()
    folder = running.folder / "teaching"
    with running.client() as client:
        for attempt in range(KILLS):
            trainer = running.start("model_trainer", "--take-over")
            running.wait_for_services(client, "model_trainer")
            asking = threading.Thread(target=busy, args=(running, attempt), daemon=True)
            asking.start()
            threading.Event().wait(0.05 + 0.11 * attempt)
            trainer.process.kill()
            trainer.process.wait()
            asking.join(timeout=20)
            taken = [take for take in (folder / "sets").glob("*/*.mcap") if take.parent.name != MAKING]
            assert all(read_take(Recording(take)).examples for take in taken)
        running.start("model_trainer", "--take-over")
        running.wait_for_services(client, "model_trainer")
        listed = client.ask("model_trainer", "list")
        assert listed["sets"] and not [each for each in listed["sets"] if each["unreadable"]]
        assert sum(len(each["takes"]) for each in listed["sets"]) > 1
    assert not list(folder.rglob("*.part")) and not (folder / "sets" / MAKING).exists(), "what was unfinished is gone"


def busy(running: System, attempt: int) -> None:
    """Teach and mend without a pause, until nobody answers any more."""
    try:
        with running.client() as client:
            name = f"set {attempt}"
            client.ask("model_trainer", "create_set", timeout_s=2, set=name)
            for number in count():
                client.ask("model_trainer", "record", timeout_s=2, set=name, label="wave", count=2)
                for message in marked_wave(number):
                    client.put(message)
                client.ask("model_trainer", "stop", timeout_s=2)
                for example in client.ask("model_trainer", "examples", timeout_s=2, set=name)["examples"]:
                    names = {"set": name, "example": example["id"]}
                    client.ask("model_trainer", "relabel", timeout_s=2, label=f"wave {number}", **names)
                    client.ask("model_trainer", "mirror", timeout_s=2, **names)
    except (Refusal, NotAnsweredError):
        return


def marked_wave(number: int) -> list[Message]:
    """A second of frames with marks about its middle."""
    first_ns = (number + 1) * 10**10
    frames = reaches(30, first_ns)
    marks = [mark("start", f"s{number}", first_ns + 3 * 10**8), mark("end", f"s{number}", first_ns + 7 * 10**8)]
    return [*(frame.model_copy(update={"seq": None}) for frame in frames), *marks]
