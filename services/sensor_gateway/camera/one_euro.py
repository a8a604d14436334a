"""The One-Euro filter (Casiez, Roussel, Vogel 2012) over a set of points: still ones rest, moving ones follow."""

import numpy as np

from actum.node import SECOND_NS
from sensor_gateway.camera.landmarks import Array

MIN_CUTOFF_HZ = 2.0
BETA_PER_M = 8.0
"""How fast the cutoff rises with speed: at 0.5 m/s it is 6 Hz, a delay of 27 ms."""

SPEED_CUTOFF_HZ = 4.0
GAP_NS = SECOND_NS // 2


class OneEuro:
    """Low-passes points, each with a cutoff that rises with its own speed.

    f = f_min + β‖v‖; x̂ ← x̂ + (x - x̂) / (1 + 1 / (2π f Δt)); v is the low-passed derivative. A point that moves
    steadily at v lags by 1 / (2π f) s. A gap of more than half a second starts anew.
    """

    def __init__(
        self,
        min_cutoff_hz: float = MIN_CUTOFF_HZ,
        beta_per_m: float = BETA_PER_M,
        speed_cutoff_hz: float = SPEED_CUTOFF_HZ,
    ) -> None:
        self._min_cutoff_hz, self._beta_per_m, self._speed_cutoff_hz = min_cutoff_hz, beta_per_m, speed_cutoff_hz
        self._stamp_ns: int | None = None
        self._points = np.zeros(0)
        self._velocity = np.zeros(0)

    def step(self, stamp_ns: int, points: Array) -> Array:
        """Take points (n, 3; m) and return them low-passed; stamps rise."""
        if self._stamp_ns is None or not 0 < stamp_ns - self._stamp_ns <= GAP_NS:
            self._points, self._velocity = points, np.zeros_like(points)
        else:
            self._follow((stamp_ns - self._stamp_ns) / SECOND_NS, points)
        self._stamp_ns = stamp_ns
        return self._points

    def _follow(self, interval_s: float, points: Array) -> None:
        derivative = (points - self._points) / interval_s
        self._velocity = self._velocity + _share(self._speed_cutoff_hz, interval_s) * (derivative - self._velocity)
        speed = np.linalg.norm(self._velocity, axis=-1, keepdims=True)
        cutoff_hz = self._min_cutoff_hz + self._beta_per_m * speed
        self._points = self._points + _share(cutoff_hz, interval_s) * (points - self._points)


def _share(cutoff_hz: Array | float, interval_s: float) -> Array:
    """Return how much of the difference a first-order low pass takes over in one interval."""
    return np.asarray(1 / (1 + 1 / (2 * np.pi * cutoff_hz * interval_s)))
