"""The source `openni2`, against the real libOpenNI2: its player of recordings, its dummy driver, no camera at all."""

from collections import deque
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from actum.messages import Image, Message, Skeleton
from oni_files import DEPTH, IMAGE, Track, write_oni
from realsense_devices import Known
from rendered_bodies import depth_of, landmarks_of, person
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.file_capture import FileCapture
from sensor_gateway.devices.openni2 import OpenNi2Capture, recorded_pictures
from sensor_gateway.devices.openni2_library import OpenNiError, library
from sensor_gateway.devices.openni2_streams import together
from sensor_gateway.devices.video import VideoError
from sensor_gateway.lens import Lens
from sensor_gateway.optics import DepthOptics

try:
    OPENNI2 = library()
except OpenNiError as error:
    pytest.skip(str(error), allow_module_level=True)

WIDTH, HEIGHT = 640, 480
START_NS = 10**18
FIELD_OF_VIEW_RAD = 1.0144686, 0.7898090
FOCAL_PX = WIDTH / 2 / np.tan(FIELD_OF_VIEW_RAD[0] / 2), HEIGHT / 2 / np.tan(FIELD_OF_VIEW_RAD[1] / 2)
LENS = Lens(np.array([[FOCAL_PX[0], 0, 319.5], [0, FOCAL_PX[1], 239.5], [0, 0, 1]]), np.zeros(5), assumed=True)
BODY = person(at_m=(0.1, 0.1, 2.4))
MARKS = landmarks_of(BODY, LENS, model_size=1.05)
DEPTH_MM = np.rint(1000 * depth_of(BODY, LENS, WIDTH, HEIGHT)).astype(np.uint16)
COUNT = 5
STAMPS_US = [7_000 + 33_333 * number for number in range(COUNT)]


def colors() -> list[np.ndarray]:
    """Images whose red tells their number and whose first column alone is green."""
    images = [np.zeros((HEIGHT, WIDTH, 3), np.uint8) for _ in range(COUNT)]
    for number, image in enumerate(images):
        image[..., 0] = 10 * number
        image[:, 0, 1] = 255
    return images


def recording(path: Path, mirrored: bool = False, color_late_us: int = 4_000) -> Path:
    turn = (slice(None), slice(None, None, -1)) if mirrored else (slice(None),)
    depth = Track(DEPTH, [DEPTH_MM[turn]] * COUNT, STAMPS_US, FIELD_OF_VIEW_RAD, mirrored)
    late_us = [stamp_us + color_late_us for stamp_us in STAMPS_US]
    color = Track(IMAGE, [image[turn] for image in colors()], late_us, FIELD_OF_VIEW_RAD, mirrored)
    return write_oni(path, depth, color)


def missed_m(joints_m: np.ndarray) -> float:
    return float(np.linalg.norm(joints_m - BODY.joints_m, axis=1).max())


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_recording_gives_every_picture_as_it_was_before_the_camera(tmp_path: Path, mirrored: bool) -> None:
    pictures = list(recorded_pictures(recording(tmp_path / "body.oni", mirrored), START_NS))

    assert [picture.stamp_ns - START_NS for picture in pictures] == [33_333_000 * n for n in range(COUNT)]
    for picture, color in zip(pictures, colors(), strict=True):
        assert isinstance(picture, DepthPicture)
        np.testing.assert_array_equal(picture.image_bgr, color[..., ::-1])
        np.testing.assert_allclose(picture.depth_m, DEPTH_MM / 1000, atol=1e-6)
        np.testing.assert_allclose(picture.lens.matrix, LENS.matrix, rtol=1e-6)


def test_joints_of_a_played_recording_are_within_two_centimetres_and_the_lens_is_said_to_be_assumed(
    tmp_path: Path,
) -> None:
    path = recording(tmp_path / "body.oni")
    late_ns = [START_NS, *[2 * START_NS] * 1000]
    source = CameraSource(
        lambda: Known(MARKS),
        DepthOptics(),
        lambda: FileCapture(path, lambda: late_ns.pop(0), recorded_pictures),
        sensor="kinect0",
        session_id="test",
    )
    messages: list[Message] = [message for messages in islice(source.frames(), 100) for message in messages]

    images = [message for message in messages if isinstance(message, Image)]
    skeletons = [message for message in messages if isinstance(message, Skeleton)]
    assert len(images) == len(skeletons) == COUNT
    assert all(image.intrinsics_assumed for image in images)
    assert all(missed_m(np.array(skeleton.agents[0].joints)) < 0.02 for skeleton in skeletons)


def test_a_recording_that_does_not_tell_its_lens_is_given_the_one_assumed(tmp_path: Path) -> None:
    tracks = Track(DEPTH, [DEPTH_MM], [1000]), Track(IMAGE, colors()[:1], [1000])
    [picture] = recorded_pictures(write_oni(tmp_path / "plain.oni", *tracks), 0, field_of_view_deg=58.0)

    assert isinstance(picture, DepthPicture)
    assert picture.lens.assumed
    np.testing.assert_allclose(picture.lens.matrix, Lens.of_field_of_view(WIDTH, HEIGHT, 58.0).matrix)


def test_depth_and_colour_that_are_never_of_the_same_time_are_refused(tmp_path: Path) -> None:
    depth = Track(DEPTH, [DEPTH_MM], [1_000])
    color = Track(IMAGE, colors()[:1], [900_000])

    with pytest.raises(VideoError, match="no colour image and depth image of the same time"):
        list(recorded_pictures(write_oni(tmp_path / "apart.oni", depth, color), 0))


