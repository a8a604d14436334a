"""Legs and trunk that move far more than in an action, and a person who hardly moves, make an answer doubtful."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.arrays import Array
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from people import STANDING
from som_classifier.body_movement import LEAST_M, BodyMovement, Evidence, log_movements
from som_classifier.kinematics import averaged
from som_classifier.model import Recognition

FRAMES = 60
STAMPS_NS = np.arange(FRAMES) * SECOND_NS // 30
LEGS = ("left_knee", "left_foot", "right_knee", "right_foot")
BODY = BodyMovement(usual=[[math.log(0.05), math.log(0.04)]], most_above=[math.log(2.0), math.log(3.0)], least_m=0.2)
SURE = Recognition("lift", 0.9, {"lift": 1.0}, "right_arm", 0.8)


def swaying(joints: tuple[str, ...], way_m: float) -> Array:
    """A person whose joints swing sideways, slowly."""
    postures = np.repeat(STANDING[None], FRAMES, axis=0)
    swing = way_m * np.sin(np.linspace(0, 2 * np.pi, FRAMES))
    for joint in joints:
        postures[:, INDEX[joint], 0] += swing
    return postures


def judged(legs_m: float, trunk_m: float, moved_m: float = 0.5) -> Recognition:
    moved = np.log([legs_m, trunk_m])
    return BODY.doubted(SURE, 0, Evidence(np.zeros(1, np.float32), np.zeros(1, np.float32), moved, moved_m))


def test_a_part_moves_by_the_standard_deviation_of_its_joints() -> None:
    legs, trunk = np.exp(log_movements(averaged(STAMPS_NS, swaying(LEGS, 0.2))))
    assert legs == pytest.approx(0.2 / math.sqrt(2), rel=0.05) and trunk == pytest.approx(LEAST_M)
    legs, trunk = np.exp(log_movements(averaged(STAMPS_NS, swaying(("neck", "head"), 0.2))))
    assert legs == pytest.approx(LEAST_M) and trunk == pytest.approx(0.2 / math.sqrt(2), rel=0.05)


def test_arms_are_no_part_of_it() -> None:
    moved = log_movements(averaged(STAMPS_NS, swaying(("left_hand", "right_hand", "left_elbow", "right_elbow"), 0.5)))
    assert np.exp(moved) == pytest.approx([LEAST_M, LEAST_M])


def test_only_joints_that_are_seen_count() -> None:
    postures = swaying(LEGS, 0.2)
    postures[:, INDEX["left_foot"]] = np.nan
    postures[::2, INDEX["right_foot"]] = np.nan
    legs, trunk = np.exp(log_movements(averaged(STAMPS_NS, postures)))
    assert legs == pytest.approx(0.2 / math.sqrt(2), rel=0.1) and trunk == pytest.approx(LEAST_M)


def test_a_part_that_is_not_seen_raises_no_doubt() -> None:
    postures = swaying(LEGS, 0.2)
    postures[:, [INDEX[joint] for joint in LEGS]] = np.nan
    legs, trunk = log_movements(averaged(STAMPS_NS, postures))
    assert math.isnan(legs) and np.exp(trunk) == pytest.approx(LEAST_M)
    assert judged(math.nan, 0.03) is SURE
    assert judged(math.nan, 0.3).familiarity == pytest.approx(0.8 * 0.12 / 0.3)


@given(st.floats(0.01, 0.1), st.floats(0.01, 0.12))
def test_what_moves_no_more_than_in_most_instances_is_as_sure_as_before(legs_m: float, trunk_m: float) -> None:
    assert judged(legs_m * 0.999, trunk_m * 0.999) is SURE


@given(st.floats(1.01, 10.0), st.booleans())
def test_a_part_that_moves_k_times_more_makes_the_answer_k_times_less_sure(times: float, of_legs: bool) -> None:
    answer = judged(0.1 * times, 0.03) if of_legs else judged(0.03, 0.12 * times)
    assert answer.doubtful and not answer.unknown and answer.confidence == SURE.confidence
    assert answer.familiarity == pytest.approx(0.8 / times)


def test_who_hardly_moves_does_nothing_that_is_known() -> None:
    answer = judged(0.03, 0.03, moved_m=0.1)
    assert answer.doubtful and answer.unknown
    assert (answer.confidence, answer.familiarity) == (pytest.approx(0.45), pytest.approx(0.4))
