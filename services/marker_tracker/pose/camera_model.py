"""The camera of an image message: a pinhole with lens distortion, checked and scaled to the image's size."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from actum import geometry
from actum.arrays import Array
from actum.images import UnusableImageError
from actum.limits import MAX_COORDINATE_M
from actum.messages import Image

LARGEST_FOCAL_PX = 1e5
"""Pixels: a hundred times the focal length of usual cameras; a larger one is in the wrong unit."""
LARGEST_COEFFICIENT = 100.0
"""Largest distortion coefficient: rational models reach tens; far above, projection overflows."""
LARGEST_OFFSET = 0.2
"""Largest offset of the principal point from the image's centre, as a share of its size: above, K fits another size."""
ASPECT_TOLERANCE = 0.01
"""Relative difference of aspect ratios: sizes are whole pixels, so scaling keeps the ratio only nearly."""
DISTORTION_LENGTHS = (0, 4, 5, 8, 12, 14)
"""Numbers of distortion coefficients that OpenCV takes."""


@dataclass(frozen=True)
class CameraModel:
    """A camera's calibration.

    Attributes:
        matrix: the intrinsic matrix K (3, 3), in pixels; pixel centres are at whole numbers.
        distortion: OpenCV's coefficients, of one of the `DISTORTION_LENGTHS`.
        skeleton_from_image: rigid transform (4, 4) in metres, from the image's camera frame to the skeletons'.
    """

    matrix: Array
    distortion: Array
    skeleton_from_image: Array


def camera_model(image: Image, calibrated_size_px: tuple[int, int] | None = None) -> CameraModel:
    """Read an image's calibration; K is scaled to the image where the calibrated (width, height) is given.

    Raises:
        UnusableImageError: of kind `bad_calibration` or `calibration_size_mismatch`.
    """
    size_px = image.width, image.height
    return _checked(
        tuple(image.K), tuple(image.distortion), tuple(image.skeleton_from_image), size_px, calibrated_size_px
    )


@lru_cache(maxsize=4)
def _checked(
    numbers: tuple[float, ...],
    coefficients: tuple[float, ...],
    transform: tuple[float, ...],
    size_px: tuple[int, int],
    calibrated_size_px: tuple[int, int] | None,
) -> CameraModel:
    """Check a calibration, once for all images of a camera."""
    matrix = np.array(numbers, dtype=np.float64).reshape(3, 3)
    focal = (matrix[0, 0], matrix[1, 1])
    if not all(0 < f < LARGEST_FOCAL_PX for f in focal) or np.abs(matrix).max() > LARGEST_FOCAL_PX:
        raise UnusableImageError(
            "bad_calibration",
            f"the camera matrix K has the focal lengths {focal[0]:g} and {focal[1]:g} px and the largest entry "
            f"{np.abs(matrix).max():g}. The focal lengths must be above 0, and no entry above {LARGEST_FOCAL_PX:g}: "
            "calibrate the camera again",
        )
    if not np.array_equal(matrix[2], (0, 0, 1)):
        raise UnusableImageError(
            "bad_calibration",
            f"the last row of the camera matrix K is {matrix[2].tolist()}, but must be [0, 0, 1]: calibrate the camera "
            "again",
        )
    skeleton_from_image = geometry.from_flat(transform)
    if not geometry.is_rigid(skeleton_from_image, MAX_COORDINATE_M):
        raise UnusableImageError(
            "bad_calibration",
            "skeleton_from_image, the transform to the camera that sees the people, is not a rigid transform: run "
            "'actum calibrate extrinsics' again",
        )
    matrix = _matrix_for_size(matrix, size_px, calibrated_size_px)
    return CameraModel(matrix, _distortion(coefficients), skeleton_from_image)


def _matrix_for_size(matrix: Array, size_px: tuple[int, int], calibrated_px: tuple[int, int] | None) -> Array:
    """Scale K (3, 3) to the image's (width, height), or check that it fits where the calibrated size is unknown.

    Pixel centres are at whole numbers, so the principal point c scales as c + 1/2.
    """
    width, height = size_px
    if calibrated_px is None:
        off_px = np.abs(matrix[:2, 2] + 0.5 - np.divide(size_px, 2))
        if (off_px > 1 + LARGEST_OFFSET * np.array(size_px)).any():
            raise UnusableImageError(
                "calibration_size_mismatch",
                f"the principal point ({matrix[0, 2]:g}, {matrix[1, 2]:g}) of the camera matrix K is far from the "
                f"centre of an image of {width}x{height} pixels, so K is for another image size: calibrate the camera "
                "at this size, or set --calibrated-size-px to the image size at which the camera was calibrated",
            )
        return matrix
    across, down = width / calibrated_px[0], height / calibrated_px[1]
    if abs(across / down - 1) > ASPECT_TOLERANCE:
        raise UnusableImageError(
            "calibration_size_mismatch",
            f"the image is {width}x{height}, but the camera was calibrated at {calibrated_px[0]}x{calibrated_px[1]}, "
            "which has another aspect ratio: calibrate the camera again, or send images with the aspect ratio of the "
            "calibration",
        )
    half = np.array([[1, 0, 0.5], [0, 1, 0.5], [0, 0, 1]])
    scaled: Array = np.linalg.inv(half) @ np.diag([across, down, 1.0]) @ half @ matrix
    return scaled


def _distortion(coefficients: tuple[float, ...]) -> Array:
    if len(coefficients) not in DISTORTION_LENGTHS:
        allowed = " or ".join(map(str, DISTORTION_LENGTHS))
        raise UnusableImageError(
            "bad_calibration",
            f"distortion has {len(coefficients)} coefficients, but must have {allowed}: calibrate the camera again",
        )
    distortion = np.array(coefficients, dtype=np.float64)
    if np.abs(distortion).max(initial=0) > LARGEST_COEFFICIENT:
        raise UnusableImageError(
            "bad_calibration",
            f"a distortion coefficient is below -{LARGEST_COEFFICIENT:g} or above {LARGEST_COEFFICIENT:g}: calibrate "
            "the camera again",
        )
    return distortion
