"""The arms that are drawn are those that the recogniser's third map learns."""

import numpy as np
import pytest

from actum.skeletons import INDEX
from actum.som import Som
from actum_model_inspector.arm_map import ArmsOnBodies, arm_map, fastest_m
from actum_model_inspector.stick_figures import STANDING
from recognisers import tiny_samples
from som_classifier.first_layer import VELOCITY_WEIGHT, arm_inputs, frame_inputs
from som_classifier.handedness import mirrored
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

SHOULDER, ELBOW, HAND = (INDEX[f"right_{name}"] for name in ("shoulder", "elbow", "hand"))
POSTURES, VELOCITIES = tiny_samples()[0].postures, tiny_samples()[0].velocities
UNITS = arm_inputs(frame_inputs(POSTURES, VELOCITIES))


def test_a_body_s_own_arm_stays_where_it_is() -> None:
    drawn = ArmsOnBodies.of(UNITS, POSTURES)
    arm = [SHOULDER, ELBOW, HAND]
    np.testing.assert_allclose(drawn.arms[:, arm], POSTURES[:, arm])
    np.testing.assert_allclose(drawn.steps_m[:, arm], VELOCITIES[:, arm] - VELOCITIES[:, [SHOULDER]])
    assert not np.delete(drawn.steps_m, arm, axis=1).any()


def test_every_joint_is_drawn_once_and_the_shoulder_with_both() -> None:
    drawn = ArmsOnBodies.of(UNITS, POSTURES)
    of_body, of_arm = (~np.isnan(joints).any(axis=(0, 2)) for joints in (drawn.bodies, drawn.arms))
    assert np.flatnonzero(of_body & of_arm).tolist() == [SHOULDER]
    assert (of_body | of_arm).all()


def test_an_arm_hangs_from_the_shoulder_of_whatever_body_it_is_put_on() -> None:
    drawn = ArmsOnBodies.of(UNITS, np.broadcast_to(STANDING, POSTURES.shape))
    np.testing.assert_allclose(drawn.arms[:, HAND] - STANDING[SHOULDER], POSTURES[:, HAND] - POSTURES[:, SHOULDER])


def test_in_a_mirror_it_is_the_left_arm() -> None:
    drawn = ArmsOnBodies.of(UNITS, POSTURES).mirrored()
    left = [INDEX[f"left_{name}"] for name in ("shoulder", "elbow", "hand")]
    np.testing.assert_allclose(drawn.arms[:, left], mirrored(POSTURES)[:, left])
    assert np.isnan(drawn.bodies[:, left[1:]]).all()


def test_the_fastest_unit_is_named_by_its_speed() -> None:
    units = np.zeros((6, 12))
    units[4, 9] = VELOCITY_WEIGHT * LAG_TIME_CONSTANT_S * 2.0
    arms = Som(2, 3, units)
    assert fastest_m(arms) == pytest.approx(LAG_TIME_CONSTANT_S * 2.0)
    assert "the longest at 2.0 m/s" in arm_map(arms, mirrors=True).axes[0].get_title(loc="left")


def test_a_map_of_arms_at_rest_is_drawn() -> None:
    assert "0.0 m/s" in arm_map(Som(2, 3, np.zeros((6, 12))), mirrors=True).axes[0].get_title(loc="left")


@pytest.mark.parametrize("mirrors", [True, False])
def test_left_arms_are_named_only_where_the_model_reads_them_in_a_mirror(mirrors: bool) -> None:
    title = arm_map(Som(2, 3, np.zeros((6, 12))), mirrors).axes[0].get_title(loc="left")
    assert title.startswith("the right arm")
    assert ("in a mirror a left one" in title) == mirrors
