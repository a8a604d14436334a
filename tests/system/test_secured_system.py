"""The whole system, each service with its own role on two hosts whose routers ask: it does what it does without."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import Event, Status
from actum.runtime import Client, Listening
from actum.runtime.serving import TAKEN
from actum_command.doctor.diagnosis import EXPECTED
from actum_command.simulated_model import SIMULATED_MODEL
from deployments import Deployed, deployed
from events import event
from live import FEW_IMAGES_HZ, PATIENCE_S, Running, collect, wait_until

pytestmark = [pytest.mark.system, pytest.mark.timeout(300)]
ACTIONS = 5
"""Of one repetition of the simulated scene."""
SCENE_S = 60.0
"""The scene lasts twenty seconds, where nothing else keeps the machine busy."""
BEHIND = ("pose_preprocessor", "action_fusion", "model_trainer", "web_dashboard")


def start_all(running: Deployed, model: Path) -> None:
    """Everything but the scene and who marks it: the tracker beside the camera, the rest on the other host."""
    running.start("marker_tracker", "camera")
    running.start("som_classifier", "compute", "--model", str(model))
    for module in BEHIND:
        running.start(module, "compute")


def wait_for_all(running: Deployed, client: Client) -> None:
    started = {*EXPECTED, "model_trainer", "web_dashboard"} - {"sensor_gateway"}
    wait_until(lambda: {key.split("/")[-2] for key in client.alive()} == started, f"{started} are alive")


def events_of_the_scene(running: Deployed, client: Client) -> list[Event]:
    events = client.listen(keys.pattern(keys.EVENT, client.sensor))
    switch = running.actum("switch", "camera", "scene")
    with running.client("switch", "camera") as beside:
        assert beside.wait_for_subscriber(keys.TRUTH, PATIENCE_S)
    running.start("scene_simulator", "camera", "--repetitions", "1")
    found = collect(events, Event, lambda found: len(found) >= ACTIONS, SCENE_S)
    switch.terminate()
    return found


def as_told(events: list[Event]) -> list[tuple[object, ...]]:
    """What is told of each segment, but for what hangs on when the scene began, or on which images are read in time."""
    return sorted(told(event) for event in events)


def told(event: Event) -> tuple[object, ...]:
    assert event.object is not None
    what = event.object.id, event.object.name
    lasted_ns = event.end_ns - event.start_ns
    sure = round(event.confidence, 6)
    return event.segment_id, event.agent, event.action, sure, *what, event.outcome, event.agrees, lasted_ns


@pytest.fixture(scope="module")
def told_without_security(scene_model: Path, tmp_path_factory: pytest.TempPathFactory) -> list[tuple[object, ...]]:
    with deployed(tmp_path_factory.mktemp("open"), secured=False) as running:
        start_all(running, scene_model)
        with running.client("viewer", "camera") as viewer:
            wait_for_all(running, viewer)
            return as_told(events_of_the_scene(running, viewer))


@pytest.mark.long
def test_the_events_are_the_same_and_whoever_may_sees_them(
    scene_model: Path, told_without_security: list[tuple[object, ...]], tmp_path: Path
) -> None:
    with deployed(tmp_path, passwords=True) as running:
        start_all(running, scene_model)
        watch = running.actum("viewer", "compute", "watch", "--json")
        with running.client("viewer", "camera") as viewer, running.client("recorder", "compute") as recorder:
            images = recorder.listen(keys.pattern(keys.COLOR))
            statuses = viewer.listen(keys.pattern(keys.STATUS))
            wait_for_all(running, viewer)
            found = events_of_the_scene(running, viewer)
            assert as_told(found) == told_without_security
            assert all(event.valid and event.object for event in found)
            wait_until(lambda: watch.said().count('{"key"') == ACTIONS, "a viewer's program printed every event")
            assert images.receive() is None
            assert {info.service for info in viewer.infos()} >= {*EXPECTED, "model_trainer", "web_dashboard"}
            collect(statuses, Status, lambda found: any(status.state.startswith("source ended") for status in found))
        doctor = running.actum("viewer", "compute", "doctor")
        doctor.process.wait(timeout=PATIENCE_S)
        assert "source ended" in doctor.said()
        assert "not running" not in doctor.said()


def test_marks_by_hand_are_answered_and_there_is_one_of_each_service(scene_model: Path, tmp_path: Path) -> None:
    with deployed(tmp_path) as running:
        start_all(running, scene_model)
        running.start("scene_simulator", "camera", "--image-hz", "0")
        with running.client("viewer", "camera") as viewer:
            events = viewer.listen(keys.pattern(keys.EVENT, viewer.sensor))
            wait_for_all_but_marks(viewer)
            mark(running, "start")
            skeletons = viewer.listen(keys.pattern(keys.SKELETON, viewer.sensor))
            wait_until(lambda: skeletons.receive() is not None, "frames come")
            collect_frames(skeletons, 60)
            mark(running, "end")
            [event] = collect(events, Event, bool, SCENE_S)
            assert event.segment_id == "by-hand"
            fusion = next(each for each in running.running if each.log.name.startswith("action_fusion"))
            assert_second_is_refused(running, fusion)


def test_one_process_of_each_service_recognises_for_all_of_its_sensors_and_may_speak_for_no_other(
    tmp_path: Path,
) -> None:
    with deployed(tmp_path, sensors=("left", "right"), passwords=True) as running:
        for module in ("pose_preprocessor", "action_fusion"):
            running.start(module, "compute", sensor="left,right")
        running.start("som_classifier", "compute", "--model", str(SIMULATED_MODEL), sensor="left,right")
        for host, sensor in (("camera", "left"), ("camera-right", "right")):
            running.start("marker_tracker", host, sensor=sensor)
            running.start("scene_simulator", host, "--image-hz", FEW_IMAGES_HZ, sensor=sensor)
        with running.client("viewer", "compute", "left") as viewer:
            for sensor in ("left", "right"):
                events = viewer.listen(keys.pattern(keys.EVENT, sensor))
                found = collect(events, Event, lambda found: any(each.valid and each.object for each in found), SCENE_S)
                assert {each.sensor for each in found} == {sensor}
            everything = viewer.listen(keys.pattern(keys.EVENT))
            with running.client("fusion.left+right", "compute", "left") as fusion:
                for sensor in ("other", "left"):
                    fusion.put(event("put-last", "a sentence").model_copy(update={"sensor": sensor}))
                heard = collect(
                    everything, Event, lambda heard: any(each.segment_id == "put-last" for each in heard), SCENE_S
                )
            assert {each.sensor for each in heard} <= {"left", "right"}


def wait_for_all_but_marks(viewer: Client) -> None:
    wait_until(lambda: len(viewer.infos()) == len(EXPECTED) + 2, "all services say what they are")


def mark(running: Deployed, kind: str) -> None:
    marking = running.actum("switch", "compute", "segment", kind, "by-hand")
    assert marking.process.wait(timeout=PATIENCE_S) == 0, marking.said()


def collect_frames(listening: Listening, count: int) -> None:
    taken = 0

    def enough() -> bool:
        nonlocal taken
        while listening.receive() is not None:
            taken += 1
        return taken >= count

    wait_until(enough, f"{count} frames come")


def assert_second_is_refused(running: Deployed, first: Running) -> None:
    second = running.start("action_fusion", "compute", "--instance", "a-second")
    assert second.process.wait(timeout=PATIENCE_S) == TAKEN
    successor = running.start("action_fusion", "compute", "--instance", "a-third", "--take-over")
    assert first.process.wait(timeout=PATIENCE_S) == 0
    assert successor.process.poll() is None
