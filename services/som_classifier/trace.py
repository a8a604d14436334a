"""The ordered vector: where activity wanders on the first map, freed of time (paper, section 2.1)."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import Som
from som_classifier.supervised import activity

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
UNSEEN = -1
"""The winner where nothing is there to compare with the map."""


@dataclass(frozen=True, eq=False)
class Activities:
    """Where each of several inputs makes a map active.

    Attributes:
        winners: (…,), the units that are nearest; `UNSEEN` where an input has no known component.
        centres: (…, 2), the centres of activity, row and column; NaN there.
    """

    winners: Indices
    centres: Array

    def __getitem__(self, which: Any) -> "Activities":
        return Activities(self.winners[which], self.centres[which])


def activities(som: Som, rows: Array, contrast: float) -> Activities:
    """Return the winners and the centres of activity of (n, dim) rows.

    A centre is the mean of the units' places, weighted by their activities y = exp(−(d² − d²_min) / contrast). One
    matrix product of always the same shape for n rows, so that live and replayed frames agree to the bit.
    """
    known = ~np.isnan(rows).all(axis=1)
    winners = np.full(len(rows), UNSEEN, dtype=np.intp)
    centres = np.full((len(rows), 2), np.nan)
    if known.any():
        excess2s = som.excess2s(rows[known])
        weights = activity(excess2s, contrast)
        winners[known] = excess2s.argmin(axis=1)
        centres[known] = weights @ som.coordinates / weights.sum(axis=1, keepdims=True)
    return Activities(winners, centres)


def way(seen: Activities) -> Array:
    """Return the centres at which a new unit wins, frames in which nothing is there left out, shape (stays, 2).

    Args:
        seen: of one input in each of n frames.
    """
    there = seen[seen.winners != UNSEEN]
    return there.centres[changes(there.winners)]


def changes(cells: Indices) -> NDArray[np.bool_]:
    """Tell which of a sequence of winners are not the one before. Shape (n,)."""
    changed = np.ones(len(cells), dtype=bool)
    changed[1:] = cells[1:] != cells[:-1]
    return changed


def without_repeats(cells: Indices) -> Indices:
    """Drop consecutive duplicates from a sequence of winners."""
    kept: Indices = cells[changes(cells)]
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
