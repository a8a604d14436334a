"""Where a hand comes to rest within a segment: what it works at is where it stops last, not where it passed."""

from dataclasses import dataclass

import numpy as np

from action_fusion.hands import HandPath
from action_fusion.samples import Array, Indices, Mask

RESTING_M_PER_S = 0.15
"""A reach is several times as fast (0.3 m/s and more), and comes to rest at its goal."""

SLOWEST_SHARE = 0.2
"""Where a hand never rests, its slowest instants count."""

PLACE_M = 0.07
"""A hand that rests within this of where it rested is in the same place: a joint's noise is a third of it."""

ON_THE_WAY_M = 0.10
"""A stop this far and further from the last one was no hesitation before it."""


@dataclass(frozen=True)
class Stops:
    """Where a hand stops: `last` (n,) tells the instants at which it rests where it works last.

    `acted_before` is whether it had stopped elsewhere before, away from where it came from.
    """

    last: Mask
    acted_before: bool


def stops(path: HandPath) -> Stops:
    """Find where a hand rests last but for the place that it came from, to which it may have gone back."""
    resting = _resting(path)
    at = np.flatnonzero(resting)
    if not len(at):
        return Stops(resting, acted_before=False)
    home_m = path.positions_m[np.flatnonzero(path.stamps_ns >= 0)[0]]
    away = at[_distances(path, at, home_m) > PLACE_M]
    if not len(away):
        return Stops(resting, acted_before=False)
    last_m = path.positions_m[away[-1]]
    last = np.zeros_like(resting)
    last[at[_distances(path, at, last_m) <= PLACE_M]] = True
    return Stops(last, acted_before=bool((_distances(path, away, last_m) > ON_THE_WAY_M).any()))


def _distances(path: HandPath, instants: Indices, place_m: Array) -> Array:
    distances: Array = np.linalg.norm(path.positions_m[instants] - place_m, axis=1)
    return distances


def _resting(path: HandPath) -> Mask:
    """Tell the segment's instants at which the hand rests, or is slowest."""
    inside = path.stamps_ns >= 0
    if not inside.any():
        return inside
    speeds = path.speeds()
    slowest = float(np.quantile(speeds[inside], SLOWEST_SHARE))
    return inside & (speeds <= (RESTING_M_PER_S if speeds[inside].min() <= RESTING_M_PER_S else slowest))
