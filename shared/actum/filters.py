"""Filters of signals that are sampled at irregular times."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS

MIN_CUTOFF_HZ = 2.0
"""Cutoff for a point at rest: it jitters little, and lags by 80 ms as it starts to move."""
BETA_PER_M = 8.0
"""How fast the cutoff rises with speed (1/m): at 0.5 m/s it is 6 Hz, a delay of 27 ms."""
SPEED_CUTOFF_HZ = 4.0
"""Cutoff of the derivative's own low-pass, so that its noise does not count as speed."""
GAP_NS = SECOND_NS // 2
"""After a longer pause (ns) the filter restarts: the earlier positions say nothing about the next one."""
_IDENTITY_6 = np.eye(6)
"""The identity (6, 6): the Kalman filter's transition matrix over no time."""
_IDENTITY_3 = np.eye(3)
"""The identity (3, 3): equal variances and no covariance between x, y and z."""


class OneEuro:
    """The one-euro filter (Casiez, Roussel, Vogel 2012): a low-pass whose cutoff rises with each point's own speed.

    f = f_min + β‖v‖; x̂ ← x̂ + (x - x̂) / (1 + 1 / (2π f Δt)); v is the low-passed derivative. A point that moves
    steadily at v lags by a time of 1 / (2π f). After a gap of more than half a second the filter restarts.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self._points = np.zeros(0)
        self._velocity = np.zeros(0)

    def step(self, stamp_ns: int, points: Array) -> Array:
        """Return points (n, 3; m) low-passed, (n, 3). A stamp that does not rise restarts the filter."""
        if self._stamp_ns is None or not 0 < stamp_ns - self._stamp_ns <= GAP_NS:
            self._points, self._velocity = points, np.zeros_like(points)
        else:
            interval_s = (stamp_ns - self._stamp_ns) / SECOND_NS
            derivative = (points - self._points) / interval_s
            self._velocity = self._velocity + _gain(SPEED_CUTOFF_HZ, interval_s) * (derivative - self._velocity)
            speed = np.linalg.norm(self._velocity, axis=-1, keepdims=True)
            cutoff_hz = MIN_CUTOFF_HZ + BETA_PER_M * speed
            self._points = self._points + _gain(cutoff_hz, interval_s) * (points - self._points)
        self._stamp_ns = stamp_ns
        return self._points


@dataclass(frozen=True, eq=False)
class MotionEstimate:
    """A Kalman filter's estimate of a point that moves at a nearly constant velocity.

    Attributes:
        state: (6,), the position (m), then the velocity (m/s).
        covariance: (6, 6), of the state.
    """

    state: Array
    covariance: Array

    @classmethod
    def initial(cls, position_m: Array, noise_m2: Array, speed_std_mps: float) -> "MotionEstimate":
        """Begin at a measured position (3,) with noise covariance (3, 3); the velocity is 0 ± `speed_std_mps`."""
        covariance = np.zeros((6, 6))
        covariance[:3, :3] = noise_m2
        covariance[3:, 3:] = speed_std_mps**2 * _IDENTITY_3
        return cls(np.concatenate([position_m, np.zeros(3)]), covariance)

    @property
    def position_m(self) -> Array:
        """The position: (3,)."""
        return self.state[:3]

    @property
    def velocity_mps(self) -> Array:
        """The velocity: (3,)."""
        return self.state[3:]

    def predicted(self, interval_s: float, acceleration_std_mps2: float | Array) -> "MotionEstimate":
        """Predict the state after an interval, under a constant random acceleration: x' = F x, P' = F P Fᵀ + G Gᵀ.

        The acceleration's standard deviation is a single number for all axes, or one for each axis: (3,).
        """
        transition, from_acceleration = _motion(interval_s)
        disturbance = acceleration_std_mps2 * from_acceleration
        covariance = transition @ self.covariance @ transition.T + disturbance @ disturbance.T
        return MotionEstimate(transition @ self.state, covariance)

    def updated(self, position_m: Array, noise_m2: Array) -> "tuple[MotionEstimate, float]":
        """Take in a measured position (3,) with noise covariance (3, 3).

        Returns:
            The new estimate, and the normalised innovation squared: the squared Mahalanobis distance of the measurement
            from the predicted position, chi-squared with three degrees of freedom where all is as modelled.
        """
        precision = np.linalg.inv(self.covariance[:3, :3] + noise_m2)
        innovation_m = position_m - self.position_m
        gain = self.covariance[:, :3] @ precision
        covariance = self.covariance - gain @ self.covariance[:3, :]
        state = self.state + gain @ innovation_m
        return MotionEstimate(state, (covariance + covariance.T) / 2), float(innovation_m @ precision @ innovation_m)


@lru_cache(maxsize=8)
def _motion(interval_s: float) -> tuple[Array, Array]:
    """Return the transition matrix F (6, 6) over an interval, and the effect (6, 3) of an acceleration of 1 m/s².

    All objects of an image share the interval.
    """
    transition = _IDENTITY_6.copy()
    transition[:3, 3:] = interval_s * _IDENTITY_3
    return transition, np.concatenate([interval_s**2 / 2 * _IDENTITY_3, interval_s * _IDENTITY_3])


def _gain(cutoff_hz: Array | float, interval_s: float) -> Array:
    """Return the gain of a first-order low-pass over one interval, 1 / (1 + 1 / (2π f Δt))."""
    return np.asarray(1 / (1 + 1 / (2 * np.pi * cutoff_hz * interval_s)))