def test_a_recording_of_depth_alone_is_refused(tmp_path: Path) -> None:
    path = write_oni(tmp_path / "depth.oni", Track(DEPTH, [DEPTH_MM], [1000]))

    with pytest.raises(VideoError, match=r"depth.oni (is not a recording|contains no colour)"):
        next(recorded_pictures(path, 0))


@pytest.mark.parametrize("content", [b"", b"no recording" * 100])
def test_what_is_no_recording_is_refused_by_name(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "broken.oni"
    path.write_bytes(content)

    with pytest.raises(VideoError, match="broken.oni is not a recording"):
        next(recorded_pictures(path, 0))


@pytest.fixture
def without_camera() -> None:
    """The library as it is when no device has been opened."""
    OPENNI2.unload()
    if library().Device.enumerate_uris():
        pytest.skip("a camera is connected that OpenNI 2 has a driver for")


@pytest.mark.usefixtures("without_camera")
def test_without_a_camera_that_is_said_and_it_can_be_tried_again() -> None:
    for _ in range(2):
        capture = OpenNi2Capture()
        with pytest.raises(CameraLostError, match="no camera that OpenNI 2 supports is connected"):
            capture.next(0.01)
        capture.close()


def frames(*stamps_us: int) -> deque[tuple[int, np.ndarray]]:
    return deque((stamp_us, np.array([stamp_us])) for stamp_us in stamps_us)


def test_each_colour_image_gets_the_depth_nearest_in_time() -> None:
    depths, colors = frames(0, 33_000, 66_000), frames(35_000)

    found = together(depths, colors)

    assert found is not None
    assert (found[0][0], found[1][0]) == (33_000, 35_000)
    assert [stamp_us for stamp_us, _ in depths] == [66_000]
    assert not colors
    assert together(depths, colors) is None


@pytest.mark.parametrize(("later_us", "paired"), [(0, True), (16_667, True), (17_500, False)])
def test_what_is_at_most_half_a_frame_apart_is_one_picture(later_us: int, paired: bool) -> None:
    for sign in (-1, 1):
        assert (together(frames(50_000), frames(50_000 + sign * later_us)) is not None) is paired


def test_colour_waits_for_depth_that_comes_late() -> None:
    assert together(frames(0), frames(33_000, 66_000)) is None
    found = together(frames(0, 33_000), frames(33_000, 66_000))
    assert found is not None and found[1][0] == 33_000


class OneCamera:
    """The library with the driver that it brings along to try things with for a camera, which can be pulled out."""

    def __init__(self) -> None:
        self.uris = [b"Dummy"]

    def __getattr__(self, name: str) -> object:
        return getattr(OPENNI2, name)

    @property
    def Device(self) -> "OneCamera":  # noqa: N802 - the library's name for it
        return self

    def enumerate_uris(self) -> list[bytes]:
        return self.uris

    def __call__(self, _: object) -> object:
        return OPENNI2.Device(b"Dummy")

    def wait_for_any_stream(self, streams: list[object], patience_s: float) -> object:
        return OPENNI2.wait_for_any_stream(streams, patience_s) if self.uris else None


def test_an_unplugged_camera_is_lost_at_once_and_comes_back(monkeypatch: pytest.MonkeyPatch) -> None:
    fake = OneCamera()
    monkeypatch.setattr("sensor_gateway.devices.openni2.library", lambda: fake)

    def first_picture(capture: OpenNi2Capture) -> Picture:
        return next(picture for picture in (capture.next(1.0) for _ in range(20)) if picture is not None)

    capture = OpenNi2Capture(now_ns=lambda: START_NS)
    picture = first_picture(capture)
    assert picture.image_bgr.shape == (240, 320, 3)
    assert picture.stamp_ns == START_NS
    fake.uris = []
    with pytest.raises(CameraLostError, match="Dummy was unplugged"):
        capture.next(0.01)
    capture.close()

    fake.uris = [b"Dummy"]
    again = OpenNi2Capture(now_ns=lambda: START_NS)
    assert first_picture(again)
    again.close()


def test_a_library_that_is_not_there_is_an_error_with_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_library(name: str) -> None:
        raise OSError(f"{name}: cannot open shared object file")

    bindings = type("Bindings", (), {"loaded_dll_directory": None, "is_initialized": staticmethod(lambda: False)})
    bindings.c_api = type("Api", (), {"load_dll": staticmethod(no_library)})
    monkeypatch.setattr("openni.openni2", bindings)
    monkeypatch.delenv("OPENNI2_REDIST64", raising=False)
    monkeypatch.delenv("OPENNI2_REDIST", raising=False)

    with pytest.raises(OpenNiError, match=r"\(libOpenNI2.*apt install libopenni2-0"):
        library()


def test_a_folder_named_in_the_environment_is_looked_in_first(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(OPENNI2, "is_initialized", lambda: False)
    monkeypatch.setattr(OPENNI2, "_openni2_initialized", False)
    monkeypatch.setattr(OPENNI2, "loaded_dll_directory", None)
    monkeypatch.setenv("OPENNI2_REDIST", str(tmp_path))

    with pytest.raises(OpenNiError, match=str(tmp_path)):
        library()
