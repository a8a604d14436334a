"""A Kalman filter for points that move at a nearly constant velocity."""

from dataclasses import dataclass

import numpy as np

from actum.arrays import Array

_NO_MOTION = np.eye(6)
"""Transition matrix of a state within no time."""
_AXES = np.eye(3)
"""One matrix row for each axis, x, y, z."""


@dataclass(frozen=True, eq=False)
class MotionEstimate:
    """A point's position (m) and velocity (m/s) as `state` (6,), with its `covariance` (6, 6)."""

    state: Array
    covariance: Array

    @property
    def position_m(self) -> Array:
        """The position: (3,)."""
        return self.state[:3]

    @property
    def velocity_mps(self) -> Array:
        """The velocity: (3,)."""
        return self.state[3:]


def initial(position_m: Array, noise_m2: Array, speed_std_mps: float) -> MotionEstimate:
    """Begin at a measured position (3,) with noise covariance (3, 3), at rest but for a standard deviation."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = noise_m2
    covariance[3:, 3:] = speed_std_mps**2 * np.eye(3)
    return MotionEstimate(np.concatenate([position_m, np.zeros(3)]), covariance)


def predicted(estimate: MotionEstimate, seconds: float, acceleration_std_mps2: float | Array) -> MotionEstimate:
    """Let time pass: x' = F x, P' = F P Fᵀ + G Gᵀ, with a random acceleration that is constant for all of it.

    The standard deviation of the acceleration is one for all axes, or one for each: (3,).
    """
    transition = _NO_MOTION.copy()
    transition[:3, 3:] = seconds * _AXES
    disturbance = acceleration_std_mps2 * np.concatenate([seconds**2 / 2 * _AXES, seconds * _AXES])
    covariance = transition @ estimate.covariance @ transition.T + disturbance @ disturbance.T
    return MotionEstimate(transition @ estimate.state, covariance)


def updated(estimate: MotionEstimate, position_m: Array, noise_m2: Array) -> tuple[MotionEstimate, float]:
    """Take in a measured position (3,) with noise covariance (3, 3).

    Returns:
        The new estimate, and the normalised innovation squared: the squared Mahalanobis distance of the measurement
        from the expected position, chi-squared with three degrees of freedom where all is as modelled.
    """
    precision = np.linalg.inv(estimate.covariance[:3, :3] + noise_m2)
    innovation_m = position_m - estimate.position_m
    gain = estimate.covariance[:, :3] @ precision
    covariance = estimate.covariance - gain @ estimate.covariance[:3, :]
    state = estimate.state + gain @ innovation_m
    return MotionEstimate(state, (covariance + covariance.T) / 2), float(innovation_m @ precision @ innovation_m)
