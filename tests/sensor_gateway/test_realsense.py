"""The source `realsense`, against librealsense's own software device, its recordings, and cameras that vanish."""

from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from actum.messages import Image, Message, Skeleton
from realsense_devices import COLOR_LENS, HEIGHT, PERIOD_MS, WIDTH, Known, SoftwareCamera, color_image, intrinsics
from rendered_bodies import landmarks_of, person
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.file_capture import FileCapture
from sensor_gateway.devices.realsense import RealSenseCapture, RealSenseError, library, recorded_pictures
from sensor_gateway.devices.realsense_frames import Aligner, lens_of
from sensor_gateway.devices.video import VideoError
from sensor_gateway.lens import Lens
from sensor_gateway.optics import DepthOptics
from sensor_gateway.people.depth_lifting import lifted

try:
    rs = library()
except RealSenseError as error:
    pytest.skip(str(error), allow_module_level=True)

START_NS = 10**18
BODY = person(at_m=(0.1, 0.1, 2.4))
MARKS = landmarks_of(BODY, COLOR_LENS, model_size=1.05)
BAG = Path(__file__).with_name("realsense.bag")


def missed_m(joints_m: np.ndarray) -> float:
    return float(np.linalg.norm(joints_m - BODY.joints_m, axis=1).max())


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return SoftwareCamera(rs).recorded(BODY, 8, tmp_path_factory.mktemp("realsense"))


def source_of(path: Path, now_ns: int = START_NS) -> CameraSource:
    return CameraSource(
        lambda: Known(MARKS),
        DepthOptics(),
        lambda: FileCapture(path, lambda: now_ns, recorded_pictures),
        sensor="kinect0",
        session_id="test",
        now_ns=lambda: now_ns,
        pause=lambda _: None,
    )


def played(path: Path) -> list[Message]:
    """Play a recording at a time when all its pictures are due."""
    source = source_of(path)
    late_ns = [START_NS, *[2 * START_NS] * 10_000]
    capture = FileCapture(path, lambda: late_ns.pop(0), recorded_pictures)
    source._open_capture = lambda: capture
    return [message for messages in islice(source.frames(), 100) for message in messages]


def test_joints_lifted_from_the_software_device_are_within_two_centimetres() -> None:
    aligner = Aligner(rs)
    pictures = [aligner.picture(frames, lambda _: 0) for frames in SoftwareCamera(rs).frame_sets(BODY, 5)]

    seen = [picture for picture in pictures if picture is not None]
    assert len(seen) >= 3
    for picture in seen:
        assert picture.depth_m.shape == (HEIGHT, WIDTH)
        np.testing.assert_allclose(picture.lens.matrix, COLOR_LENS.matrix)
        assert missed_m(lifted(MARKS, picture.lens, picture.depth_m).joints_m) < 0.02


def test_a_recording_gives_every_picture_of_the_device_at_its_own_intervals(recording: Path) -> None:
    pictures = list(recorded_pictures(recording, START_NS))

    assert len(pictures) >= 7
    assert pictures[0].stamp_ns == START_NS
    assert {int(np.rint(step / 1e4)) for step in np.diff([p.stamp_ns for p in pictures])} == {round(PERIOD_MS * 100)}
    numbers = [int(picture.image_bgr[0, 0, 0]) for picture in pictures]
    assert numbers == list(range(numbers[0], 8))


def test_a_played_recording_puts_images_with_the_devices_lens_and_joints_within_two_centimetres(
    recording: Path,
) -> None:
    messages = played(recording)

    images = [message for message in messages if isinstance(message, Image)]
    skeletons = [message for message in messages if isinstance(message, Skeleton)]
    assert len(images) == len(skeletons) >= 7
    np.testing.assert_allclose(images[0].K, COLOR_LENS.matrix.ravel())
    assert not images[0].intrinsics_assumed
    for skeleton in skeletons:
        [agent] = skeleton.agents
        assert agent.agent == 1
        assert agent.depth_std_m is None
        assert missed_m(np.array(agent.joints)) < 0.02


def test_a_bag_of_an_older_librealsense_plays_as_well() -> None:
    skeletons = [message for message in played(BAG) if isinstance(message, Skeleton)]

    assert len(skeletons) >= 2
    assert all(missed_m(np.array(skeleton.agents[0].joints)) < 0.02 for skeleton in skeletons)


def test_colour_that_comes_again_with_other_depth_is_no_new_picture() -> None:
    aligner = Aligner(rs)
    *_, last = SoftwareCamera(rs).frame_sets(BODY, 4)

    assert aligner.picture(last, lambda _: 0) is not None
    assert aligner.picture(last, lambda _: 0) is None


def test_colour_that_comes_red_first_is_turned_round(tmp_path: Path) -> None:
    path = SoftwareCamera(rs, color_format="rgb8").recorded(BODY, 4, tmp_path)
    last = list(recorded_pictures(path, START_NS))[-1]

    np.testing.assert_array_equal(last.image_bgr, color_image(3))


