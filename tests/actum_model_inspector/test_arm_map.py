"""The arms that are drawn are those that the recogniser's third map learns."""

import numpy as np
import pytest

from actum.skeletons import INDEX
from actum.som import Som
from actum_model_inspector.arm_map import arm_joints, arm_map, arm_steps_m
from actum_model_inspector.stick_figures import HEIGHT_M, laid_out
from recognisers import tiny_samples
from som_classifier.first_layer import MAP_INPUTS, VELOCITY_WEIGHT, frame_inputs
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

SHOULDER, ELBOW, HAND = (INDEX[f"right_{name}"] for name in ("shoulder", "elbow", "hand"))
POSTURES, VELOCITIES = tiny_samples()[0].postures, tiny_samples()[0].velocities
UNITS = MAP_INPUTS["arms"].of(frame_inputs(POSTURES, VELOCITIES))


def test_an_arm_hangs_from_the_shoulder_as_it_did() -> None:
    joints, steps_m = arm_joints(UNITS), arm_steps_m(UNITS)
    ends = [ELBOW, HAND]
    np.testing.assert_allclose(
        joints[:, ends] - joints[:, [SHOULDER]], POSTURES[:, ends] - POSTURES[:, [SHOULDER]], atol=1e-6
    )
    np.testing.assert_allclose(steps_m[:, ends], VELOCITIES[:, ends] - VELOCITIES[:, [SHOULDER]], atol=1e-6)


def test_the_shoulder_is_drawn_at_the_height_of_the_middle_of_its_units_place() -> None:
    shoulder = laid_out(arm_joints(UNITS), np.full((len(UNITS), 2), 5.0), 1.0)[:, SHOULDER]
    assert shoulder[:, 1] == pytest.approx(5.0, abs=0.02)
    assert shoulder[:, 0] == pytest.approx(5.0 - 0.1 / HEIGHT_M, abs=0.02)


def test_nothing_but_the_arm_is_drawn_and_moves() -> None:
    others = np.delete(np.arange(15), [SHOULDER, ELBOW, HAND])
    assert np.isnan(arm_joints(UNITS)[:, others]).all()
    assert not arm_steps_m(UNITS)[:, others].any()


def test_the_fastest_unit_is_named_by_its_speed() -> None:
    units = np.zeros((6, 12))
    units[4, 9] = VELOCITY_WEIGHT * LAG_TIME_CONSTANT_S * 2.0
    arms = Som(2, 3, units)
    assert "the longest at 2.0 m/s" in arm_map(arms, mirrors=True).axes[0].get_title(loc="left")


def test_a_map_of_arms_at_rest_is_drawn() -> None:
    assert "0.0 m/s" in arm_map(Som(2, 3, np.zeros((6, 12))), mirrors=True).axes[0].get_title(loc="left")


@pytest.mark.parametrize("mirrors", [True, False])
def test_left_arms_are_named_only_where_the_model_reads_them_in_a_mirror(mirrors: bool) -> None:
    title = arm_map(Som(2, 3, np.zeros((6, 12))), mirrors).axes[0].get_title(loc="left")
    assert title.startswith("the right arm")
    assert ("in a mirror a left one" in title) == mirrors
