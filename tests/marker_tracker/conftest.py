"""Markers seen by a pinhole camera, rendered from a pose that is known exactly."""

from collections.abc import Sequence
from typing import Any, Protocol

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from actum.messages import Image

Array = NDArray[Any]
Markers = Sequence[tuple[int, float, Array]]
"""(id, size_m, image_from_marker) of each."""

WIDTH, HEIGHT = 640, 480
K = [525.0, 0.0, 319.5, 0.0, 525.0, 239.5, 0.0, 0.0, 1.0]
SUPERSAMPLING = 4
CELLS, QUIET = 6, 1
"""Cells along a 4x4 marker's black square, and of white around it."""


class ImageOf(Protocol):
    def __call__(
        self, markers: Markers = (), dictionary: str = "DICT_4X4_50", image_format: str = "bgr8", **fields: Any
    ) -> Image: ...


class PoseAt(Protocol):
    def __call__(self, position_m: Sequence[float], tilt: Sequence[float] = (0.0, 0.0, 0.0)) -> Array: ...


def _marker_from_texture(size_m: float, texels: int) -> Array:
    """Map texture pixels, centres at whole numbers, to metres on the marker (x right, y up)."""
    metres = size_m * (CELLS + 2 * QUIET) / CELLS
    texel, edge = metres / texels, metres / 2
    return np.array([[texel, 0, 0.5 * texel - edge], [0, -texel, edge - 0.5 * texel], [0, 0, 1]])


def _texture(dictionary: str, marker_id: int) -> Array:
    cell = 40
    markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    square = cv2.aruco.generateImageMarker(markers, marker_id, CELLS * cell)
    border = QUIET * cell
    return cv2.copyMakeBorder(square, border, border, border, border, cv2.BORDER_CONSTANT, value=255)


def _box(fine_from_texture: Array, texels: int, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return the part of an image that a texture covers at most (left, top, right, bottom), of a pixel at least."""
    corners = np.array([[-1, -1, 1], [texels, -1, 1], [texels, texels, 1], [-1, texels, 1]]) @ fine_from_texture.T
    if (corners[:, 2] <= 0).any():
        return (0, 0, *size)
    x, y = (corners[:, :2] / corners[:, 2:]).T
    left, top = (min(max(int(least) - 1, 0), end - 1) for least, end in zip((x.min(), y.min()), size, strict=True))
    right, bottom = (max(min(int(most) + 2, end), 1) for most, end in zip((x.max(), y.max()), size, strict=True))
    return left, top, max(right, left + 1), max(bottom, top + 1)


def _render(markers: Markers, dictionary: str) -> Array:
    """Draw markers on a grey wall, as grey levels of shape (HEIGHT, WIDTH)."""
    fine = (WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING)
    canvas = np.full((fine[1], fine[0]), 110, dtype=np.uint8)
    offset = (SUPERSAMPLING - 1) / 2
    fine_from_image = np.array([[SUPERSAMPLING, 0, offset], [0, SUPERSAMPLING, offset], [0, 0, 1]])
    for marker_id, size_m, image_from_marker in markers:
        texture = _texture(dictionary, marker_id)
        image_from_plane = np.reshape(K, (3, 3)) @ image_from_marker[:3][:, [0, 1, 3]]
        fine_from_texture = fine_from_image @ image_from_plane @ _marker_from_texture(size_m, len(texture))
        left, top, right, bottom = _box(fine_from_texture, len(texture), fine)
        box_from_texture = np.array([[1, 0, -left], [0, 1, -top], [0, 0, 1]]) @ fine_from_texture
        box = (right - left, bottom - top)
        drawn = cv2.warpPerspective(texture, box_from_texture, box)
        covered = cv2.warpPerspective(np.full_like(texture, 255), box_from_texture, box)
        canvas[top:bottom, left:right][covered > 127] = drawn[covered > 127]
    return cv2.resize(canvas, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)


@pytest.fixture
def pose_at() -> PoseAt:
    """Place a marker that faces the camera, then turned by a rotation vector: image_from_marker."""

    def place(position_m: Sequence[float], tilt: Sequence[float] = (0.0, 0.0, 0.0)) -> Array:
        image_from_marker = np.eye(4)
        image_from_marker[:3, :3] = cv2.Rodrigues(np.array(tilt, dtype=float))[0] @ np.diag([1.0, -1.0, -1.0])
        image_from_marker[:3, 3] = position_m
        return image_from_marker

    return place


@pytest.fixture
def image_of() -> ImageOf:
    """Make an image message that shows the given markers."""

    def make(
        markers: Markers = (), dictionary: str = "DICT_4X4_50", image_format: str = "bgr8", **fields: Any
    ) -> Image:
        bgr = cv2.cvtColor(_render(markers, dictionary).astype(np.uint8), cv2.COLOR_GRAY2BGR)
        jpeg = cv2.imencode(".jpg", bgr, [cv2.IMWRITE_JPEG_QUALITY, 95])[1]
        message = {
            "stamp_ns": 0,
            "sensor": "kinect0",
            "format": image_format,
            "width": WIDTH,
            "height": HEIGHT,
            "data": jpeg.tobytes() if image_format == "jpeg" else bgr.tobytes(),
            "K": K,
            "distortion": [],
            "skeleton_from_image": np.eye(4).ravel().tolist(),
        }
        return Image.model_validate(message | fields)

    return make
