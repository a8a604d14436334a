"""The Kalman filter of a point at a nearly constant velocity: its closed form, and innovations as modelled."""

import numpy as np
import pytest

from actum.filters import MotionEstimate

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


def test_without_measurements_it_goes_on_and_becomes_less_certain() -> None:
    estimate, _ = filtered(walked(50, 1))
    ahead = estimate.predicted(0.5, ACCELERATION_STD_MPS2)
    assert ahead.position_m == pytest.approx(estimate.position_m + 0.5 * estimate.velocity_mps)
    assert (np.diag(ahead.covariance) > np.diag(estimate.covariance)).all()
