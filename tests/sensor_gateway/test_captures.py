"""Pictures of files and devices: their stamps, their pace, and that a device's old ones are left out."""

import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import cv2
import numpy as np
import pytest

from actum.joining import PAUSE_NS
from actum.node import SECOND_NS
from camera_videos import FRAMES_PER_SECOND, write_video
from live import wait_until
from sensor_gateway.cameras import capture_of
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices import webcam
from sensor_gateway.devices.capture import CameraLostError, CaptureEndedError
from sensor_gateway.devices.file_capture import FileCapture
from sensor_gateway.devices.video import VideoError, pictures_of
from sensor_gateway.devices.webcam import LiveCapture, present_cameras

TENTH_NS = SECOND_NS // 10


def test_a_files_pictures_carry_its_own_times_from_the_first_on(tmp_path: Path) -> None:
    pictures = list(pictures_of(write_video(tmp_path / "a.avi"), start_ns=5 * SECOND_NS))
    assert [picture.stamp_ns for picture in pictures] == [5 * SECOND_NS + i * TENTH_NS for i in range(6)]
    assert [round(float(picture.image_bgr.mean()) / 10) for picture in pictures] == [2, 3, 4, 5, 6, 7]


class Film:
    """Stands in for OpenCV's reader of a file whose container tells these times (ms) at 25 frames/s."""

    def __init__(self, *times_ms: float) -> None:
        self.times_ms, self.at = times_ms, -1

    def read(self) -> tuple[bool, np.ndarray | None]:
        self.at += 1
        return (True, np.zeros((48, 64, 3), np.uint8)) if self.at < len(self.times_ms) else (False, None)

    def get(self, what: int) -> float:
        if what == cv2.CAP_PROP_POS_MSEC:
            return self.times_ms[self.at]
        return {cv2.CAP_PROP_FRAME_COUNT: len(self.times_ms), cv2.CAP_PROP_FPS: 25.0}[what]

    def release(self) -> None:
        pass


