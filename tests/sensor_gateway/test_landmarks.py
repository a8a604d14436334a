"""33 landmarks become the fifteen joints: left from left, middles as middles."""

import numpy as np
import pytest

from actum.skeletons import INDEX, JOINTS
from camera_bodies import as_seen, landmark_points, standing_at
from people import STANDING
from sensor_gateway.people.pose_estimator import LANDMARKS, MEDIAPIPE_33, MEDIAPIPE_WEIGHTS


def test_every_joint_has_landmarks_and_every_name_is_one() -> None:
    assert tuple(MEDIAPIPE_33) == JOINTS
    assert len(LANDMARKS) == len(set(LANDMARKS)) == 33
    assert {name for names in MEDIAPIPE_33.values() for name in names} <= set(LANDMARKS)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_sides_joints_are_made_of_that_sides_landmarks_only(side: str) -> None:
    sided = {joint: names for joint, names in MEDIAPIPE_33.items() if joint.startswith(side)}
    assert len(sided) == 6
    assert all(name.startswith(side) for names in sided.values() for name in names)


def test_joints_are_the_middles_of_their_landmarks() -> None:
    joints = MEDIAPIPE_WEIGHTS @ landmark_points(STANDING)
    assert joints[INDEX["left_hand"]] == pytest.approx(STANDING[INDEX["left_hand"]])
    assert joints[INDEX["head"]] == pytest.approx(STANDING[INDEX["head"]])
    shoulders = STANDING[[INDEX["left_shoulder"], INDEX["right_shoulder"]]].mean(axis=0)
    hips = STANDING[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0)
    assert joints[INDEX["neck"]] == pytest.approx(shoulders)
    assert joints[INDEX["torso"]] == pytest.approx((shoulders + hips) / 2)


def test_a_joint_is_as_sure_as_its_least_visible_landmark() -> None:
    seen = as_seen(standing_at(0.0, 2.5))
    seen.visibility[LANDMARKS.index("left_index")] = 0.25
    confidence = seen.confidence
    assert confidence[INDEX["left_hand"]] == 0.25
    assert np.delete(confidence, INDEX["left_hand"]).tolist() == [1.0] * 14
