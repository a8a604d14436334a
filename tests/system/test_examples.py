"""The example programs, beside real processes, with nothing of ours imported."""

import ast
import runpy
import subprocess
import sys
from collections.abc import Iterator
from itertools import count
from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Intent, Truth
from empty_messages import contact, intent
from live import System, collect, wait_until
from people import FRAME_NS

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


@pytest.mark.parametrize("name", ["colour_tracker.py", "handover.py"])
def test_an_example_is_short_and_needs_nothing_of_ours(name: str) -> None:
    text = (EXAMPLES / name).read_text()
    imported = {name.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import) for name in node.names}
    assert len(text.splitlines()) < 100
    assert imported <= PLAIN | sys.stdlib_module_names
    assert not [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]


@pytest.mark.parametrize("data", [b"", b"no image"])
def test_the_colour_tracker_finds_nothing_in_a_broken_image(data: bytes) -> None:
    program = runpy.run_path(str(EXAMPLES / "colour_tracker.py"))
    assert program["objects"]({"format": "jpeg", "data": data}, {}) == []


def reach(probability: float | None, contact_s: float = 0.5, frame: int = 0, agent: int = 1) -> Intent:
    """An intent of a frame; None for one that ends a reach."""
    contacts = [] if probability is None else [contact(probability, contact_s=contact_s)]
    return intent(frame * FRAME_NS, *contacts, agent=agent)


def targets(*intents: Intent) -> list[int]:
    """Return at which of the intents the gripper moves."""
    target, reaches = runpy.run_path(str(EXAMPLES / "handover.py"))["target"], {}
    return [i for i, each in enumerate(intents) if target(each.model_dump(), reaches) is not None]


@pytest.mark.parametrize(
    ("probability", "contact_s", "moves"), [(0.8, 0.3, True), (0.79, 1.0, False), (1.0, 0.29, False)]
)
def test_the_gripper_moves_where_a_contact_is_likely_and_far_enough_ahead(
    probability: float, contact_s: float, moves: bool
) -> None:
    assert targets(reach(probability, contact_s)) == ([0] if moves else [])


def test_the_gripper_moves_once_in_a_reach_and_again_in_the_next() -> None:
    probabilities = (0.5, 0.9, 0.9, 0.4, 0.9, None, 0.9, 0.9)
    assert targets(*(reach(p, frame=i) for i, p in enumerate(probabilities))) == [1, 6]


def test_after_a_person_was_lost_from_view_the_gripper_moves_again() -> None:
    assert targets(*(reach(0.9, frame=frame) for frame in (0, 1, 30, 31))) == [0, 2]


def test_for_each_of_two_people_the_gripper_moves_once() -> None:
    assert targets(*(reach(0.9, frame=i, agent=1 + i % 2) for i in range(6))) == [0, 1]


def test_the_handover_prints_where_a_hand_will_be_once_for_each_reach(running: System) -> None:
    running.start_router()
    printed = running.folder / "handover.txt"
    frames = count()
    with running.client() as client, printed.open("w") as output:

        def is_printed(lines: int) -> bool:
            client.put(reach(0.9, frame=next(frames)))
            return printed.read_text() == lines * "gripper to 0.10 0.20 1.50 for cup\n"

        process = subprocess.Popen([sys.executable, EXAMPLES / "handover.py"], env=running.environment, stdout=output)
        try:
            wait_until(lambda: is_printed(1), "the place is printed, once the program has subscribed")
            assert all(is_printed(1) for _ in range(10))
            client.put(reach(None, frame=next(frames)))
            wait_until(lambda: is_printed(2), "the place of the next reach is printed")
            assert process.poll() is None
        finally:
            process.kill()
            process.wait()
