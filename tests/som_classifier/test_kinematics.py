"""Resting joints are steadied, fast ones hardly delayed, and missing ones are nobody else's concern."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS
from people import STANDING
from som_classifier.kinematics import GAP_NS, LAG_TIME_CONSTANT_S, STILL_TIME_CONSTANT_S, Kinematics, KinematicsFilter

RATE_HZ = 30
HAND = 8
POSTURE = STANDING - STANDING[2]


def filtered(joints: Sequence[np.ndarray], rate_hz: float = RATE_HZ) -> list[Kinematics]:
    movement = KinematicsFilter()
    return [movement.step(round(i * SECOND_NS / rate_hz), frame) for i, frame in enumerate(joints)]


def hand_at(path: np.ndarray) -> np.ndarray:
    """A person (n, 15, 3) of whom only the right hand moves, along a path (n, 3)."""
    joints = np.tile(POSTURE, (len(path), 1, 1))
    joints[:, HAND] += path
    return joints


def steadily(speed_mps: float, seconds: float, rate_hz: float) -> np.ndarray:
    return hand_at(np.arange(0, seconds, 1 / rate_hz)[:, None] * np.array([0.0, 0.6, 0.8]) * speed_mps)


def reach(rate_hz: float) -> np.ndarray:
    """Half a metre forward and back within a second and a half, rest included."""
    seconds = np.arange(0, 1.5, 1 / rate_hz)
    return hand_at(0.25 * (1 - np.cos(2 * np.pi * np.clip(seconds - 0.25, 0, 1)))[:, None] * np.array([0, 0, 1.0]))


def wandering(frames: int, seed: int = 0) -> np.ndarray:
    return POSTURE + np.random.default_rng(seed).normal(0, 0.03, (frames, 15, 3)).cumsum(axis=0)


def assert_same(movements: Sequence[Kinematics], others: Sequence[Kinematics], joints: object = slice(None)) -> None:
    """To the bit."""
    for one, other in zip(movements, others, strict=True):
        np.testing.assert_array_equal(one.posture[joints], other.posture[joints])
        np.testing.assert_array_equal(one.velocity[joints], other.velocity[joints])


@given(st.lists(st.integers(1, 2 * GAP_NS), min_size=1, max_size=20))
def test_joints_that_rest_are_where_they_are_and_go_nowhere(steps_ns: list[int]) -> None:
    movement = KinematicsFilter()
    for stamp_ns in np.cumsum(steps_ns).tolist():
        step = movement.step(stamp_ns, POSTURE)
        np.testing.assert_array_equal(step.posture, POSTURE)
        np.testing.assert_array_equal(step.velocity, np.zeros((15, 3)))


@pytest.mark.parametrize("rate_hz", [15, 30, 60, 120])
@pytest.mark.parametrize("speed_mps", [0.05, 0.5, 3.0])
def test_steady_speed_is_told_times_an_eighth_of_a_second(speed_mps: float, rate_hz: float) -> None:
    """To within half a frame."""
    last = filtered(steadily(speed_mps, 4.0, rate_hz), rate_hz)[-1]
    told_s = last.velocity[HAND] / (speed_mps * np.array([1.0, 0.6, 0.8]))
    assert last.velocity[HAND, 0] == 0
    assert (LAG_TIME_CONSTANT_S - 0.5 / rate_hz <= told_s[1:]).all()
    assert (told_s[1:] <= LAG_TIME_CONSTANT_S * (1 + 1e-6)).all()
    np.testing.assert_array_equal(np.delete(last.velocity, HAND, axis=0), np.zeros((14, 3)))


def test_the_same_movement_at_another_rate_is_told_alike() -> None:
    slow, fast = filtered(reach(30), 30), filtered(reach(60), 60)[::2]
    postures, velocities = (
        np.array([[getattr(m, name)[HAND, 2] for m in each] for each in (slow, fast)])
        for name in ("posture", "velocity")
    )
    for told, tolerance in ((postures, 0.05), (velocities, 0.1)):
        assert np.abs(told[0] - told[1]).max() < tolerance * np.ptp(told[1])


def test_jitter_at_rest_shrinks() -> None:
    joints = POSTURE + np.random.default_rng(0).normal(0, 0.003, (300, 15, 3))
    postures = np.array([movement.posture for movement in filtered(joints)])
    assert postures[30:].std(axis=0).max() < 0.5 * joints.std(axis=0).min()


def delay_s(speed_mps: float) -> float:
    joints = steadily(speed_mps, 4.0, RATE_HZ)
    behind_m = joints[-1, HAND] - filtered(joints)[-1].posture[HAND]
    return float(np.linalg.norm(behind_m)) / speed_mps


def test_the_faster_a_joint_the_less_it_is_delayed() -> None:
    delays_s = [delay_s(speed_mps) for speed_mps in (0.01, 0.1, 0.5, 1.5, 3.0)]
    assert delays_s == sorted(delays_s, reverse=True)
    assert 0.8 * STILL_TIME_CONSTANT_S < delays_s[0] < STILL_TIME_CONSTANT_S
    assert delays_s[3] < 1.5 / RATE_HZ


def test_a_joint_that_moves_delays_no_other() -> None:
    alone, together = wandering(40), wandering(40)
    together[:, HAND] += np.random.default_rng(1).normal(0, 0.2, (40, 3))
    others = np.arange(15) != HAND
    assert_same(filtered(alone), filtered(together), others)


@pytest.mark.parametrize("step_ns", [GAP_NS + 1, 0, -1, -SECOND_NS])
def test_after_a_gap_and_where_stamps_go_back_all_begins_anew(step_ns: int) -> None:
    joints = wandering(30)
    used, fresh = KinematicsFilter(), KinematicsFilter()
    for i, frame in enumerate(joints[:20]):
        used.step(SECOND_NS + i * GAP_NS // 10, frame)
    first_ns = SECOND_NS + 19 * GAP_NS // 10 + step_ns
    steps = [
        [each.step(first_ns + i * GAP_NS // 10, frame) for i, frame in enumerate(joints[20:])] for each in (used, fresh)
    ]
    assert_same(*steps)
    np.testing.assert_array_equal(steps[0][0].posture, joints[20])
    np.testing.assert_array_equal(steps[0][0].velocity, np.zeros((15, 3)))


def test_half_a_second_is_no_gap_yet() -> None:
    movement = KinematicsFilter()
    movement.step(0, POSTURE)
    assert movement.step(GAP_NS, POSTURE + 0.1).velocity.min() > 0


masks = st.lists(st.lists(st.booleans(), min_size=15, max_size=15), min_size=2, max_size=12)


@given(masks)
def test_a_missing_joint_changes_no_other(there: list[list[bool]]) -> None:
    """Those that are always there are as they would be, and there is NaN where one is missing, and nowhere else."""
    known = np.array(there)
    joints = wandering(len(known))
    gappy = np.where(known[:, :, None], joints, np.nan)
    movements, whole = filtered(gappy), filtered(joints)
    assert_same(movements, whole, known.all(axis=0))
    for movement, present in zip(movements, known, strict=True):
        for values in (movement.posture, movement.velocity):
            assert np.isfinite(values[present]).all()
            assert np.isnan(values[~present]).all()


@given(st.integers(0, 5), st.integers(1, 10))
def test_a_joint_that_comes_back_begins_where_it_is(before: int, away: int) -> None:
    joints = wandering(before + away + 10, seed=away)
    back = before + away
    joints[before:back, HAND] = np.nan
    movements = filtered(joints)
    np.testing.assert_array_equal(movements[back].posture[HAND], joints[back, HAND])
    np.testing.assert_array_equal(movements[back].velocity[HAND], np.zeros(3))
    fresh = KinematicsFilter()
    again = [fresh.step(round(i * SECOND_NS / RATE_HZ), joints[i]) for i in range(back, len(joints))]
    assert_same(movements[back:], again, HAND)


def test_joints_may_be_missing_from_the_first_frame_on() -> None:
    joints = wandering(5)
    joints[:3, HAND] = np.nan
    velocities = [movement.velocity[HAND] for movement in filtered(joints)]
    assert np.isnan(velocities[:3]).all()
    assert (velocities[3] == 0).all()
    assert (velocities[4] != 0).all()


def test_inputs_are_left_as_they_were() -> None:
    joints = wandering(6)
    joints[2, HAND] = np.nan
    before = joints.copy()
    filtered(joints)
    np.testing.assert_array_equal(joints, before)


@given(st.floats(-np.pi, np.pi), st.tuples(*[st.floats(-3, 3)] * 3))
def test_where_and_which_way_a_person_stands_does_not_matter(heading: float, shift: tuple[float, float, float]) -> None:
    joints = wandering(20)
    cos, sin = np.cos(heading), np.sin(heading)
    turn = np.array([[cos, 0, -sin], [0, 1, 0], [sin, 0, cos]])
    turned_joints = joints @ turn + np.array(shift)
    for moved, still in zip(filtered(turned_joints), filtered(joints), strict=True):
        np.testing.assert_allclose(moved.posture, still.posture @ turn + np.array(shift), atol=1e-9)
        np.testing.assert_allclose(moved.velocity, still.velocity @ turn, atol=1e-9)
