"""A real person in a video: from the camera to the event, through live processes."""

import shutil
from functools import partial
from pathlib import Path

import cv2
import numpy as np
import pytest

from actum import keys
from actum.messages import Event, Image, Objects, Segment, Skeleton, Status
from actum.recording import Recording
from actum.runtime import Client, Listening
from actum_dataset_importer.clips import Naming
from actum_dataset_importer.importing import import_video
from actum_model_trainer.sample_reading import samples_from, select
from actum_model_trainer.training import train
from live import System, collect, wait_until
from models import QUICK
from sensor_gateway.optics import Optics
from sensor_gateway.people.pose_estimator import PoseEstimator

pytestmark = [pytest.mark.system, pytest.mark.pose_model, pytest.mark.data]

PATTERN = r".*actor(?P<person>\d+)idAction\d+category(?P<action>\d+)"
NAMES = "1=wave,6=sit down,9=bow"
PLAYED = "GestureRecording_Id1actor1idAction1category1.mp4"


@pytest.fixture(scope="module")
def clips(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three actions of people 2 to 6, once each."""
    folder = tmp_path_factory.mktemp("clips")
    for person in range(2, 7):
        for action in (1, 6, 9):
            for clip in sorted((data / "florence3d_rgb").glob(f"*actor{person}id*category{action}.mp4"))[:1]:
                shutil.copy(clip, folder)
    return folder


@pytest.fixture(scope="module")
def model(clips: Path, pose_model: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("imported")
    import_video(
        clips,
        folder,
        lambda _done, _total: None,
        naming=Naming.of(PATTERN, NAMES),
        optics=Optics(),
        opened=partial(PoseEstimator, pose_model, 1),
    )
    train(samples_from(select([folder])).usable, QUICK).save(folder / "model.npz")
    return folder / "model.npz"


def start_chain(running: System, client: Client, model: Path) -> None:
    running.start("pose_preprocessor")
    running.start("som_classifier", "--model", str(model))
    running.start("action_fusion")
    running.wait_for_services(client, "pose_preprocessor", "som_classifier", "action_fusion")
    for topic in (keys.SKELETON, keys.SEGMENT):
        assert client.wait_for_subscriber(topic, 10.0)


def frames_until_the_end(statuses: Listening, skeletons: Listening) -> list[Skeleton]:
    collect(statuses, Status, lambda found: any(status.state == "source ended" for status in found))
    return collect(skeletons, Skeleton, bool)


def mark(client: Client, kind: str, stamp_ns: int) -> None:
    client.put(Segment(stamp_ns=stamp_ns, sensor=client.sensor, kind=kind, segment_id="played"))


@pytest.mark.long
def test_a_strangers_action_in_a_clip_is_recognised(running: System, data: Path, model: Path) -> None:
    running.start_router()
    with running.client() as client:
        start_chain(running, client, model)
        skeletons = client.listen(keys.pattern(keys.SKELETON, client.sensor))
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "sensor_gateway"))
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        running.start("sensor_gateway", "--source", "camera", "--camera", str(data / "florence3d_rgb" / PLAYED))
        frames = frames_until_the_end(statuses, skeletons)
        mark(client, "start", frames[0].stamp_ns)
        mark(client, "end", frames[-1].stamp_ns)
        [event] = collect(events, Event, bool)
    assert len(frames) == 27, "no frame of a file is left out"
    assert (event.valid, event.reason, event.action, event.agent) == (True, None, "wave", 1)
    assert (event.frames, event.missed) == (27, 0)


def test_the_same_pictures_feed_the_marker_tracker(running: System, tmp_path: Path) -> None:
    video = with_marker(tmp_path / "marker.avi")
    running.start_router()
    with running.client() as client:
        running.start("marker_tracker", "--objects", '{"7": {"name": "cup"}}')
        running.wait_for_services(client, "marker_tracker")
        assert client.wait_for_subscriber(keys.COLOR, 10.0)
        images = client.listen(keys.pattern(keys.COLOR, client.sensor))
        objects = client.listen(keys.pattern(keys.OBJECTS, client.sensor))
        running.start("sensor_gateway", "--source", "camera", "--camera", str(video))
        [image, *_] = collect(images, Image, bool)
        seen = collect(objects, Objects, lambda found: any(message.objects for message in found))
    assert image.intrinsics_assumed
    [cup] = next(message.objects for message in seen if message.objects)
    assert (cup.id, cup.name) == (7, "cup")


def with_marker(path: Path) -> Path:
    """Write a video of a marker before a wall."""
    marker = cv2.aruco.generateImageMarker(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50), 7, 120)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10, (640, 480))
    for i in range(20):
        picture = np.full((480, 640, 3), 220, np.uint8)
        picture[180:300, 200 + i : 320 + i] = marker[:, :, None]
        writer.write(picture)
    writer.release()
    return path


def test_a_camera_that_comes_later_is_found_without_a_restart(running: System, data: Path, tmp_path: Path) -> None:
    camera = tmp_path / "camera.mp4"
    running.start_router()
    with running.client() as client:
        skeletons = client.listen(keys.pattern(keys.SKELETON, client.sensor))
        statuses = client.listen(keys.pattern(keys.STATUS, client.sensor))
        gateway = running.start("sensor_gateway", "--source", "camera", "--camera", str(camera))
        lost = collect(skeletons, Skeleton, bool)[0]
        assert (lost.valid, lost.reason, lost.agents) == (False, "camera lost: it cannot be opened", [])
        status = collect(statuses, Status, lambda found: any("lost" in one.state for one in found))[-1]
        assert status.state == "camera lost: it cannot be opened"
        assert status.rejects == {"camera_lost": 1}
        examined = running.actum("doctor")
        assert examined.returncode == 1
        assert "camera lost" in examined.stdout
        shutil.copy(data / "florence3d_rgb" / PLAYED, tmp_path / "arriving.mp4")
        (tmp_path / "arriving.mp4").rename(camera)
        collect(skeletons, Skeleton, lambda found: any(frame.valid and frame.agents for frame in found))
        collect(statuses, Status, lambda found: any(one.state in ("running", "source ended") for one in found))
    assert gateway.process.poll() is None


def test_recording_a_camera_keeps_no_image_unless_asked(running: System, data: Path, tmp_path: Path) -> None:
    running.start_router()
    with running.client() as client:
        recorder = running.start("actum_command", "record", str(tmp_path / "a.mcap"))
        wait_until(lambda: "recording" in recorder.said(), "it records")
        statuses = client.listen(keys.key(keys.STATUS, client.sensor, "sensor_gateway"))
        running.start("sensor_gateway", "--source", "camera", "--camera", str(data / "florence3d_rgb" / PLAYED))
        collect(statuses, Status, lambda found: any(status.state == "source ended" for status in found))
        recorder.terminate()
    assert Recording(tmp_path / "a.mcap").topics == {keys.SKELETON}
