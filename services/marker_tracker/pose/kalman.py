"""A Kalman filter for a point that moves steadily but for random accelerations."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ACCELERATION_MPS2 = 8.0
"""Standard deviation of what a hand does to an object within a frame."""
START_SPEED_MPS = 1.0
STILL, AXES = np.eye(6), np.eye(3)


@dataclass(frozen=True, eq=False)
class Motion:
    """Position (m) and velocity (m/s) as `state` (6,), with its `covariance` (6, 6)."""

    state: Array
    covariance: Array

    @property
    def position_m(self) -> Array:
        """Where it is: (3,)."""
        return self.state[:3]

    @property
    def velocity_mps(self) -> Array:
        """How it moves: (3,)."""
        return self.state[3:]


def started(position_m: Array, noise: Array) -> Motion:
    """Begin at a measured position (3,) with covariance noise (3, 3), at rest as far as is known."""
    covariance = np.zeros((6, 6))
    covariance[:3, :3] = noise
    covariance[3:, 3:] = START_SPEED_MPS**2 * np.eye(3)
    return Motion(np.concatenate([position_m, np.zeros(3)]), covariance)


def predicted(motion: Motion, seconds: float) -> Motion:
    """Let time pass: x' = F x, P' = F P Fᵀ + G Gᵀ a², with a random acceleration a for the whole of it."""
    step = STILL.copy()
    step[:3, 3:] = seconds * AXES
    push = ACCELERATION_MPS2 * np.concatenate([seconds**2 / 2 * AXES, seconds * AXES])
    return Motion(step @ motion.state, step @ motion.covariance @ step.T + push @ push.T)


def corrected(motion: Motion, position_m: Array, noise: Array) -> tuple[Motion, float]:
    """Take in a measured position (3,) with covariance noise (3, 3); tell how surprising it was.

    The surprise is the squared Mahalanobis distance from the expected position: chi-squared with three degrees of
    freedom where all is as modelled.
    """
    precision = np.linalg.inv(motion.covariance[:3, :3] + noise)
    off = position_m - motion.position_m
    gain = motion.covariance[:, :3] @ precision
    covariance = motion.covariance - gain @ motion.covariance[:3, :]
    return Motion(motion.state + gain @ off, (covariance + covariance.T) / 2), float(off @ precision @ off)
