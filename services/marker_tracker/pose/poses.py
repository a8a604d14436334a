"""An object's pose from the corners of its markers, and what else it might be."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.decoding import Marker
from marker_tracker.detection.images import Camera
from marker_tracker.pose.catalogue import Carried
from marker_tracker.pose.rotations import apart_rad

Array = NDArray[np.float64]

Start = tuple[Array, Array, float]
"""A solution: rotation vector, translation and reprojection error in px."""

FURTHEST_M = 100.0
FULL_SIDE_PX = 24.0
"""From this side on, four pixels for each cell of a 4x4 marker with its border, size costs no confidence."""
WORST_ERROR_PX = 4.0
"""Beyond it, several markers do not fit the places the scene gives them."""
DECISIVE = 4.0
"""A solution with so many times the error of the better one, and at least a pixel more, is none."""
DOUBTFUL_PX = 0.5
"""From this error on a refined pose is held against the one it was refined from."""
SAME_RAD = 0.05
STOP = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 10, 1e-6)
NUDGE_PX = np.array([[1e-4, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
"""OpenCV's IPPE has no answer when a marker is frontal to within some nanometres; this is enough for one."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Where an object may be; `error_px` is the root mean square reprojection error of its markers' corners."""

    image_from_object: Array
    error_px: float


class BadPoseError(ValueError):
    """Corners that no marker in front of the camera can have."""


def solve(markers: Sequence[tuple[Marker, Carried]], camera: Camera) -> list[Pose]:
    """Find the one or two poses that an object's markers allow, the better first.

    Each marker gives the two solutions of IPPE (Collins and Bartoli 2014); each is refined to the least reprojection
    error over the corners of all of them (Gauss-Newton), unless that makes it worse.

    Raises:
        BadPoseError: no solution is finite, in front of the camera and not absurdly far.
    """
    corners_px = np.concatenate([marker.corners_px for marker, _ in markers])
    points = np.concatenate([carried.in_object for _, carried in markers])
    poses = [pose for marker, it in markers for pose in _from_one(marker, it, points, corners_px, camera)]
    usable = sorted((pose for pose in poses if _is_usable(pose)), key=lambda pose: pose.error_px)
    if not usable:
        raise BadPoseError(f"no pose in front of the camera fits the corners of marker {markers[0][0].id}")
    best = usable[0]
    return [best, *(pose for pose in usable[1:] if _is_another(pose, best))][:2]


def confidence(pose: Pose, side_px: float) -> float:
    """Rate a pose from 0 to 1: 1 / (1 + reprojection error in px), less in proportion below `FULL_SIDE_PX`."""
    return min(1.0, side_px / FULL_SIDE_PX) / (1.0 + pose.error_px)


def _from_one(marker: Marker, carried: Carried, points: Array, corners_px: Array, camera: Camera) -> list[Pose]:
    """Refine both solutions of one marker, in its square frame, over the points (n, 3) of the whole object."""
    starts = _ippe(carried.in_square, marker.corners_px, camera)
    if not starts:
        starts = _ippe(carried.in_square, marker.corners_px + NUDGE_PX, camera)
    if not starts:
        return []
    least = min(error for _, _, error in starts)
    near = [start for start in starts if _rivals(start[2], least)]
    square_from_object = carried.square_from_object
    in_square = points @ square_from_object[:3, :3].T + square_from_object[:3, 3]
    refined = [_refined(in_square, corners_px, camera, rotation, translation) for rotation, translation, _ in near]
    return [Pose(image_from_square @ square_from_object, error) for image_from_square, error in refined]


def _ippe(square: Array, corners_px: Array, camera: Camera) -> list[Start]:
    """Solve for both poses with their errors; none where OpenCV has no answer."""
    _count, rotations, translations, errors = cv2.solvePnPGeneric(
        square, corners_px, camera.matrix, camera.distortion, flags=cv2.SOLVEPNP_IPPE
    )
    listed: list[float] = [] if errors is None else np.ravel(errors).tolist()
    starts: list[Start] = [
        (_numbers(r), _numbers(t), e) for r, t, e in zip(rotations, translations, listed, strict=False)
    ]
    return starts if all(math.isfinite(error) for error in listed) else []


def _refined(
    points: Array, corners_px: Array, camera: Camera, rotation: Array, translation: Array
) -> tuple[Array, float]:
    """Refine a pose by Gauss-Newton (OpenCV's virtual visual servoing); one that it makes worse is left as it is."""
    turned, moved = cv2.solvePnPRefineVVS(
        points, corners_px, camera.matrix, camera.distortion, rotation.copy(), translation.copy(), STOP
    )
    turned, moved = _numbers(turned), _numbers(moved)
    error_px = _error_px(points, corners_px, camera, turned, moved)
    if not error_px <= DOUBTFUL_PX:
        start_px = _error_px(points, corners_px, camera, rotation, translation)
        if not error_px <= start_px:
            turned, moved, error_px = rotation, translation, start_px
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(turned)[0]
    pose[:3, 3] = moved.ravel()
    return pose, error_px


def _numbers(vector: object) -> Array:
    return np.asarray(vector, dtype=np.float64)


def _error_px(points: Array, corners_px: Array, camera: Camera, rotation: Array, translation: Array) -> float:
    off = cv2.projectPoints(points, rotation, translation, camera.matrix, camera.distortion)[0][:, 0] - corners_px
    return math.sqrt(float((off * off).sum()) / len(off))


def _rivals(error_px: float, least_px: float) -> bool:
    return error_px <= max(DECISIVE * least_px, least_px + 1.0)


def _is_usable(pose: Pose) -> bool:
    finite = math.isfinite(pose.error_px) and math.isfinite(float(pose.image_from_object.sum()))
    return finite and 0 < pose.image_from_object[2, 3] < FURTHEST_M


def _is_another(pose: Pose, best: Pose) -> bool:
    rivals = _rivals(pose.error_px, best.error_px)
    return rivals and apart_rad(pose.image_from_object, best.image_from_object) > SAME_RAD
