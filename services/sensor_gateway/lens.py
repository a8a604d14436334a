"""A camera's intrinsics: calibrated, reported by the device, or assumed from a field of view."""

from dataclasses import dataclass
from typing import Self

import cv2
import numpy as np

from actum.arrays import Array
from actum.calibration import Calibration


@dataclass(frozen=True)
class Lens:
    """Intrinsics: `matrix` K (3, 3; px) and OpenCV's `distortion` (n,).

    `assumed` is true if they were not measured for this individual camera.
    """

    matrix: Array
    distortion: Array
    assumed: bool

    @classmethod
    def of_field_of_view(cls, width: int, height: int, long_side_deg: float) -> Self:
        """Assume an ideal camera with this field of view along the longer side, square pixels and no distortion.

        The longer side is used because a phone has the same field of view along it in portrait and landscape.
        """
        focal_px = max(width, height) / 2 / np.tan(np.radians(long_side_deg) / 2)
        matrix = np.array([[focal_px, 0, (width - 1) / 2], [0, focal_px, (height - 1) / 2], [0, 0, 1]])
        return cls(matrix, np.zeros(5), assumed=True)

    @classmethod
    def of_calibration(cls, calibration: Calibration) -> Self:
        """Take the intrinsics of a calibration file."""
        return cls(calibration.matrix, np.array(calibration.distortion, dtype=np.float64), assumed=False)

    def rays(self, points_px: Array) -> Array:
        """Return x and y at z = 1 (n, 2) of the rays through image points (n, 2): undistorted, normalised."""
        points = points_px.reshape(-1, 1, 2)
        return np.asarray(cv2.undistortPoints(points, self.matrix, self.distortion), dtype=np.float64).reshape(-1, 2)
