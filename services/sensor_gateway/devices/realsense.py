"""RealSense cameras, and librealsense's recordings of them, read with pyrealsense2."""

from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from actum import steady_clock
from actum.installing import install_command
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.device_clock import DeviceClock
from sensor_gateway.devices.realsense_frames import Aligner, device_ns
from sensor_gateway.devices.silence import Silence
from sensor_gateway.devices.video import VideoError

SIZE = 640, 480
"""Width and height (px) of the depth image, and by default of the colour image."""
RATE_HZ = 30
"""Frame rate of both streams."""
POLL_MS = 200
"""Longest wait for a recording's next frames in one poll."""
EMPTY_POLLS = 10
"""Successive polls without frames, 2 s, after which a recording without an end counts as truncated."""


class RealSenseError(ValueError):
    """The library is not installed; the message names what is missing and the remedy."""


def library() -> Any:
    """Import pyrealsense2 when it is needed.

    Raises:
        RealSenseError: pyrealsense2, or a library that it needs, is not installed.
    """
    try:
        import pyrealsense2
    except ImportError as error:
        raise RealSenseError(
            f"the source realsense needs pyrealsense2 ({error}): run {install_command('realsense')}, and on Debian "
            "also 'apt install libusb-1.0-0'"
        ) from None
    return pyrealsense2


class RealSenseCapture:
    """The first connected RealSense camera; gives the newest pair of colour and depth, stamped by the device."""

    live = True
    rate_hz: float | None = RATE_HZ

    def __init__(self, size: tuple[int, int] | None = None, now_ns: Callable[[], int] = steady_clock.now_ns) -> None:
        self._rs = library()
        self._size = size or SIZE
        self._clock = DeviceClock(now_ns)
        self._aligner = Aligner(self._rs)
        self._context: Any = None
        self._pipeline: Any = None
        self._serial = ""
        self._silence = Silence()

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last, or None if none comes within `patience_s`.

        Raises:
            CameraLostError: there is no camera, it cannot be used, was unplugged, or has been silent for too long.
        """
        try:
            if self._pipeline is None:
                self._pipeline = self._started()
            has_frames, frames = self._pipeline.try_wait_for_frames(round(1000 * patience_s))
            if not has_frames:
                numbers = [
                    device.get_info(self._rs.camera_info.serial_number) for device in self._context.query_devices()
                ]
                if self._serial not in numbers:
                    raise CameraLostError(
                        f"the RealSense camera with serial number {self._serial} was unplugged: plug it in again"
                    )
            picture = self._aligner.picture(frames, self._stamp_ns) if has_frames else None
        except RuntimeError as error:
            raise CameraLostError(f"librealsense says: {error}") from None
        if picture is None:
            self._silence.check()
        else:
            self._silence.heard()
        return picture

    def close(self) -> None:
        """Release the camera."""
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            try:
                pipeline.stop()
            except RuntimeError:
                return  # it was unplugged, so there is nothing to stop

    def _started(self) -> Any:
        self._context = self._rs.context()
        if not len(self._context.query_devices()):
            raise CameraLostError("no RealSense camera is connected: plug one in")
        pipeline = self._rs.pipeline(self._context)
        profile = pipeline.start(self._config(pipeline))
        self._serial = profile.get_device().get_info(self._rs.camera_info.serial_number)
        return pipeline

    def _config(self, pipeline: Any) -> Any:
        """Ask for colour of the wanted size and for depth of 640x480, or else for the device's default sizes."""
        rs = self._rs
        config = rs.config()
        config.enable_stream(rs.stream.color, *self._size, rs.format.bgr8, RATE_HZ)
        config.enable_stream(rs.stream.depth, *SIZE, rs.format.z16, RATE_HZ)
        if not config.can_resolve(rs.pipeline_wrapper(pipeline)):
            config = rs.config()
            config.enable_stream(rs.stream.color, rs.format.bgr8)
            config.enable_stream(rs.stream.depth, rs.format.z16)
        return config

    def _stamp_ns(self, frame: Any) -> int:
        stamp_ns = device_ns(frame)
        counts_from_start = frame.get_frame_timestamp_domain() == self._rs.timestamp_domain.hardware_clock
        return self._clock.stamp_ns(stamp_ns) if counts_from_start else stamp_ns


def recorded_pictures(path: Path, start_ns: int) -> Generator[Picture, None, None]:
    """Yield a recording's pictures; the first is stamped `start_ns`, later ones keep the device's intervals.

    Raises:
        VideoError: the file is no recording of colour and depth.
    """
    rs = library()
    pipeline, config = rs.pipeline(), rs.config()
    clock = DeviceClock(lambda: start_ns)
    aligner = Aligner(rs)
    try:
        config.enable_device_from_file(str(path), repeat_playback=False)
        playback = config.resolve(rs.pipeline_wrapper(pipeline)).get_device().as_playback()
        playback.set_real_time(False)
        pipeline.start(config)
    except RuntimeError as error:
        raise VideoError(
            f"{path} is not a recording that librealsense can play ({error}): give another --path"
        ) from None
    try:
        yield from _played(
            pipeline, playback, lambda frames: aligner.picture(frames, lambda f: clock.stamp_ns(device_ns(f)))
        )
    finally:
        pipeline.stop()
    if not aligner.made:
        raise VideoError(f"{path} contains no colour image and depth image of the same time: record both streams")


def _played(
    pipeline: Any, playback: Any, picture_of: Callable[[Any], Picture | None]
) -> Generator[Picture, None, None]:
    """Yield all pictures of a recording, until it has stopped or turns out to be truncated."""
    empty_polls = 0
    while empty_polls < EMPTY_POLLS:
        has_frames, frames = pipeline.try_wait_for_frames(POLL_MS)
        empty_polls = 0 if has_frames else empty_polls + 1
        if has_frames and (picture := picture_of(frames)) is not None:
            yield picture
        elif not has_frames and playback.current_status().name == "stopped":
            return
