"""A small marker that nearly faces the camera allows two poses; the right one is taken and kept."""

from typing import Any

import cv2
import numpy as np
import pytest

from actum.geometry import angle_between_rad
from marker_tracker.detection.marker import Marker
from marker_tracker.pose.camera_model import CameraModel
from marker_tracker.pose.catalogue import MountedMarker
from marker_tracker.pose.disambiguation import PoseDisambiguation
from marker_tracker.pose.poses import Pose, solve

CAMERA = CameraModel(np.array([[525.0, 0, 319.5], [0, 525.0, 239.5], [0, 0, 1]]), np.zeros(0), np.eye(4))
MOUNTED = MountedMarker(1, 0.08)


def truth(tilt: Any, distance_m: float) -> Any:
    image_from_marker = np.eye(4)
    image_from_marker[:3, :3] = cv2.Rodrigues(np.array(tilt, dtype=float))[0] @ np.diag([1.0, -1.0, -1.0])
    image_from_marker[:3, 3] = [0.1, 0.05, distance_m]
    return image_from_marker


def seen(image_from_marker: Any, noise_px: float = 0.0, seed: int = 0) -> list[Pose]:
    """The poses that a marker's corners allow, with noise."""
    image_from_square = image_from_marker @ np.diag([1.0, -1.0, -1.0, 1.0])
    rotation = cv2.Rodrigues(image_from_square[:3, :3])[0]
    corners = cv2.projectPoints(MOUNTED.corners_in_square_m, rotation, image_from_square[:3, 3], CAMERA.matrix, None)[
        0
    ][:, 0]
    noisy = corners + np.random.default_rng(seed).normal(0, noise_px, (4, 2))
    return solve([(Marker("DICT_4X4_50", 1, noisy), MOUNTED)], CAMERA)


def followed(poses: list[list[Pose]]) -> list[Any]:
    disambiguation, rotation, rotations = PoseDisambiguation(), None, []
    for each in poses:
        rotation = disambiguation.choose(each, rotation).camera_from_object[:3, :3]
        rotations.append(rotation)
    return rotations


@pytest.mark.parametrize("distance_m", [0.4, 0.8, 1.6])
@pytest.mark.parametrize("tilt", [(0.6, 0.0, 0.0), (0.0, -0.6, 0.4), (0.4, 0.5, 2.0)])
def test_exact_corners_give_the_true_pose_first(tilt, distance_m) -> None:
    best = seen(truth(tilt, distance_m))[0]
    assert np.allclose(best.camera_from_object, truth(tilt, distance_m), atol=1e-4)


@pytest.mark.parametrize("tilt", [(0.0, 0.0, 0.0), (0.0, 0.0, 1.0), (1e-9, 0.0, 0.0)])
def test_a_marker_that_faces_the_camera_exactly_has_a_pose(tilt) -> None:
    assert np.allclose(seen(truth(tilt, 0.7))[0].camera_from_object[:3, 3], [0.1, 0.05, 0.7], atol=1e-3)


@pytest.mark.parametrize("run", range(8))
@pytest.mark.parametrize("tilt", [(0.35, 0.0, 0.0), (0.0, -0.4, 0.3)])
def test_a_choice_is_changed_at_most_once_and_ends_right(tilt, run) -> None:
    pose = truth(tilt, 1.8)
    rotations = followed([seen(pose, 0.15, 1000 * run + i) for i in range(200)])
    wrong = np.array([angle_between_rad(rotation, pose) > 0.35 for rotation in rotations])
    assert np.count_nonzero(np.diff(wrong.astype(int))) <= 1
    assert not wrong[-50:].any()


def test_a_choice_follows_a_marker_that_turns_through_facing_the_camera() -> None:
    poses = [truth((angle, 0.0, 0.0), 0.8) for angle in np.linspace(-0.7, 0.7, 120)]
    rotations = followed([seen(pose, 0.1, i) for i, pose in enumerate(poses)])
    assert all(angle_between_rad(rotations[i], poses[i]) < 0.2 for i in (0, 20, 100, 119))


def test_other_evidence_by_far_undoes_a_choice_within_three_images() -> None:
    one, other = np.eye(4), np.eye(4)
    other[:3, :3] = cv2.Rodrigues(np.array([0.8, 0.0, 0.0]))[0]
    first = [[Pose(one, 0.1), Pose(other, 0.2)]] * 20
    then = [[Pose(other, 0.1), Pose(one, 3.0)]] * 4
    rotations = followed(first + then)
    assert angle_between_rad(rotations[19], one) < 0.1
    assert angle_between_rad(rotations[-1], other) < 0.1
