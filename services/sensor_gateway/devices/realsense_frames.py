"""Pictures of librealsense's frames: depth registered to colour, and the lens in OpenCV's terms."""

from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from sensor_gateway.captured_picture import DepthPicture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.lens import Lens

MILLISECOND_NS = 1_000_000
GRID = 12
"""Points along each side of the grid on which a distortion is fitted: many more than its five coefficients."""
TO_BGR = {
    "rgb8": cv2.COLOR_RGB2BGR,
    "rgba8": cv2.COLOR_RGBA2BGR,
    "bgra8": cv2.COLOR_BGRA2BGR,
    "yuyv": cv2.COLOR_YUV2BGR_YUYV,
}
"""OpenCV's conversion of each of librealsense's colour formats."""


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


def device_ns(frame: Any) -> int:
    """Return a frame's stamp by the device (ns)."""
    return round(float(frame.get_timestamp()) * MILLISECOND_NS)
