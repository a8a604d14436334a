"""Two hosts that share only the link of their routers: whatever that link does, the events are those of one host."""

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest
from benchmarks.rig.chain import Chain
from benchmarks.rig.tcp_proxy import TcpProxy

from actum import keys
from actum.messages import Event, Image, Message, Objects, Posture, Segment, Truth
from actum.runtime import Client, Listening
from actum_command.processes import simulated_objects
from actum_command.scene_marks import mark_of
from linked_routers import LinkedSystems, linked_systems
from live import PATIENCE_S, collect, wait_until
from scene_simulator.programme import Task
from scene_simulator.simulator import Simulator
from som_classifier.model_loading import load_model
from wire import without_seq

PROGRAMME = (Task("lift", 1), Task("push", 2))
IMAGE_HZ = 5
ANSWER_S = 30.0
IMAGE_FRAMES = 60  # two seconds; every sixth frame has an image
pytestmark = pytest.mark.system
Scene = list[list[Message]]
"""A scene's messages, frame by frame."""


def scene(session: str, start_ns: int) -> Scene:
    """Two actions with their marks, in a session of its own."""
    simulator = Simulator(PROGRAMME, 0, 5, image_hz=IMAGE_HZ, start_ns=start_ns, session_id=session, tail_s=1.5)
    return [[marked(message, session) for message in messages] for messages in simulator.frames()]


def marked(message: Message, session: str) -> Message:
    """A mark in the place of a truth."""
    if not isinstance(message, Truth):
        return message
    return mark_of(message).model_copy(update={"segment_id": f"{session}-{message.segment_id}"})


def on_one_host(model: Path, frames: Scene) -> list[Event]:
    """What is told where nothing lies between the services."""
    chain = Chain(load_model(model))
    outputs = [output for messages in frames for message in messages for output in chain.feed(message)]
    return [output for output in outputs if isinstance(output, Event)]


@pytest.fixture(scope="module")
def hosts(tmp_path_factory: pytest.TempPathFactory, scene_model: Path) -> Iterator[LinkedSystems]:
    """Tracker at the camera, all other services on the other host."""
    with linked_systems(tmp_path_factory.mktemp("hosts")) as made:
        made.camera.start("marker_tracker", "--objects", simulated_objects()["ACTUM_OBJECTS"])
        made.compute.start("pose_preprocessor")
        made.compute.start("som_classifier", "--model", str(scene_model))
        made.compute.start("action_fusion")
        with made.camera.client() as client:
            made.camera.wait_for_services(
                client, "marker_tracker", "pose_preprocessor", "som_classifier", "action_fusion"
            )
        yield made


def play(hosts: LinkedSystems, frames: Scene, disturb: Callable[[TcpProxy, threading.Event], None]) -> list[Event]:
    """Put a scene at the camera, its marks on the other host, each frame when it is due; return what is told there.

    The tracker, which is at the camera, leaves out an image when the next one is there before it has seen the first: so
    the next frame also waits for the objects of the image before it.
    """
    over = threading.Event()
    with hosts.camera.client() as camera, hosts.compute.client() as switch:
        events = switch.listen_back(keys.pattern(keys.EVENT, switch.sensor), 0.1)
        objects = camera.listen(keys.pattern(keys.OBJECTS, camera.sensor))
        for client, topic in ((camera, keys.SKELETON), (camera, keys.COLOR), (switch, keys.SEGMENT)):
            assert client.wait_for_subscriber(topic, PATIENCE_S)
        disturbing = threading.Thread(target=disturb, args=(hosts.link, over))
        disturbing.start()
        try:
            for message in paced(frames):
                (switch if isinstance(message, Segment) else camera).put(message)
                if isinstance(message, Image):
                    wait_until_seen(objects, message)
            expected = len(PROGRAMME)
            return collect(events, Event, lambda found: len(found) >= expected, ANSWER_S)
        finally:
            over.set()
            disturbing.join()
            hosts.link.delay(0.0)
            hosts.link.mend()


def wait_until_seen(objects: Listening, image: Image) -> None:
    collect(objects, Objects, lambda found: any(each.stamp_ns == image.stamp_ns for each in found))


