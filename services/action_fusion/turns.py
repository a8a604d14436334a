"""The turn of an object that goes there and back within a segment, as one that is lifted and set down again."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from actum.arrays import Array

SETTLED_SAMPLES = 3
"""Number of positions whose median is an object's position: one outlier does no harm."""

TURN_TO_NOISE = 5.0
"""Least ratio of the way to the turn to the noise's standard deviation: the furthest of many positions may be noise."""

FEWEST_POSITIONS = 10
"""Fewest positions from which the noise can be estimated."""

MAD_TO_STD = 0.6745
"""Median absolute deviation of a Gaussian, in standard deviations."""


def noise_m(positions_m: Array) -> float:
    """Estimate the noise of positions (n, 3) in metres (one standard deviation); infinite where they are too few.

    From second differences, whose standard deviation is sqrt(6) times as large.
    """
    if len(positions_m) < FEWEST_POSITIONS:
        return float(np.inf)
    deviations_m = np.median(np.abs(np.diff(positions_m, 2, axis=0)), axis=0)
    return float(np.linalg.norm(deviations_m) / (MAD_TO_STD * np.sqrt(6)))


def turn(positions_m: Array, start_m: Array, end_m: Array, moved_m: float) -> int | None:
    """Find the turn of an object that came back: the position furthest from the start.

    The object came back if it ends nearer to the start than to that position.

    Args:
        positions_m: (n, 3), in the segment.
        start_m: (3,), its place at the segment's start.
        end_m: (3,), its place at the segment's end.
        moved_m: least distance of a turn from the start.

    Returns:
        the index of the turn; None where the object stayed where it was brought, or did not move.
    """
    if len(positions_m) < SETTLED_SAMPLES:
        return None
    settled_m = np.median(sliding_window_view(positions_m, SETTLED_SAMPLES, axis=0), axis=-1)
    away_m = np.linalg.norm(settled_m - start_m, axis=1)
    furthest = int(np.argmax(away_m))
    came_back = np.linalg.norm(end_m - start_m) < np.linalg.norm(end_m - settled_m[furthest])
    clear = away_m[furthest] >= max(moved_m, TURN_TO_NOISE * noise_m(positions_m))
    return furthest + SETTLED_SAMPLES // 2 if came_back and clear else None