def test_a_recording_that_is_cut_off_is_played_as_far_as_it_goes_or_refused(recording: Path, tmp_path: Path) -> None:
    for whole in (recording, BAG):
        content = whole.read_bytes()
        path = tmp_path / f"cut{whole.suffix}"
        path.write_bytes(content[: 2 * len(content) // 3])
        try:
            assert len(list(recorded_pictures(path, START_NS))) < 8
        except VideoError as error:
            assert "cut" in str(error)


@pytest.mark.parametrize("content", [b"", b"no recording" * 100])
@pytest.mark.parametrize("ending", [".bag", ".db3"])
def test_what_is_no_recording_is_refused_by_name(tmp_path: Path, content: bytes, ending: str) -> None:
    path = tmp_path / f"broken{ending}"
    path.write_bytes(content)

    with pytest.raises(VideoError, match=f"broken{ending} is not a recording"):
        next(recorded_pictures(path, 0))


def test_a_lens_that_tells_sights_from_pixels_becomes_one_that_tells_pixels_from_sights() -> None:
    told = intrinsics(rs, Lens(COLOR_LENS.matrix, np.array([-0.055, 0.065, 0.0004, -0.0007, -0.02]), assumed=False))
    told.model = rs.distortion.inverse_brown_conrady
    pixels = np.array([[5.0, 5.0], [320.0, 240.0], [630.0, 470.0], [100.0, 400.0]])
    expected = [rs.rs2_deproject_pixel_to_point(told, pixel.tolist(), 1.0)[:2] for pixel in pixels]

    np.testing.assert_allclose(lens_of(rs, told).rays(pixels), expected, atol=2e-4)


def test_a_lens_as_opencv_has_it_is_taken_as_it_is() -> None:
    lens = Lens(COLOR_LENS.matrix, np.array([0.1, -0.2, 0.001, 0.002, 0.05]), assumed=False)

    np.testing.assert_allclose(lens_of(rs, intrinsics(rs, lens)).distortion, lens.distortion, rtol=1e-6)


@pytest.mark.skipif(len(rs.context().query_devices()) > 0, reason="a RealSense camera is connected")
def test_without_a_camera_the_source_says_so_at_once_and_later_tries_again() -> None:
    clock, opened = [START_NS], []

    def pause(seconds: float) -> None:
        clock[0] += round(seconds * 1e9)

    def open_capture() -> RealSenseCapture:
        opened.append(clock[0] - START_NS)
        return RealSenseCapture()

    source = CameraSource(
        Known, DepthOptics(), open_capture, sensor="kinect0", session_id="test", now_ns=lambda: clock[0], pause=pause
    )
    first, *_ = islice(source.frames(), 20)

    [skeleton] = first
    assert isinstance(skeleton, Skeleton)
    assert not skeleton.valid
    assert skeleton.reason == source.counters.state == "camera lost: no RealSense camera is connected: plug one in"
    assert len(opened) >= 3
    assert opened[2] - opened[1] > opened[1] - opened[0] > 0


class FakeLibrary:
    """A camera that gives one pair of frames, then is pulled out; frames are those of the software device."""

    def __init__(self, frames: list[Any]) -> None:
        self.camera_info, self.timestamp_domain = rs.camera_info, rs.timestamp_domain
        self.stream, self.format, self.distortion, self.align = rs.stream, rs.format, rs.distortion, rs.align
        self.config = rs.config
        self.frames, self.connected, self.stopped = frames, True, False
        self.pipeline_wrapper = lambda _: None

    def context(self) -> "FakeLibrary":
        return self

    def query_devices(self) -> list["FakeLibrary"]:
        return [self] if self.connected else []

    def get_info(self, _: object) -> str:
        return "42"

    def pipeline(self, _: object) -> "FakeLibrary":
        return self

    def start(self, _: object) -> "FakeLibrary":
        return self

    def get_device(self) -> "FakeLibrary":
        return self

    def try_wait_for_frames(self, _: int) -> tuple[bool, Any]:
        return (True, self.frames.pop(0)) if self.frames else (False, None)

    def stop(self) -> None:
        self.stopped = True


def test_an_unplugged_camera_is_lost_at_once_and_a_silent_one_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    complete = [frames for frames in SoftwareCamera(rs).frame_sets(BODY, 4) if frames.size() == 2]
    fake = FakeLibrary(complete[:1])
    monkeypatch.setattr("sensor_gateway.devices.realsense.library", lambda: fake)
    monkeypatch.setattr(RealSenseCapture, "_config", lambda *_: None)
    capture = RealSenseCapture(now_ns=lambda: START_NS)

    picture = capture.next(0.01)
    assert picture is not None and picture.stamp_ns == START_NS
    assert capture.next(0.01) is None
    fake.connected = False
    with pytest.raises(CameraLostError, match="RealSense camera with serial number 42 was unplugged"):
        capture.next(0.01)
    capture.close()
    assert fake.stopped


def test_a_camera_that_was_silent_for_too_long_is_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    complete = [frames for frames in SoftwareCamera(rs).frame_sets(BODY, 4) if frames.size() == 2]
    fake = FakeLibrary(complete[:1])
    monkeypatch.setattr("sensor_gateway.devices.realsense.library", lambda: fake)
    monkeypatch.setattr("sensor_gateway.devices.silence.SILENT_S", 0.0)
    monkeypatch.setattr(RealSenseCapture, "_config", lambda *_: None)
    capture = RealSenseCapture(now_ns=lambda: START_NS)
    assert capture.next(0.01) is not None
    with pytest.raises(CameraLostError, match="no picture"):
        capture.next(0.01)
