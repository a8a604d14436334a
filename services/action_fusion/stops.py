"""The stops of a hand within a segment: the hand acts where it stops last, not where it passes."""

from dataclasses import dataclass

import numpy as np

from action_fusion.hand_tracks import HandTrack
from actum.arrays import Array, Indices, Mask

RESTING_M_PER_S = 0.15
"""Largest speed of a resting hand: a reach is at least twice as fast (0.3 m/s and more)."""

SLOWEST_SHARE = 0.2
"""Share of the instants, the slowest ones, that count as rest if the hand never rests."""

SAME_PLACE_M = 0.07
"""Largest distance between two stops in the same place: three times a joint's noise."""

HESITATION_M = 0.10
"""Largest distance from the last stop of a stop that is a mere hesitation; one further away is an action of its own."""


@dataclass(frozen=True)
class Stops:
    """The stops of a hand: `last` (n,) marks the instants at which it rests in the place of its last stop.

    `acted_before` is whether it had stopped elsewhere before, apart from its place at the segment's start; `returned`
    is whether it rests in that place again afterwards.
    """

    last: Mask
    acted_before: bool
    returned: bool = False


def stops(hand: HandTrack) -> Stops:
    """Find a hand's last stop away from its place at the segment's start, to which it may have returned."""
    resting = _resting(hand)
    stopped = np.flatnonzero(resting)
    if not len(stopped):
        return Stops(resting, acted_before=False)
    home_m = hand.positions_m[np.flatnonzero(hand.in_segment)[0]]
    away = stopped[_distances_m(hand, stopped, home_m) > SAME_PLACE_M]
    if not len(away):
        return Stops(resting, acted_before=False)
    last_m = hand.positions_m[away[-1]]
    last = np.zeros_like(resting)
    last[stopped[_distances_m(hand, stopped, last_m) <= SAME_PLACE_M]] = True
    acted_before = bool((_distances_m(hand, away, last_m) > HESITATION_M).any())
    return Stops(last, acted_before, returned=bool(stopped[-1] > away[-1]))


def _distances_m(hand: HandTrack, instants: Indices, position_m: Array) -> Array:
    distances_m: Array = np.linalg.norm(hand.positions_m[instants] - position_m, axis=1)
    return distances_m


def _resting(hand: HandTrack) -> Mask:
    """Mask (n,) of the segment's instants at which the hand rests or, if it never does, is slowest."""
    inside = hand.in_segment
    if not inside.any():
        return inside
    speeds = hand.speeds_m_per_s()
    slowest = float(np.quantile(speeds[inside], SLOWEST_SHARE))
    return inside & (speeds <= (RESTING_M_PER_S if speeds[inside].min() <= RESTING_M_PER_S else slowest))