def paced(frames: Scene) -> Iterator[Message]:
    """Yield each message when it is due."""
    began_s, first_ns = time.monotonic(), frames[0][0].stamp_ns
    for messages in frames:
        due_s = began_s + (messages[0].stamp_ns - first_ns) / 1e9
        threading.Event().wait(max(due_s - time.monotonic(), 0.0))
        yield from messages


def undisturbed(link: TcpProxy, over: threading.Event) -> None:
    """A cable as it should be."""


def delayed(link: TcpProxy, over: threading.Event) -> None:
    """A slow radio link."""
    link.delay(0.25, 0.2)


def stalling(link: TcpProxy, over: threading.Event) -> None:
    """A switch that lets nothing pass, again and again."""
    while not over.wait(0.7):
        link.stall(0.8)
        over.wait(0.8)


def cut_now_and_then(link: TcpProxy, over: threading.Event) -> None:
    """A loose plug."""
    while not over.wait(1.5):
        link.cut()
        over.wait(0.7)
        link.mend()


def cut_for_long(link: TcpProxy, over: threading.Event) -> None:
    """Somebody pulls the cable and puts it back five seconds later."""
    over.wait(2.0)
    link.cut()
    over.wait(5.0)
    link.mend()


OFTEN = (
    cut_for_long,
    *(pytest.param(disturb, marks=pytest.mark.thorough) for disturb in (undisturbed, cut_now_and_then)),
)
SELDOM = (pytest.param(delayed, marks=pytest.mark.long), pytest.param(stalling, marks=pytest.mark.long))


@pytest.mark.parametrize("disturb", (*OFTEN, *SELDOM), ids=lambda each: each.__name__)
def test_events_are_those_of_one_host(
    hosts: LinkedSystems, scene_model: Path, disturb: Callable[[TcpProxy, threading.Event], None]
) -> None:
    frames = scene(disturb.__name__, time.time_ns())
    expected = on_one_host(scene_model, frames)
    assert [event.valid for event in expected] == [True] * len(PROGRAMME)
    told = play(hosts, frames, disturb)
    assert without_seq(sorted(told, key=by_segment)) == without_seq(sorted(expected, key=by_segment))


def by_segment(event: Event) -> str:
    return event.segment_id


def test_images_cross_the_link_only_where_somebody_there_subscribes(hosts: LinkedSystems) -> None:
    with hosts.camera.client() as camera, hosts.compute.client() as viewer:
        postures = viewer.listen(keys.pattern(keys.POSTURE, viewer.sensor))
        assert camera.wait_for_subscriber(keys.COLOR, PATIENCE_S)
        alone = scene("without-viewer", time.time_ns())[:IMAGE_FRAMES]
        images_bytes = sum(len(each.data) for messages in alone for each in messages if isinstance(each, Image))
        crossing = bytes_crossing(hosts.link, alone, camera, postures)
        seen: list[object] = []
        viewer.tap(keys.pattern(keys.COLOR, viewer.sensor), seen.append)
        wait_until(lambda: crosses(camera, alone, seen), "the camera's host knows of the viewer")
        watched = scene("with-viewer", time.time_ns())[:IMAGE_FRAMES]
        crossing_to_viewer = bytes_crossing(hosts.link, watched, camera, postures)
    assert crossing < 0.5 * images_bytes, "only skeletons"
    assert crossing_to_viewer > images_bytes, "skeletons and images"


def bytes_crossing(link: TcpProxy, frames: Scene, camera: Client, postures: Listening) -> int:
    """How much crosses the link, in both directions, until the posture of a scene's last frame is on the other side."""
    before = sum(link.carried_bytes)
    for message in paced(frames):
        camera.put(message)
    last_ns = frames[-1][-1].stamp_ns
    collect(postures, Posture, lambda found: any(posture.stamp_ns == last_ns for posture in found))
    return sum(link.carried_bytes) - before


def crosses(camera: Client, frames: Scene, seen: Sequence[object]) -> bool:
    """Put an image; tell whether one has come to the viewer so far."""
    camera.put(next(message for message in frames[0] if isinstance(message, Image)))
    return bool(seen)
