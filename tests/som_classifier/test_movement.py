"""How far a person moves: the same at any frame rate, for as long as it lasts, and hardly more with jitter."""

import numpy as np
import pytest

from actum.skeletons import INDEX
from som_classifier.kinematics import averaged, movement_m

HAND = INDEX["right_hand"]
WAY_M = 0.6
OF_TWO = WAY_M / np.sqrt(2)
"""The root mean square over two joints where one of them goes that far."""


def lifted(seconds: float = 2.0, rate_hz: int = 30, rest_s: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Stamps and postures of somebody who rests, lifts the hand, and holds it up."""
    times_s = np.arange(0, seconds + 2 * rest_s, 1 / rate_hz)
    postures = np.zeros((len(times_s), 15, 3))
    postures[:, HAND, 1] = WAY_M * np.clip((times_s - rest_s) / seconds, 0, 1)
    return np.rint(times_s * 1e9).astype(np.int64), postures


@pytest.mark.parametrize("rate_hz", [8, 15, 30, 60])
@pytest.mark.parametrize(("seconds", "rest_s"), [(0.5, 0.5), (2.0, 1.0), (4.0, 20.0)])
def test_it_is_the_way_between_the_most_different_postures(rate_hz: int, seconds: float, rest_s: float) -> None:
    assert movement_m(averaged(*lifted(seconds, rate_hz, rest_s))) == pytest.approx(OF_TWO, rel=0.02)


def test_who_stays_where_they_are_does_not_move() -> None:
    stamps_ns, postures = lifted()
    assert movement_m(averaged(stamps_ns, postures[:1].repeat(len(postures), axis=0))) == 0.0


def test_jitter_is_little_movement_however_long_it_lasts() -> None:
    jitter = np.random.default_rng(0).normal(0, 0.01, (1800, 15, 3))
    assert movement_m(averaged(np.arange(1800) * 33_333_333, jitter)) < 0.04


def test_a_jump_of_a_hand_for_one_frame_is_little_movement() -> None:
    stamps_ns, postures = lifted()
    still = postures[:1].repeat(len(postures), axis=0)
    still[40, HAND, 1] += WAY_M
    assert movement_m(averaged(stamps_ns, still)) < 0.2 * OF_TWO


def test_joints_that_are_missing_do_not_count_where_they_are_missing() -> None:
    stamps_ns, postures = lifted()
    postures[:, INDEX["right_foot"]] = np.nan
    postures[10:50, INDEX["left_foot"]] = np.nan
    assert movement_m(averaged(stamps_ns, postures)) == pytest.approx(OF_TWO, rel=0.02)


def test_who_shares_no_joint_with_what_was_before_does_not_move() -> None:
    stamps_ns, postures = lifted()
    postures[:60, HAND] = np.nan
    postures[60:, :HAND] = postures[60:, HAND + 1 :] = np.nan
    postures[60:, HAND] = 0.0
    assert movement_m(averaged(stamps_ns, postures)) == 0.0
