"""The ray of a pointing arm, computed by hand."""

import numpy as np
import pytest

from action_fusion.choice.pointing import fingertip_m, pointing_angles, pointing_side
from action_fusion.tracks.actors import Actor
from actum.skeletons import INDEX


def still_actor(frames: int, **joints: tuple[float, float, float]) -> Actor:
    postures = np.full((frames, 15, 3), np.nan)
    for name, place in joints.items():
        postures[:, INDEX[name]] = place
    return Actor(np.arange(frames, dtype=float), np.tile(np.eye(4), (frames, 1, 1)), postures, bodies=[])


def test_the_fingertip_is_a_decimetre_beyond_the_hand_along_the_forearm() -> None:
    actor = still_actor(2, left_elbow=(0.2, 0.0, 0.1), left_hand=(0.2, 0.3, 0.5))
    assert np.allclose(fingertip_m(actor, "left"), (0.2, 0.3 + 0.06, 0.5 + 0.08))
    assert np.isnan(fingertip_m(actor, "right")).all()


def test_the_angle_is_between_the_lines_from_the_head() -> None:
    head, tip, thing = np.zeros((3, 3)), np.tile([0.0, 0.0, 0.7], (3, 1)), np.tile([0.0, 2.0, 2.0], (3, 1))
    assert pointing_angles(thing[None], tip, head) == [pytest.approx(np.pi / 4)]


def test_only_the_last_third_of_the_known_frames_counts() -> None:
    head, thing = np.zeros((10, 3)), np.tile([0.0, 0.0, 2.0], (10, 1))
    tip = np.array([[0.0, 1.0, 0.0]] * 6 + [[0.0, 0.0, 1.0]] * 3 + [[np.nan] * 3])
    assert pointing_angles(thing[None], tip, head) == [pytest.approx(0.0)]


def test_an_arm_that_is_never_known_points_nowhere() -> None:
    unknown = np.full((4, 3), np.nan)
    assert pointing_angles(np.ones((1, 4, 3)), unknown, np.zeros((4, 3))) == [np.inf]


def test_the_hand_that_points_is_the_one_furthest_from_the_body() -> None:
    head, hanging, out = (0.0, 0.75, 0.0), (-0.25, 0.0, 0.05), (0.2, 0.5, 0.6)
    actor = still_actor(
        6, head=head, left_elbow=(0.2, 0.3, 0.3), left_hand=out, right_elbow=(-0.25, 0.3, 0.0), right_hand=hanging
    )
    assert pointing_side(actor, ("right", "left")) == "left"
    assert pointing_side(actor, ("right",)) == "right"


def test_a_hand_that_is_never_known_does_not_point() -> None:
    actor = still_actor(4, head=(0.0, 0.75, 0.0), left_elbow=(0.2, 0.3, 0.0), left_hand=(0.2, 0.0, 0.0))
    assert pointing_side(actor, ("right", "left")) == "left"
