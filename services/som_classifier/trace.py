"""The ordered vector: where activity wanders on the first map, freed of time (paper, section 2.1)."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def without_repeats(cells: NDArray[np.intp]) -> NDArray[np.intp]:
    """Drop consecutive duplicates from a sequence of winners."""
    changed = np.ones(len(cells), dtype=bool)
    changed[1:] = cells[1:] != cells[:-1]
    kept: NDArray[np.intp] = cells[changed]
    return kept


def resampled(path: Array, points: int) -> Array:
    """Place points at equal arc length Δ / (points − 1) along a polyline of shape (n, 2). Shape (points, 2).

    The path's ends are kept exactly. A path of one point, a still posture, is that point repeated.

    Raises:
        ValueError: the path has no point, or fewer than two are asked for.
    """
    if not len(path) or points < 2:
        raise ValueError(f"cannot place {points} points along a path of {len(path)}")
    lengths = np.hypot(*np.diff(path, axis=0).T)
    reached = np.concatenate(([0.0], np.cumsum(lengths)))
    wanted = np.linspace(0.0, reached[-1], points)
    return np.stack([np.interp(wanted, reached, axis) for axis in path.T], axis=1)


def ordered_vector(path: Array, points: int) -> Array:
    """Write a path's resampled points one after the other, shape (2 * points,): the second layer's input."""
    return resampled(path, points).ravel()