@pytest.mark.parametrize(
    ("told_ms", "stamped_ms"),
    [
        ((0, 0, 0), (0, 40, 80)),
        ((0, 40, 80, 0), (0, 40, 80, 120)),
        ((0, 0, 30, 200), (0, 40, 80, 200)),
        ((500, 517, 600), (0, 17, 100)),
    ],
    ids=["none, as in a bare H.264 stream", "none for the last", "at times", "all"],
)
def test_frames_whose_times_a_file_does_not_tell_come_one_interval_apart(
    told_ms: tuple[float, ...], stamped_ms: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sensor_gateway.devices.video.cv2.VideoCapture", lambda _path: Film(*told_ms))
    assert [picture.stamp_ns for picture in pictures_of(Path("a.h264"))] == [ms * 1_000_000 for ms in stamped_ms]


def test_a_file_whose_end_is_missing_is_named_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    whole, half = (write_video(tmp_path / name, 20, (640, 480)) for name in ("whole.avi", "half.avi"))
    half.write_bytes(half.read_bytes()[: half.stat().st_size // 2])
    for _ in range(2):
        read = [len(list(pictures_of(path))) for path in (whole, half)]
    assert read[0] == 20 > read[1]
    last_s = (read[1] - 1) / FRAMES_PER_SECOND
    assert caplog.messages == [f"{half} should last 1.9 s, but its images end after {last_s} s: copy the file again"]


def test_what_is_no_video_is_named_and_is_a_lost_camera(tmp_path: Path) -> None:
    path = tmp_path / "a.mp4"
    path.write_text("no video")
    with pytest.raises(VideoError, match=r"a\.mp4 is not a video"):
        list(pictures_of(path))
    with pytest.raises(CameraLostError, match="not a video"):
        capture_of(str(path), None).next(0.0)


class Clock:
    def __init__(self) -> None:
        self.now_ns = SECOND_NS

    def pause(self, seconds: float) -> None:
        self.now_ns += round(seconds * SECOND_NS)


def test_a_file_is_played_at_its_own_pace_and_each_picture_is_given_when_it_is_due(tmp_path: Path) -> None:
    clock = Clock()
    capture = FileCapture(write_video(tmp_path / "a.avi"), now_ns=lambda: clock.now_ns, pause=clock.pause)
    given: list[tuple[int, int]] = []
    looks = 0
    with pytest.raises(CaptureEndedError):
        while True:
            looks += 1
            picture = capture.next(patience_s=0.03)
            if picture is not None:
                given.append((clock.now_ns, picture.stamp_ns))
    assert [stamp_ns for _, stamp_ns in given] == [SECOND_NS + i * TENTH_NS for i in range(6)]
    assert all(0 <= at_ns - stamp_ns < 1000 for at_ns, stamp_ns in given)
    assert looks == 1 + 5 * 4 + 1


def test_a_file_can_be_played_again_and_again_with_a_pause_between(tmp_path: Path) -> None:
    clock = Clock()
    path = write_video(tmp_path / "a.avi")
    capture = FileCapture(path, now_ns=lambda: clock.now_ns, pause=clock.pause, loop=True)
    given = [picture for _ in range(300) if (picture := capture.next(patience_s=0.03)) is not None]
    stamps_ns = [picture.stamp_ns for picture in given]
    assert stamps_ns[:6] == [SECOND_NS + i * TENTH_NS for i in range(6)]
    assert stamps_ns[6:12] == [stamps_ns[5] + PAUSE_NS + i * TENTH_NS for i in range(6)]
    assert all((one.image_bgr == other.image_bgr).all() for one, other in zip(given, given[6:], strict=False))


def test_a_slow_reader_of_a_file_misses_nothing_and_catches_up(tmp_path: Path) -> None:
    clock = Clock()
    capture = FileCapture(write_video(tmp_path / "a.avi"), now_ns=lambda: clock.now_ns, pause=clock.pause)
    clock.now_ns += 10 * SECOND_NS
    given = [capture.next(0.03) for _ in range(6)]
    assert [picture.stamp_ns for picture in given if picture] == [SECOND_NS + i * TENTH_NS for i in range(6)]
    assert clock.now_ns == 11 * SECOND_NS


def test_a_device_gives_its_newest_picture_and_what_came_before_is_left_out(tmp_path: Path) -> None:
    capture = LiveCapture(str(write_video(tmp_path / "a.avi", frames=20)))
    wait_until(lambda: capture.over, "the device has given all")
    newest = capture.next(0.0)
    assert isinstance(newest, Picture)
    assert round(float(newest.image_bgr.mean())) == pytest.approx(20 + 10 * 19, abs=2)
    with pytest.raises(CameraLostError, match="no more pictures"):
        capture.next(0.0)


def test_a_device_s_picture_is_given_as_soon_as_it_is_there(monkeypatch: pytest.MonkeyPatch) -> None:
    over, patience_s = threading.Event(), 5.0

    def read() -> Iterator[tuple[bool, np.ndarray]]:
        yield True, np.full((2, 2, 3), 7)
        over.wait()
        yield False, np.empty(0)

    device = SimpleNamespace(isOpened=lambda: True, read=read().__next__, release=lambda: None)
    monkeypatch.setattr(LiveCapture, "_opened", lambda _: device)
    capture, began_s = LiveCapture(0), time.monotonic()
    assert isinstance(capture.next(patience_s), Picture)
    assert time.monotonic() - began_s < patience_s
    over.set()
    capture.close()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux lists its cameras")
def test_a_device_that_cannot_be_opened_is_lost_with_the_cameras_that_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for number, index in ((0, 0), (1, 1), (10, 0), (2, 0)):
        device = tmp_path / f"video{number}"
        device.mkdir()
        (device / "name").write_text(f"Camera {number}\n")
        (device / "index").write_text(f"{index}\n")
    assert present_cameras(tmp_path) == "the cameras here are 0 (Camera 0), 2 (Camera 2), 10 (Camera 10)"
    assert present_cameras(tmp_path / "none") == "this machine has no camera"
    monkeypatch.setattr(webcam, "present_cameras", lambda: present_cameras(tmp_path))
    capture = LiveCapture(99)
    wait_until(lambda: capture.over, "it has been tried")
    with pytest.raises(CameraLostError, match="it cannot be opened: the cameras here are 0 "):
        capture.next(0.0)


def test_a_file_that_is_there_is_played_and_all_else_is_a_device(tmp_path: Path) -> None:
    played = capture_of(str(write_video(tmp_path / "a.avi")), None)
    other = capture_of(str(tmp_path / "gone.avi"), None)
    assert (played.live, other.live) == (False, True)
    played.close()
    other.close()


def test_a_device_at_whose_opening_opencv_fails_is_lost_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise cv2.error("no such backend")

    monkeypatch.setattr(cv2, "VideoCapture", fail)
    capture = LiveCapture(0)
    with pytest.raises(CameraLostError, match="OpenCV says: no such backend"):
        capture.next(5.0)
    capture.close()
