"""Markers in an image, and each one's pose from its four corners."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.images import Camera, Pixels

Array = NDArray[np.float64]

FURTHEST_M = 100.0
FULL_SIDE_PX = 24.0
"""From this side on, four pixels for each cell of a 4x4 marker with its border, size costs no confidence."""

# The pose is solved with y down, for a marker that faces the camera is then close to the identity. With y up it
# is a half turn, whose rotation vector OpenCV gets wrong (by tens of pixels when the marker is exactly frontal).
SQUARE_FROM_MARKER = np.diag([1.0, -1.0, -1.0])


@dataclass(frozen=True)
class Marker:
    """A detected marker; `corners_px` is (4, 2), clockwise from the marker's own top left."""

    id: int
    corners_px: Array

    @property
    def side_px(self) -> float:
        """Mean length of the four sides."""
        sides = self.corners_px - np.roll(self.corners_px, 1, axis=0)
        return float(np.linalg.norm(sides, axis=1).mean())


@dataclass(frozen=True)
class MarkerPose:
    """Where a marker is; `error_px` is the root mean square reprojection error of its corners.

    The marker frame has its origin in the centre, x to the right, y up, z out of the printed face.
    """

    image_from_marker: Array
    error_px: float


class BadPoseError(ValueError):
    """Corners that no marker in front of the camera can have."""


class MarkerDetector:
    """OpenCV's ArUco detector for one dictionary, with corners refined to sub-pixel precision."""

    def __init__(self, dictionary: str) -> None:
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        # Half a cell: OpenCV's 0.3 leaves too few pixels at two metres, more than 0.5 reaches the next cell's corner.
        parameters.relativeCornerRefinmentWinSize = 0.5
        markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
        self._detector = cv2.aruco.ArucoDetector(markers, parameters)

    def detect(self, pixels: Pixels) -> list[Marker]:
        """Find the markers of a grey image."""
        corners, ids, _rejected = self._detector.detectMarkers(pixels)
        if ids is None:
            return []
        numbers = np.asarray(ids).ravel().tolist()
        quads = [np.asarray(quad, dtype=np.float64).reshape(4, 2) for quad in corners]
        return [Marker(int(number), quad) for number, quad in zip(numbers, quads, strict=True)]


def locate(marker: Marker, size_m: float, camera: Camera) -> MarkerPose:
    """Solve a marker's pose by IPPE (Collins and Bartoli 2014), taking the better of its two solutions.

    Raises:
        BadPoseError: the solution is not finite, behind the camera or absurdly far.
    """
    _count, rotations, translations, errors = cv2.solvePnPGeneric(
        _square(size_m), marker.corners_px, camera.matrix, camera.distortion, flags=cv2.SOLVEPNP_IPPE
    )
    if errors is None or not np.isfinite(errors).all():
        raise BadPoseError(f"no pose fits the corners of marker {marker.id}")
    best = int(np.argmin(errors))
    image_from_marker = np.eye(4)
    image_from_marker[:3, :3] = cv2.Rodrigues(rotations[best])[0] @ SQUARE_FROM_MARKER
    image_from_marker[:3, 3] = translations[best].ravel()
    if not np.isfinite(image_from_marker).all() or not 0 < image_from_marker[2, 3] < FURTHEST_M:
        raise BadPoseError(f"marker {marker.id} would be at {image_from_marker[:3, 3].tolist()} m")
    return MarkerPose(image_from_marker, float(np.ravel(errors)[best]))


def confidence(pose: MarkerPose, side_px: float) -> float:
    """Rate a pose from 0 to 1: 1 / (1 + reprojection error in px), less in proportion below `FULL_SIDE_PX`."""
    return min(1.0, side_px / FULL_SIDE_PX) / (1.0 + pose.error_px)


def quaternion_xyzw(rotation: Array) -> list[float]:
    """Turn a rotation matrix (3, 3) into a unit quaternion with w >= 0 (Bar-Itzhack 2000)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    symmetric = np.array(
        [
            [xx - yy - zz, yx + xy, zx + xz, zy - yz],
            [yx + xy, yy - xx - zz, zy + yz, xz - zx],
            [zx + xz, zy + yz, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    quaternion = np.linalg.eigh(symmetric).eigenvectors[:, -1]
    listed: list[float] = (np.copysign(1.0, quaternion[3]) * quaternion).tolist()
    return listed


def _square(size_m: float) -> Array:
    """Corners of a marker in the order in which they are detected, y down and z into its printed face."""
    half = size_m / 2
    return np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
