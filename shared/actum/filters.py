"""Filters of signals that are sampled at irregular times."""

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS

MIN_CUTOFF_HZ = 2.0
"""Of a point at rest: it jitters little, and lags by 80 ms as it starts to move."""
BETA_PER_M = 8.0
"""How fast the cutoff rises with speed (1/m): at 0.5 m/s it is 6 Hz, a delay of 27 ms."""
SPEED_CUTOFF_HZ = 4.0
"""Of the speed's own low-pass, so that the noise of a derivative does not pass for speed."""
GAP_NS = SECOND_NS // 2
"""After a longer pause the past says nothing of where a point is."""


class OneEuro:
    """The one-euro filter (Casiez, Roussel, Vogel 2012): a low-pass whose cutoff rises with each point's own speed.

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
        """Take points (n, 3; m) and return them low-passed (n, 3); stamps rise."""
        if self._stamp_ns is None or not 0 < stamp_ns - self._stamp_ns <= GAP_NS:
            self._points, self._velocity = points, np.zeros_like(points)
        else:
            self._update((stamp_ns - self._stamp_ns) / SECOND_NS, points)
        self._stamp_ns = stamp_ns
        return self._points

    def _update(self, interval_s: float, points: Array) -> None:
        derivative = (points - self._points) / interval_s
        self._velocity = self._velocity + _gain(self._speed_cutoff_hz, interval_s) * (derivative - self._velocity)
        speed = np.linalg.norm(self._velocity, axis=-1, keepdims=True)
        cutoff_hz = self._min_cutoff_hz + self._beta_per_m * speed
        self._points = self._points + _gain(cutoff_hz, interval_s) * (points - self._points)


def _gain(cutoff_hz: Array | float, interval_s: float) -> Array:
    """Return the gain of a first-order low-pass over one interval, 1 / (1 + 1 / (2π f Δt))."""
    return np.asarray(1 / (1 + 1 / (2 * np.pi * cutoff_hz * interval_s)))
