"""Smooth point-to-point trajectories."""

import numpy as np

from actum.arrays import Array


def elapsed_share(time_s: Array, start_s: float, duration_s: float) -> Array:
    """Return the elapsed share (T,) of a movement's duration at times (T,): 0 before it, 1 after it."""
    return np.clip((time_s - start_s) / duration_s, 0.0, 1.0)


def minimum_jerk(share: Array) -> Array:
    """Return the progress (T,) of a minimum-jerk movement, 10s³ - 15s⁴ + 6s⁵, at shares s (T,) of its time.

    Flash and Hogan 1985.
    """
    return share**3 * (10 - 15 * share + 6 * share**2)


def bump(share: Array) -> Array:
    """Return 64s³(1 - s)³ (T,): height 1 in the middle, zero velocity and acceleration at both ends."""
    return 64 * share**3 * (1 - share) ** 3


def bent_path(start: Array, end: Array, bulge: Array, share: Array) -> Array:
    """Return a hand's path (T, 3) from `start` (3,) to `end` (3,) at minimum jerk, bent by `bulge` (3,) half-way."""
    return start + minimum_jerk(share)[:, None] * (end - start) + bump(share)[:, None] * bulge


def straight_displacement(displacement: Array, share: Array) -> Array:
    """Return the displacement (T, 3) of an object that is moved along a straight line by `displacement` (3,)."""
    return minimum_jerk(share)[:, None] * displacement


def set_down_displacement(displacement: Array, share: Array) -> Array:
    """Return the displacement (T, 3) of an object that is moved off its support, then down, by `displacement` (3,)."""
    level, vertical = displacement * (1, 0, 1), displacement * (0, 1, 0)
    level_share, vertical_share = elapsed_share(share, 0.0, 0.65), elapsed_share(share, 0.3, 0.7)
    return straight_displacement(level, level_share) + straight_displacement(vertical, vertical_share)


def interpolated(start: Array | float, end: Array, share: Array) -> Array:
    """Return values (T, ...) interpolated from `start` (...) to `end` (T, ...) at minimum jerk."""
    weight = minimum_jerk(share).reshape(-1, *[1] * (end.ndim - 1))
    return np.asarray((1 - weight) * start + weight * end)
