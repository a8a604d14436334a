"""From an image message to grey pixels and a camera, refusing what cannot be used before it costs anything."""

import io
import struct
from dataclasses import dataclass

import cv2
import imagesize
import numpy as np
from numpy.typing import NDArray

from actum import geometry
from actum.darkness import is_black
from actum.messages import Image

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8]

LARGEST_PIXELS = 4096 * 4096
LARGEST_FOCAL_PX = 1e5
LARGEST_COEFFICIENT = 100.0
FURTHEST_OFF_CENTRE = 0.2
"""How far from the image's centre, in parts of its size, the optical axis may meet it."""
SAME_ASPECT = 0.01
DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
JPEG_START = b"\xff\xd8"
FURTHEST_M = 100.0


class UnusableImageError(ValueError):
    """An image that cannot be used; `kind` is the name it is counted under."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(f"{kind}: {detail}")
        self.kind = kind
        self.detail = detail


@dataclass(frozen=True)
class Camera:
    """A pinhole camera: `matrix` (3, 3) in pixels, OpenCV's `distortion`, and where the skeleton's camera is."""

    matrix: Array
    distortion: Array
    skeleton_from_image: Array


def gray(image: Image) -> Pixels:
    """Decode an image to grey levels of shape (height, width).

    Raises:
        UnusableImageError: of kind `image_too_large`, `image_size_mismatch` or `undecodable_image`.
    """
    if image.width * image.height > LARGEST_PIXELS:
        raise UnusableImageError("image_too_large", f"{image.width}x{image.height}, at most {LARGEST_PIXELS} pixels")
    return _from_jpeg(image) if image.format == "jpeg" else _from_bgr(image)


def camera(image: Image, calibrated_size_px: tuple[int, int] | None = None) -> Camera:
    """Read an image's calibration; K is scaled to the image where the calibrated size is known and has its aspect.

    Raises:
        UnusableImageError: of kind `bad_calibration` or `calibration_size_mismatch`.
    """
    matrix = np.array(image.K, dtype=np.float64).reshape(3, 3)
    focal = (matrix[0, 0], matrix[1, 1])
    if not all(0 < f < LARGEST_FOCAL_PX for f in focal) or np.abs(matrix).max() > LARGEST_FOCAL_PX:
        raise UnusableImageError("bad_calibration", f"K has focal lengths {focal[0]:g} and {focal[1]:g} px")
    if not np.array_equal(matrix[2], (0, 0, 1)):
        raise UnusableImageError("bad_calibration", f"the last row of K is {matrix[2].tolist()}, not [0, 0, 1]")
    skeleton_from_image = geometry.from_flat(image.skeleton_from_image)
    if not geometry.is_rigid(skeleton_from_image, FURTHEST_M):
        raise UnusableImageError("bad_calibration", "skeleton_from_image is no rigid transform")
    matrix = _of_size(matrix, (image.width, image.height), calibrated_size_px)
    return Camera(matrix, _distortion(image.distortion), skeleton_from_image)


def refuse_black(pixels: Pixels) -> None:
    """Tell an image in which nothing can be seen from one in which no marker is.

    Raises:
        UnusableImageError: of kind `black_image`.
    """
    if is_black(pixels):
        raise UnusableImageError("black_image", "nothing can be seen: is the lens covered, is it dark?")


def _of_size(matrix: Array, size_px: tuple[int, int], calibrated_px: tuple[int, int] | None) -> Array:
    """Hold K against the image's size: pixel centres are at whole numbers, so that (c + 1/2) scales."""
    width, height = size_px
    if calibrated_px is None:
        off_px = np.abs(matrix[:2, 2] + 0.5 - np.divide(size_px, 2))
        if (off_px > 1 + FURTHEST_OFF_CENTRE * np.array(size_px)).any():
            raise UnusableImageError(
                "calibration_size_mismatch",
                f"K has its centre at ({matrix[0, 2]:g}, {matrix[1, 2]:g}) in an image of {width}x{height}: "
                "calibrate at this size, or give calibrated-size-px",
            )
        return matrix
    across, down = width / calibrated_px[0], height / calibrated_px[1]
    if abs(across / down - 1) > SAME_ASPECT:
        raise UnusableImageError(
            "calibration_size_mismatch",
            f"an image of {width}x{height}, but calibrated at {calibrated_px[0]}x{calibrated_px[1]}",
        )
    half = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1]])
    scaled: Array = np.linalg.inv(half) @ np.diag([across, down, 1.0]) @ half @ matrix
    return scaled


def _from_jpeg(image: Image) -> Pixels:
    """Decode a JPEG whose header has been read first: decoding allocates what the header claims."""
    size = _jpeg_size(image.data)
    if size[0] * size[1] > LARGEST_PIXELS:
        raise UnusableImageError("image_too_large", f"a JPEG of {size[0]}x{size[1]}, at most {LARGEST_PIXELS} pixels")
    if size != (image.width, image.height):
        raise UnusableImageError(
            "image_size_mismatch", f"a JPEG of {size[0]}x{size[1]} in a message of {image.width}x{image.height}"
        )
    flags = cv2.IMREAD_GRAYSCALE | cv2.IMREAD_IGNORE_ORIENTATION
    pixels = cv2.imdecode(np.frombuffer(image.data, dtype=np.uint8), flags)
    if pixels is None or pixels.shape != (image.height, image.width):
        raise UnusableImageError("undecodable_image", f"a damaged JPEG of {len(image.data)} bytes")
    return pixels.astype(np.uint8, copy=False)


def _jpeg_size(data: bytes) -> tuple[int, int]:
    """Read (width, height) from a JPEG's header."""
    if not data.startswith(JPEG_START):
        raise UnusableImageError("undecodable_image", f"{len(data)} bytes that do not start as a JPEG")
    try:
        width, height = imagesize.get(io.BytesIO(data), exif_rotation=False)
    except (ValueError, struct.error) as error:
        raise UnusableImageError("undecodable_image", f"a JPEG with a damaged header: {error}") from None
    if width <= 0 or height <= 0:
        raise UnusableImageError("undecodable_image", f"a JPEG of {len(data)} bytes without a size")
    return width, height


def _from_bgr(image: Image) -> Pixels:
    expected = image.width * image.height * 3
    if len(image.data) != expected:
        raise UnusableImageError(
            "image_size_mismatch",
            f"{len(image.data)} bytes for {image.width}x{image.height} bgr8, expected {expected}",
        )
    pixels = np.frombuffer(image.data, dtype=np.uint8).reshape(image.height, image.width, 3)
    return cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY).astype(np.uint8, copy=False)


def _distortion(coefficients: list[float]) -> Array:
    if len(coefficients) not in DISTORTION_LENGTHS:
        raise UnusableImageError(
            "bad_calibration", f"{len(coefficients)} distortion coefficients, not one of {DISTORTION_LENGTHS}"
        )
    distortion = np.array(coefficients, dtype=np.float64)
    if np.abs(distortion).max(initial=0) > LARGEST_COEFFICIENT:
        raise UnusableImageError("bad_calibration", f"a distortion coefficient beyond {LARGEST_COEFFICIENT:g}")
    return distortion
