"""RealSense cameras, and librealsense's recordings of them, read with pyrealsense2."""

from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from actum import steady_clock
from actum.arrays import Array
from actum.installing import install_command
from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.device_clock import DeviceClock
from sensor_gateway.devices.silence import Silence
from sensor_gateway.devices.video import VideoError
from sensor_gateway.lens import Lens

SIZE = 640, 480
"""Width and height (px) of the depth image, and by default of the colour image."""
RATE_HZ = 30
"""Frame rate of both streams."""
MILLISECOND_NS = 1_000_000
POLL_MS = 200
"""Longest wait for a recording's next frames in one poll."""
EMPTY_POLLS = 10
"""Successive polls without frames, 2 s, after which a recording without an end counts as truncated."""
GRID = 12
"""Points along each side of the grid on which a distortion is fitted: many more than its five coefficients."""
TO_BGR = {
    "rgb8": cv2.COLOR_RGB2BGR,
    "rgba8": cv2.COLOR_RGBA2BGR,
    "bgra8": cv2.COLOR_BGRA2BGR,
    "yuyv": cv2.COLOR_YUV2BGR_YUYV,
}
"""OpenCV's conversion of each of librealsense's colour formats."""


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
        stamp_ns = _device_ns(frame)
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
            pipeline, playback, lambda frames: aligner.picture(frames, lambda f: clock.stamp_ns(_device_ns(f)))
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


class Aligner:
    """Makes pictures of librealsense's frame sets, with the depth registered to the colour camera."""

    def __init__(self, rs: Any) -> None:
        self._rs = rs
        self._align = rs.align(rs.stream.color)
        self._newest: int | None = None

    @property
    def made(self) -> bool:
        """Whether any picture has been made."""
        return self._newest is not None

    def picture(self, frames: Any, stamp_ns: Callable[[Any], int]) -> DepthPicture | None:
        """Return a frame set's picture with its colour frame's stamp; None without depth or without new colour."""
        if not (frames.get_color_frame() and frames.get_depth_frame()):
            return None
        if frames.get_color_frame().get_frame_number() == self._newest:
            return None
        aligned = self._align.process(frames)
        color, depth = aligned.get_color_frame(), aligned.get_depth_frame()
        self._newest = color.get_frame_number()
        return DepthPicture(
            image_bgr=_bgr(color),
            stamp_ns=stamp_ns(color),
            depth_m=np.asanyarray(depth.get_data()) * np.float32(depth.get_units()),
            lens=lens_of(self._rs, color.profile.as_video_stream_profile().intrinsics),
        )


def lens_of(rs: Any, intrinsics: Any) -> Lens:
    """Return a stream's intrinsics, with the distortion converted to OpenCV's coefficients."""
    matrix = np.array([[intrinsics.fx, 0, intrinsics.ppx], [0, intrinsics.fy, intrinsics.ppy], [0, 0, 1]])
    forward = rs.distortion.brown_conrady, rs.distortion.modified_brown_conrady
    if intrinsics.model in forward or not any(intrinsics.coeffs):
        return Lens(matrix, np.array(intrinsics.coeffs, dtype=np.float64), assumed=False)
    return Lens(matrix, _fitted_distortion(rs, intrinsics, matrix), assumed=False)


def _fitted_distortion(rs: Any, intrinsics: Any, matrix: Array) -> Array:
    """Fit OpenCV's k1 k2 p1 p2 k3 (5,) to a model that maps pixels to rays, by linear least squares on a grid."""
    x, y = np.meshgrid(np.linspace(0, intrinsics.width - 1, GRID), np.linspace(0, intrinsics.height - 1, GRID))
    pixels = np.column_stack([x.ravel(), y.ravel()])
    points = [rs.rs2_deproject_pixel_to_point(intrinsics, pixel.tolist(), 1.0)[:2] for pixel in pixels]
    rays = np.array(points, dtype=np.float64)
    shift = (pixels - matrix[:2, 2]) / matrix[[0, 1], [0, 1]] - rays
    (u, v), square = rays.T, (rays**2).sum(axis=1)
    rows_x = np.column_stack([u * square, u * square**2, 2 * u * v, square + 2 * u**2, u * square**3])
    rows_y = np.column_stack([v * square, v * square**2, square + 2 * v**2, 2 * u * v, v * square**3])
    coefficients, *_ = np.linalg.lstsq(np.vstack([rows_x, rows_y]), shift.T.ravel(), rcond=None)
    return np.asarray(coefficients)


def _bgr(color: Any) -> NDArray[np.uint8]:
    image = np.array(color.get_data())
    name = color.profile.format().name
    if name == "bgr8":
        return image
    if name not in TO_BGR:
        raise CameraLostError(
            f"the camera sends colour images in the format {name}, which actum cannot read: use one of the formats "
            f"bgr8, {', '.join(TO_BGR)}"
        )
    packed = image.view(np.uint8).reshape(*image.shape[:2], -1)
    return np.asarray(cv2.cvtColor(packed, TO_BGR[name]), dtype=np.uint8)


def _device_ns(frame: Any) -> int:
    return round(float(frame.get_timestamp()) * MILLISECOND_NS)
