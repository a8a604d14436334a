"""Smooth point-to-point movement."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def phase(time_s: Array, start_s: float, duration_s: float) -> Array:
    """Tell how much of a movement's time has passed at each time (T,): 0 before it, 1 after it."""
    return np.clip((time_s - start_s) / duration_s, 0.0, 1.0)


def minimum_jerk(share: Array) -> Array:
    """Progress of the minimum-jerk movement, 10s^3 - 15s^4 + 6s^5 (Flash and Hogan 1985)."""
    return share**3 * (10 - 15 * share + 6 * share**2)


def arc(share: Array) -> Array:
    """A bump of height 1 at the middle, 64s^3 (1 - s)^3, with zero velocity and acceleration at both ends."""
    return 64 * share**3 * (1 - share) ** 3


def reach(start: Array, end: Array, bulge: Array, share: Array) -> Array:
    """Hand path (T, 3) from `start` to `end`, minimum jerk along the line, bent by `bulge` at the middle."""
    return start + minimum_jerk(share)[:, None] * (end - start) + arc(share)[:, None] * bulge


def carry(displacement: Array, share: Array) -> Array:
    """Displacement (T, 3) of an object that is moved along a straight line."""
    return minimum_jerk(share)[:, None] * displacement


def set_down(displacement: Array, share: Array) -> Array:
    """Displacement (T, 3) of an object that is moved off its support, then down: the level part goes first."""
    level, vertical = displacement * (1, 0, 1), displacement * (0, 1, 0)
    return carry(level, phase(share, 0.0, 0.65)) + carry(vertical, phase(share, 0.3, 0.7))


def glide(start: Array | float, end: Array, share: Array) -> Array:
    """Go from one value (...) towards the values `end` (T, ...), minimum jerk."""
    weight = minimum_jerk(share).reshape(-1, *[1] * (end.ndim - 1))
    return np.asarray((1 - weight) * start + weight * end)
