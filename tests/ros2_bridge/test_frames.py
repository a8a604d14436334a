"""Coordinates in ROS: optical frames as ours, bodies with x forward, y left, z up."""

from math import cos, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.geometry import apply, quaternion_xyzw
from actum.node import SECOND_NS
from people import STANDING, lacking, turned
from ros2_bridge import frames

FORWARD, LEFT, UP = np.eye(3)
"""ROS's axes of bodies."""
TORSO = 2


def direction(transform: np.ndarray, axis: np.ndarray) -> np.ndarray:
    return transform[:3, :3] @ axis


@pytest.mark.parametrize(("optical", "link"), [((0, 0, 1), FORWARD), ((1, 0, 0), -LEFT), ((0, 1, 0), -UP)])
def test_ahead_of_the_camera_is_forward_its_right_is_not_left_and_down_is_not_up(optical, link) -> None:
    assert (frames.LINK_FROM_OPTICAL @ optical).tolist() == link.tolist()


def test_the_optical_frame_is_turned_in_the_link_as_urdfs_say_it() -> None:
    assert quaternion_xyzw(frames.LINK_FROM_OPTICAL) == pytest.approx([-0.5, 0.5, -0.5, 0.5])


def test_of_a_person_facing_the_camera_forward_leads_to_it_left_to_the_images_right_and_up_is_up() -> None:
    optical_from_body = frames.optical_from_body(STANDING)
    assert direction(optical_from_body, FORWARD) == pytest.approx([0, 0, -1], abs=0.05)
    assert direction(optical_from_body, LEFT) == pytest.approx([1, 0, 0], abs=0.05)
    assert direction(optical_from_body, UP) == pytest.approx([0, -1, 0], abs=0.05)


def test_a_body_stands_on_its_hips_with_the_torso_straight_above() -> None:
    optical_from_body = frames.optical_from_body(STANDING)
    torso = apply(np.linalg.inv(optical_from_body), STANDING[TORSO])
    assert torso[:2] == pytest.approx([0, 0], abs=1e-9)
    assert torso[2] == pytest.approx(0.26, abs=0.01)


def test_who_turns_to_their_left_turns_about_up_by_the_positive_angle() -> None:
    before, after = (frames.optical_from_body(turned(STANDING, angle)) for angle in (0.0, radians(30)))
    in_body = before[:3, :3].T @ after[:3, :3]
    assert in_body == pytest.approx(
        np.array([[cos(0.5236), -sin(0.5236), 0], [sin(0.5236), cos(0.5236), 0], [0, 0, 1]]), abs=0.02
    )


def test_a_body_of_which_too_little_is_known_has_no_frame() -> None:
    assert frames.optical_from_body(lacking(STANDING, "torso")) is None
    assert frames.optical_from_body(np.zeros((15, 3))) is None


def test_a_level_camera_has_level_axes() -> None:
    for up_in_camera in (None, [0.0, -1.0, 0.0], [0.0, -7.0, 0.0]):
        assert frames.optical_from_level(up_in_camera).tolist() == frames.LINK_FROM_OPTICAL.T.tolist()


@given(st.floats(-80, 80), st.floats(-180, 180))
def test_level_axes_have_up_against_gravity_and_forward_along_the_line_of_sight(pitch_deg, roll_deg) -> None:
    pitch, roll = radians(pitch_deg), radians(roll_deg)
    up = np.array([sin(roll) * cos(pitch), -cos(roll) * cos(pitch), sin(pitch)])
    optical_from_level = frames.optical_from_level(up.tolist())
    assert direction(optical_from_level, UP) == pytest.approx(up, abs=1e-9)
    sight_in_level = optical_from_level.T @ [0, 0, 1]
    assert sight_in_level == pytest.approx([cos(pitch), 0, sin(pitch)], abs=1e-9)


@given(st.integers(0, frames.LATEST_NS - 1))
def test_a_stamp_is_seconds_and_the_rest_and_nothing_is_lost(stamp_ns) -> None:
    time = frames.ros_time(stamp_ns)
    assert time.sec * SECOND_NS + time.nanosec == stamp_ns
    assert 0 <= time.sec < 2**31
    assert 0 <= time.nanosec < SECOND_NS
