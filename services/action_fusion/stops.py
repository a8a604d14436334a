"""Where a hand comes to rest within a segment: what it works at is where it stops last, not where it passed."""

from dataclasses import dataclass

import numpy as np

from action_fusion.hand_tracks import HandTrack
from actum.arrays import Array, Indices, Mask

RESTING_M_PER_S = 0.15
"""A reach is several times as fast (0.3 m/s and more), and comes to rest at its goal."""

SLOWEST_SHARE = 0.2
"""Where a hand never rests, this share of its instants, the slowest, counts."""

SAME_PLACE_M = 0.07
"""A hand that rests within this of where it rested is in the same place: a joint's noise is a third of it."""

HESITATION_M = 0.10
"""A stop nearer than this to the last one is a hesitation before it; one further away is an action of its own."""


@dataclass(frozen=True)
class Stops:
    """Where a hand stops: `last` (n,) marks the instants at which it rests where it works last.

    `acted_before` is whether it had stopped elsewhere before, away from where it came from.
    """

    last: Mask
    acted_before: bool


def stops(hand: HandTrack) -> Stops:
    """Find where a hand rests last, not counting the place it came from, to which it may have gone back."""
    resting = _resting(hand)
    at = np.flatnonzero(resting)
    if not len(at):
        return Stops(resting, acted_before=False)
    home_m = hand.positions_m[np.flatnonzero(hand.in_segment)[0]]
    away = at[_distances_m(hand, at, home_m) > SAME_PLACE_M]
    if not len(away):
        return Stops(resting, acted_before=False)
    last_m = hand.positions_m[away[-1]]
    last = np.zeros_like(resting)
    last[at[_distances_m(hand, at, last_m) <= SAME_PLACE_M]] = True
    return Stops(last, acted_before=bool((_distances_m(hand, away, last_m) > HESITATION_M).any()))


def _distances_m(hand: HandTrack, instants: Indices, position_m: Array) -> Array:
    distances_m: Array = np.linalg.norm(hand.positions_m[instants] - position_m, axis=1)
    return distances_m


def _resting(hand: HandTrack) -> Mask:
    """Tell the segment's instants (n,) at which the hand rests, or is slowest."""
    inside = hand.in_segment
    if not inside.any():
        return inside
    speeds = hand.speeds_m_per_s()
    slowest = float(np.quantile(speeds[inside], SLOWEST_SHARE))
    return inside & (speeds <= (RESTING_M_PER_S if speeds[inside].min() <= RESTING_M_PER_S else slowest))
