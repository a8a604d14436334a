"""The response of a map to an input: soft activity of its units, the activity's centre, the winner (paper, 2.1)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from actum.arrays import Array, Floats, Indices
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
