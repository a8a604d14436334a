"""The example programs, beside real processes, with nothing of ours imported."""

import ast
import runpy
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Truth
from live import System, collect

EXAMPLES = Path(__file__).parents[2] / "examples"
PLAIN = {"cv2", "msgpack", "numpy", "zenoh"}
ANSWERS = 3
pytestmark = pytest.mark.system


@pytest.fixture
def colour_tracker(running: System) -> Iterator[subprocess.Popen[bytes]]:
    """The example in the marker tracker's place."""
    running.start_router()
    with running.client(), (running.folder / "colour_tracker.log").open("wb") as output:
        process = subprocess.Popen(
            [sys.executable, EXAMPLES / "colour_tracker.py"],
            env=running.environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
        )
        yield process
        process.kill()
        process.wait()


@pytest.mark.long
def test_coloured_things_do_as_well_as_marked_ones(
    running: System, colour_tracker: subprocess.Popen[bytes], scene_model: Path
) -> None:
    others = ("pose_preprocessor", "som_classifier", "action_fusion")
    for name in others:
        running.start(name, *(("--model", str(scene_model)) if name == "som_classifier" else ()))
    running.start("actum_command", "scene")
    with running.client() as client:
        running.wait_for_services(client, *others)
        for topic in (keys.COLOR, keys.TRUTH, keys.OBJECTS):
            assert client.wait_for_subscriber(topic, timeout_s=20.0), topic
        events, truths = (client.listen(keys.pattern(topic, client.sensor)) for topic in (keys.EVENT, keys.TRUTH))
        running.start("scene_simulator", "--actor", "0", "--seed", "2", "--repetitions", "1")
        answered = collect(events, Event, lambda found: len(found) >= ANSWERS)
        done = {truth.segment_id: truth for truth in collect(truths, Truth, lambda found: len(found) >= 2 * ANSWERS)}
        assert not [key for key in client.alive() if "marker_tracker" in key]
    recognised = [event for event in answered if event.action == done[event.segment_id].action]
    objects = {event.segment_id: event.object and (event.object.id, event.object.name) for event in recognised}
    assert len(recognised) >= 2
    assert objects == {name: (done[name].object_id, done[name].object_name) for name in objects}
    assert colour_tracker.poll() is None


def test_the_colour_tracker_is_short_and_needs_nothing_of_ours() -> None:
    text = (EXAMPLES / "colour_tracker.py").read_text()
    imported = {name.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import) for name in node.names}
    assert len(text.splitlines()) < 100
    assert imported <= PLAIN | sys.stdlib_module_names
    assert not [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]


@pytest.mark.parametrize("data", [b"", b"no image"])
def test_the_colour_tracker_finds_nothing_in_a_broken_image(data: bytes) -> None:
    program = runpy.run_path(str(EXAMPLES / "colour_tracker.py"))
    assert program["objects"]({"format": "jpeg", "data": data}, {}) == []
