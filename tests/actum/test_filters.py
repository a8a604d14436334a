"""The filters of noisy points.

The Kalman filter of a point at a nearly constant velocity: its closed form, and innovations as modelled. The one-euro
filter: quiet at rest, and in motion never later than one frame.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.filters import MotionEstimate, OneEuro

NOISE_M2 = np.diag([0.01, 0.02, 0.05]) ** 2
ACCELERATION_STD_MPS2 = np.array([2.0, 1.0, 0.5])
STEP_S = 1 / 30


def walked(steps: int, seed: int):
    """Positions of a point that is accelerated at random in each step, as measured with noise: (steps, 3)."""
    chance = np.random.default_rng(seed)
    position, velocity, measured = np.zeros(3), np.array([0.5, 0.0, -0.2]), []
    for _ in range(steps):
        acceleration = ACCELERATION_STD_MPS2 * chance.normal(size=3)
        position = position + STEP_S * velocity + STEP_S**2 / 2 * acceleration
        velocity = velocity + STEP_S * acceleration
        measured.append(position + np.sqrt(np.diag(NOISE_M2)) * chance.normal(size=3))
    return np.array(measured)


def filtered(measured):
    estimate, innovations = MotionEstimate.initial(measured[0], NOISE_M2, 1.0), []
    for position_m in measured[1:]:
        estimate, nis = estimate.predicted(STEP_S, ACCELERATION_STD_MPS2).updated(position_m, NOISE_M2)
        innovations.append(nis)
    return estimate, innovations


def test_innovations_are_chi_squared_with_three_degrees_of_freedom() -> None:
    innovations = np.concatenate([filtered(walked(60, seed))[1] for seed in range(40)])
    assert innovations.mean() == pytest.approx(3.0, abs=0.15)
    assert innovations.var() == pytest.approx(6.0, rel=0.15)


def test_axes_that_share_no_noise_are_filtered_each_by_itself() -> None:
    measured = walked(50, 7)
    estimate, _ = filtered(measured)
    for axis in range(3):
        state, covariance = np.array([measured[0, axis], 0.0]), np.diag([NOISE_M2[axis, axis], 1.0])
        transition = np.array([[1.0, STEP_S], [0.0, 1.0]])
        push = ACCELERATION_STD_MPS2[axis] * np.array([STEP_S**2 / 2, STEP_S])
        for position_m in measured[1:, axis]:
            state, covariance = transition @ state, transition @ covariance @ transition.T + np.outer(push, push)
            gain = covariance[:, 0] / (covariance[0, 0] + NOISE_M2[axis, axis])
            state, covariance = state + gain * (position_m - state[0]), covariance - np.outer(gain, covariance[0])
        assert [estimate.position_m[axis], estimate.velocity_mps[axis]] == pytest.approx(state, abs=1e-12)
        assert estimate.covariance[axis::3, axis::3] == pytest.approx(covariance, abs=1e-12)


def test_one_standard_deviation_for_all_axes_is_one_for_each() -> None:
    estimate = MotionEstimate.initial(np.ones(3), NOISE_M2, 1.0)
    one, each = estimate.predicted(0.1, 2.0), estimate.predicted(0.1, np.full(3, 2.0))
    assert np.array_equal(one.covariance, each.covariance)


def low_passed(points: np.ndarray) -> np.ndarray:
    low_pass = OneEuro()
    return np.array([low_pass.step(round(i * STEP_S * 1e9), point) for i, point in enumerate(points)])


@given(speed_mps=st.floats(0.3, 3.0), heading=st.floats(0, 6.28))
def test_a_steady_motion_lags_by_less_than_a_frame(speed_mps: float, heading: float) -> None:
    velocity = speed_mps * np.array([np.cos(heading), np.sin(heading), 0.0])
    points = np.arange(60)[:, None, None] * STEP_S * velocity
    lag_s = np.linalg.norm(points[-1] - low_passed(points)[-1]) / speed_mps
    assert 0 < lag_s <= STEP_S


def test_what_rests_stays_and_its_noise_is_halved() -> None:
    rest = np.full((90, 15, 3), 0.7)
    assert low_passed(rest) == pytest.approx(rest)
    noise = np.random.default_rng(0).normal(0, 0.004, rest.shape)
    assert low_passed(rest + noise)[30:].std() < 0.5 * noise.std()


@given(shift=st.floats(-5, 5))
def test_it_does_not_matter_where_it_happens(shift: float) -> None:
    points = np.random.default_rng(1).normal(0, 0.1, (20, 15, 3))
    assert low_passed(points + shift) == pytest.approx(low_passed(points) + shift, abs=1e-9)


def test_after_a_gap_it_begins_anew() -> None:
    low_pass = OneEuro()
    low_pass.step(0, np.zeros((1, 3)))
    assert low_pass.step(600_000_000, np.ones((1, 3))).tolist() == [[1.0, 1.0, 1.0]]
    assert low_pass.step(633_000_000, np.zeros((1, 3)))[0, 0] > 0
