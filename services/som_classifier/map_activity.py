"""The response of a map to its inputs: winner, soft activity, and the trajectory of its centre (paper, section 2.1)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from actum.arrays import Array, Floats, Indices, Mask
from actum.som import Som

NO_WINNER = -1
"""Stands for the winner of an input of which no component is known."""


def soft_activity(excess2: Floats, contrast: float) -> Floats:
    """Return y = exp(−(d² − d²_min) / contrast), 1 at the winner, in the shape and precision of `excess2`.

    The paper's exp(−s / 10⁶) is 1 everywhere in floating point at any usual scale of the input, so the contrast
    is set relative to the distances between training vectors and the winner's own distance is taken off.

    Args:
        excess2: (…, units), d² − d²_min of each unit.
        contrast: in the same unit as d².
    """
    activities: Floats = np.exp(excess2 / -contrast)
    return activities


@dataclass(frozen=True, eq=False)
class MapActivity:
    """The winner and the centre of activity on a map for each of several inputs.

    Attributes:
        winners: (…,), the best matching units; `NO_WINNER` where no component of an input is known.
        centres: (…, 2), the centres of activity, row and column in grid units; NaN where there is no winner.
    """

    winners: Indices
    centres: Array

    def __getitem__(self, which: Any) -> "MapActivity":
        return MapActivity(self.winners[which], self.centres[which])


def map_activity(som: Som, rows: Array, contrast: float) -> MapActivity:
    """Return the winners (n,) and the centres of activity (n, 2) for the rows of (n, dim).

    A centre is the mean of the units' coordinates, weighted by their soft activities. All rows go into one matrix
    product, so callers keep to the same n live and in training: then live and replayed frames agree to the bit.
    """
    known = ~np.isnan(rows).all(axis=1)
    winners = np.full(len(rows), NO_WINNER, dtype=np.intp)
    centres = np.full((len(rows), 2), np.nan)
    if known.any():
        excess2s = som.excess2s(rows[known])
        weights = soft_activity(excess2s, contrast)
        winners[known] = excess2s.argmin(axis=1)
        centres[known] = weights @ som.coordinates / weights.sum(axis=1, keepdims=True)
    return MapActivity(winners, centres)


def trajectory(frames: MapActivity) -> Array:
    """Return the centres of activity at each change of the winner, shape (changes, 2), row and column in grid units.

    Frames without a winner are left out.

    Args:
        frames: winners (n,) and centres (n, 2), of one input per frame.
    """
    known = frames[frames.winners != NO_WINNER]
    return known.centres[changes(known.winners)]


def changes(winners: Indices) -> Mask:
    """Tell which winners of a sequence (n,) differ from the one before, shape (n,); the first always does."""
    changed = np.ones(len(winners), dtype=bool)
    changed[1:] = winners[1:] != winners[:-1]
    return changed


def without_repeats(winners: Indices) -> Indices:
    """Drop consecutive duplicates from a sequence of winners (n,)."""
    kept: Indices = winners[changes(winners)]
    return kept


def resampled(path: Array, points: int) -> Array:
    """Place points along a polyline (n, 2) of length Δ, Δ / (points − 1) apart along it. Shape (points, 2).

    The path's ends are kept exactly. A path of one point, a still posture, becomes that point repeated.

    Raises:
        ValueError: the path has no point, or fewer than two are asked for.
    """
    if not len(path) or points < 2:
        raise ValueError(
            f"a path of {len(path)} points cannot be resampled to {points} points: give a path of at least 1 point, "
            "and ask for at least 2 points"
        )
    lengths = np.hypot(*np.diff(path, axis=0).T)
    arc_lengths = np.concatenate(([0.0], np.cumsum(lengths)))
    targets = np.linspace(0.0, arc_lengths[-1], points)
    return np.stack([np.interp(targets, arc_lengths, axis) for axis in path.T], axis=1)


def ordered_vector(path: Array, points: int) -> Array:
    """Concatenate the resampled points of a path (n, 2) to the second layer's input, shape (2 * points,).

    Raises:
        ValueError: the path has no point, or fewer than two are asked for.
    """
    return resampled(path, points).ravel()
