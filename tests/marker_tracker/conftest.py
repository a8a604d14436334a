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
        drawn = cv2.warpPerspective(texture, fine_from_texture, fine)
        covered = cv2.warpPerspective(np.full_like(texture, 255), fine_from_texture, fine)
        canvas = np.where(covered > 127, drawn, canvas)
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
