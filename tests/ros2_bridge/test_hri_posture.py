"""Standing, sitting, crouching and lying by joints; whatever else is OTHER."""

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.skeletons import INDEX
from people import STANDING, lacking
from ros2_bridge.hri_out.posture import CROUCHING, LAYING, OTHER, SITTING, posture_of
from ros2_bridge.hri_out.posture import STANDING as STANDS

LEGS = [f"{side}_{joint}" for side in ("left", "right") for joint in ("knee", "foot")]


def with_legs(thigh_deg: float, shank_deg: float, bow_deg: float = 0) -> np.ndarray:
    """Who faces the camera with thighs that far forward of hanging, shanks that far backward, the trunk bowed."""
    joints = STANDING.copy()
    for side in ("left", "right"):
        hip, knee, foot = (INDEX[f"{side}_{joint}"] for joint in ("hip", "knee", "foot"))
        joints[knee] = joints[hip] + 0.42 * np.array([0, cos(radians(thigh_deg)), -sin(radians(thigh_deg))])
        joints[foot] = joints[knee] + 0.44 * np.array([0, cos(radians(shank_deg)), sin(radians(shank_deg))])
    hips = joints[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0)
    above = [i for i in range(15) if i < INDEX["left_hip"]]
    c, s = cos(radians(bow_deg)), sin(radians(bow_deg))
    joints[above] = hips + (joints[above] - hips) @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]])
    return joints


@pytest.mark.parametrize(
    ("joints", "posture"),
    [
        (STANDING, STANDS),
        (with_legs(20, 10), STANDS),
        (with_legs(0, 0, bow_deg=40), STANDS),
        (with_legs(85, 5), SITTING),
        (with_legs(75, 0, bow_deg=20), SITTING),
        (with_legs(80, 80), CROUCHING),
        (with_legs(120, 40, bow_deg=50), CROUCHING),
        (with_legs(0, 0, bow_deg=80), OTHER),
        (with_legs(0, 90), OTHER),
        (with_legs(90, -80), OTHER),
    ],
    ids=[
        "upright",
        "a step",
        "a bow",
        "a chair",
        "leaning",
        "squat",
        "bent squat",
        "deep bow",
        "kneeling",
        "on the floor",
    ],
)
def test_a_posture_is_known_by_trunk_and_legs(joints, posture) -> None:
    assert posture_of(joints, None) == posture


@given(st.floats(-180, 180))
def test_whoever_lies_lies_whichever_way_they_point(turn_deg) -> None:
    lying = (STANDING - STANDING[2])[:, [0, 2, 1]]
    c, s = cos(radians(turn_deg)), sin(radians(turn_deg))
    assert posture_of(lying @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) + [0, 1, 3], None) == LAYING


@pytest.mark.parametrize("up", [[0.0, -1.0, 0.0], [0.0, -9.81, 0.0]])
def test_up_is_a_direction_of_any_length(up) -> None:
    assert posture_of(STANDING, up) == STANDS


def test_gravity_decides_not_the_cameras_axes() -> None:
    assert posture_of(STANDING, [0.0, 0.0, -1.0]) == LAYING
    tilted = radians(30)
    turn = np.array([[1, 0, 0], [0, cos(tilted), -sin(tilted)], [0, sin(tilted), cos(tilted)]])
    up = (turn @ [0, -1, 0]).tolist()
    assert posture_of(with_legs(85, 5) @ turn.T, up) == SITTING


@pytest.mark.parametrize("missing", [("neck",), ("left_hip",), LEGS])
def test_of_who_is_half_seen_the_posture_is_not_known(missing) -> None:
    assert posture_of(lacking(STANDING, *missing), None) == OTHER


def test_one_leg_is_enough() -> None:
    assert posture_of(lacking(STANDING, "left_foot"), None) == STANDS


@given(st.lists(st.floats(-100, 100), min_size=45, max_size=45))
def test_any_joints_have_a_posture(numbers) -> None:
    assert posture_of(np.array(numbers).reshape(15, 3), None) in range(5)
