"""Pose estimation: one or two possible poses of each object from the corners of its markers."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum.arrays import Array
from actum.geometry import angle_between_rad
from actum.limits import MAX_COORDINATE_M
from actum.node import Counters
from marker_tracker.detection.marker import Marker
from marker_tracker.pose.camera_model import CameraModel
from marker_tracker.pose.catalogue import MarkedObject, MountedMarker

Solution = tuple[Array, Array, float]
"""A marker's pose: rotation vector (3, 1), translation (3, 1) in metres, root mean square reprojection error in px."""

FULL_SIDE_PX = 24.0
"""Side in pixels below which confidence falls: four pixels for each cell of a 4x4 marker with its border."""
MAX_ERROR_PX = 4.0
"""Reprojection error in pixels above which an object's markers cannot be where the scene file puts them."""
RIVAL_ERROR_RATIO = 4.0
"""Ratio of two solutions' reprojection errors up to which the worse one remains possible."""
RIVAL_ERROR_PX = 1.0
"""Pixels by which the worse one's error may always be larger: the noise of corners."""
DOUBTFUL_ERROR_PX = 0.5
"""Reprojection error in pixels above which a refined pose is compared with the initial one."""
SAME_ROTATION_RAD = 0.05
"""Angle in radians between two solutions up to which they are the same."""
REFINEMENT_STOP = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 10, 1e-6)
"""Iterations and step at which OpenCV stops: the steps converge quadratically."""
NUDGE_PX = np.array([[1e-4, 0.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
"""Shift of the corners in pixels for a second attempt: OpenCV's IPPE fails when a marker is exactly frontal."""
MIN_CORNER_NOISE_PX = 0.2
"""Least standard deviation of corners in pixels, also where they happen to fit a pose exactly."""
MIN_POSITION_NOISE_M = 5e-4
"""Least standard deviation of a position in metres: the sizes and places of markers are not known better."""
HIDDEN_CONFIDENCE = 0.5
"""Confidence of a hidden object's pose relative to a visible one's: the hand that covers it may have released it."""
_IDENTITY_3 = np.eye(3)
"""The identity (3, 3): equal variances and no covariance between x, y and z."""
_IDENTITY_4 = np.eye(4)
"""The identity (4, 4): no motion."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A possible pose of an object.

    Attributes:
        camera_from_object: rigid transform (4, 4) in metres, to the camera frame of the image or of the skeletons.
        error_px: root mean square reprojection error of its markers' corners.
    """

    camera_from_object: Array
    error_px: float


@dataclass(frozen=True, eq=False)
class Measurement:
    """The measurement of an object's pose in one image.

    Attributes:
        object_id: of the object.
        name: of the object.
        poses: the one or two possible ones, the better first, in the skeletons' camera frame.
        noise_m2: covariance (3, 3) of the position, in square metres.
        confidence: 0 to 1.
        hidden: whether its markers are hidden and inferred from their occluders.
    """

    object_id: int
    name: str
    poses: Sequence[Pose]
    noise_m2: Array
    confidence: float
    hidden: bool = False


class BadPoseError(ValueError):
    """No pose in front of the camera fits a marker's corners."""


def measure(objects: Sequence[MarkedObject], camera: CameraModel, counters: Counters) -> list[Measurement]:
    """Measure the poses of an image's objects; count those without a possible pose, or with markers that disagree."""
    measurements = []
    for each in objects:
        try:
            poses = solve(each.markers, camera)
            if len(each.markers) > 1 and poses[0].error_px > MAX_ERROR_PX:
                ids = ", ".join(str(marker.id) for marker, _ in each.markers)
                detail = (
                    f"markers {ids} of {each.name} do not lie where the scene file states: measure their places again"
                )
                counters.reject("markers_disagree", detail)
                poses = solve(each.markers[:1], camera)
        except BadPoseError as error:
            counters.reject("bad_pose", str(error))
        else:
            measurements.append(_measurement(each, poses, camera))
    return measurements


def solve(markers: Sequence[tuple[Marker, MountedMarker]], camera: CameraModel) -> list[Pose]:
    """Find the one or two poses, in the image's camera frame, that fit an object's markers, the better first.

    Each marker gives the two solutions of IPPE (Collins and Bartoli 2014). Each solution is refined to the least
    reprojection error over the corners of all markers (Gauss-Newton), unless that makes it worse.

    Raises:
        BadPoseError: no solution is finite, in front of the camera and nearer than `MAX_COORDINATE_M`.
    """
    corners_px = np.concatenate([marker.corners_px for marker, _ in markers])
    points_m = np.concatenate([mounted.corners_in_object_m for _, mounted in markers])
    poses = [pose for marker, mounted in markers for pose in _from_one(marker, mounted, points_m, corners_px, camera)]
    usable = sorted((pose for pose in poses if _is_usable(pose)), key=lambda pose: pose.error_px)
    if not usable:
        raise BadPoseError(
            f"no position of marker {markers[0][0].id} in front of the camera fits the corners that the image shows: "
            "keep the marker flat"
        )
    best = usable[0]
    possible = (pose for pose in usable[1:] if _is_possible(pose.error_px, best.error_px))
    distinct = (
        pose
        for pose in possible
        if angle_between_rad(pose.camera_from_object, best.camera_from_object) > SAME_ROTATION_RAD
    )
    return [best, *distinct][:2]


def _measurement(marked: MarkedObject, poses: Sequence[Pose], camera: CameraModel) -> Measurement:
    largest, best = marked.markers[0][0], poses[0]
    confidence = min(1.0, largest.side_px / FULL_SIDE_PX) / (1.0 + best.error_px)
    return Measurement(
        marked.id,
        marked.name,
        [Pose(camera.skeleton_from_image @ pose.camera_from_object, pose.error_px) for pose in poses],
        _noise_m2(best, largest.side_px, camera),
        confidence * (HIDDEN_CONFIDENCE if largest.hidden else 1.0),
        largest.hidden,
    )


def _noise_m2(pose: Pose, side_px: float, camera: CameraModel) -> Array:
    """Covariance (3, 3) of a position from the corners' error: larger along the ray, by focal length over side (px)."""
    position_m = pose.camera_from_object[:3, 3]
    distance_m = math.sqrt(position_m @ position_m)
    corner_px = max(MIN_CORNER_NOISE_PX, pose.error_px)
    across_m, along_m = distance_m * corner_px / camera.matrix[0, 0], distance_m * corner_px / side_px
    ray = camera.skeleton_from_image[:3, :3] @ (position_m / distance_m)
    across_m2 = across_m**2 + MIN_POSITION_NOISE_M**2
    noise_m2: Array = (along_m**2 - across_m**2) * (ray[:, None] * ray) + across_m2 * _IDENTITY_3
    return noise_m2


def _from_one(
    marker: Marker, mounted: MountedMarker, points_m: Array, corners_px: Array, camera: CameraModel
) -> list[Pose]:
    """Solve for one marker's poses, and refine them over the points (n, 3) and corners (n, 2) of all markers."""
    solutions = _ippe(mounted.corners_in_square_m, marker.corners_px, camera)
    if not solutions:
        solutions = _ippe(mounted.corners_in_square_m, marker.corners_px + NUDGE_PX, camera)
    if not solutions:
        return []
    least_px = min(error_px for _, _, error_px in solutions)
    possible = [solution for solution in solutions if _is_possible(solution[2], least_px)]
    square_from_object = mounted.square_from_object
    points_in_square_m = points_m @ square_from_object[:3, :3].T + square_from_object[:3, 3]
    refined = [_refined(points_in_square_m, corners_px, camera, turn, shift_m) for turn, shift_m, _ in possible]
    return [Pose(camera_from_square @ square_from_object, error_px) for camera_from_square, error_px in refined]


def _ippe(points_m: Array, corners_px: Array, camera: CameraModel) -> list[Solution]:
    """Solve for both poses of a square with points (4, 3) and corners (4, 2); empty where OpenCV has no answer."""
    _count, rotations, translations, errors = cv2.solvePnPGeneric(
        points_m, corners_px, camera.matrix, camera.distortion, flags=cv2.SOLVEPNP_IPPE
    )
    errors_px: list[float] = [] if errors is None else np.ravel(errors).tolist()
    solutions = [(_floats(r), _floats(t), e) for r, t, e in zip(rotations, translations, errors_px, strict=False)]
    return solutions if all(math.isfinite(error_px) for error_px in errors_px) else []


def _refined(
    points_m: Array, corners_px: Array, camera: CameraModel, rotation: Array, translation_m: Array
) -> tuple[Array, float]:
    """Refine a solution by Gauss-Newton (OpenCV's virtual visual servoing), unless that makes it worse.

    Returns:
        The transform (4, 4) from the points' frame to the image's camera frame, and its reprojection error in px.
    """
    turned, moved_m = cv2.solvePnPRefineVVS(
        points_m, corners_px, camera.matrix, camera.distortion, rotation.copy(), translation_m.copy(), REFINEMENT_STOP
    )
    turned, moved_m = _floats(turned), _floats(moved_m)
    error_px = _error_px(points_m, corners_px, camera, turned, moved_m)
    if not error_px <= DOUBTFUL_ERROR_PX:
        initial_px = _error_px(points_m, corners_px, camera, rotation, translation_m)
        if not error_px <= initial_px:
            turned, moved_m, error_px = rotation, translation_m, initial_px
    transform = _IDENTITY_4.copy()
    transform[:3, :3] = cv2.Rodrigues(turned)[0]
    transform[:3, 3] = moved_m.ravel()
    return transform, error_px


def _floats(vector: object) -> Array:
    return np.asarray(vector, dtype=np.float64)


def _error_px(points_m: Array, corners_px: Array, camera: CameraModel, rotation: Array, translation_m: Array) -> float:
    """Root mean square distance of projected points (n, 3) from corners (n, 2)."""
    projected = cv2.projectPoints(points_m, rotation, translation_m, camera.matrix, camera.distortion)[0][:, 0]
    off = (projected - corners_px).ravel()
    return math.sqrt(2 * float(off @ off) / len(off))


def _is_possible(error_px: float, least_px: float) -> bool:
    """Return whether a solution remains possible beside the best one."""
    return error_px <= max(RIVAL_ERROR_RATIO * least_px, least_px + RIVAL_ERROR_PX)


def _is_usable(pose: Pose) -> bool:
    finite = math.isfinite(pose.error_px) and math.isfinite(float(pose.camera_from_object.sum()))
    return finite and 0 < pose.camera_from_object[2, 3] < MAX_COORDINATE_M
