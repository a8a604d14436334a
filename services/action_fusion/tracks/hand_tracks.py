"""Tracks and stops of the hands in the camera frame, in which an object that nobody moves has a constant position.

Distances are the same as in the egocentric frame, because the two frames differ by a rigid transform at every instant.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from action_fusion.intake.buffers import LOOK_BACK_NS, Hands
from action_fusion.tracks.track import Track
from actum.arrays import Array, Indices, Mask
from actum.core import steps
from actum.messages import Hand
from actum.node import SECOND_NS

BOTH_HANDS: tuple[Hand, Hand] = ("right", "left")

MOST_INSTANTS = 600
"""Most instants of a track, to bound the computing time: 20 s at 30 Hz. Longer tracks are subsampled."""

SMOOTHING_NS = SECOND_NS // 10
"""Nanoseconds averaged on either side of an instant: reduces a joint's noise of a centimetre to four millimetres."""

SPEED_NS = SECOND_NS // 10
"""Nanoseconds on either side of an instant over which speed is measured: a centimetre of noise is then 7 cm/s."""

RESTING_M_PER_S = 0.15
"""Largest speed of a resting hand: a reach is at least twice as fast (0.3 m/s and more)."""

SLOWEST_SHARE = 0.2
"""Share of the instants, the slowest ones, that count as rest if the hand never rests."""

SAME_PLACE_M = 0.07
"""Largest distance between two stops in the same place: three times a joint's noise."""

HESITATION_M = 0.10
"""Largest distance from the last stop of a stop that is a mere hesitation; one further away is an action of its own."""


@dataclass(frozen=True, eq=False)
class HandTrack(Track):
    """A hand's n known instants, one or more: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera
    frame."""

    side: Hand
    stamps_ns: Array
    positions_m: Array

    @cached_property
    def in_segment(self) -> Mask:
        """Mask (n,) of the instants in the segment; the others lie before it."""
        inside: Mask = self.stamps_ns >= 0
        return inside

    @cached_property
    def recent(self) -> Mask:
        """Mask (n,) of the instants in the segment or at most `LOOK_BACK_NS` before it."""
        recent: Mask = self.stamps_ns >= -LOOK_BACK_NS
        return recent

    def speeds_m_per_s(self) -> Array:
        """Measure the speed (n,) over a fifth of a second around each instant."""
        before, after = self.stamps_ns - SPEED_NS, self.stamps_ns + SPEED_NS
        first, last = self.stamps_ns[0], self.stamps_ns[-1]
        elapsed_s = (np.minimum(after, last) - np.maximum(before, first)) / SECOND_NS
        distances: Array = np.linalg.norm(self.at(after) - self.at(before), axis=1)
        speeds: Array = np.divide(distances, elapsed_s, out=np.zeros_like(distances), where=elapsed_s > 0)
        return speeds


@dataclass(frozen=True)
class HandTracks:
    """The tracks of the actor's own hands, and those of the other people in the image."""

    own: Mapping[Hand, HandTrack]
    others: Sequence[HandTrack]

    @property
    def everyones(self) -> list[HandTrack]:
        """The tracks of all hands, the actor's first."""
        return [*self.own.values(), *self.others]


@dataclass(frozen=True)
class Stops:
    """The stops of a hand: `last` (n,) marks the instants at which it rests in the place of its last stop.

    `acted_before` is whether it had stopped elsewhere before, apart from its place at the segment's start; `returned`
    is whether it rests in that place again afterwards.
    """

    last: Mask
    acted_before: bool
    returned: bool = False


def hand_tracks(own: Hands, others: Sequence[Hands]) -> HandTracks:
    """Track the hands of the actor and of other people; a hand whose joint is always missing has no track."""
    return HandTracks(_tracks_of(own), [track for other in others for track in _tracks_of(other).values()])


def _tracks_of(hands: Hands) -> dict[Hand, HandTrack]:
    tracks = [_hand_track(hands, n) for n in range(len(BOTH_HANDS))]
    return {track.side: track for track in tracks if len(track.stamps_ns)}


def _hand_track(hands: Hands, number: int) -> HandTrack:
    stamps_ns, smooth_m = known_smoothed(hands, number)
    if len(stamps_ns) > MOST_INSTANTS:
        stride = math.ceil(len(stamps_ns) / MOST_INSTANTS)
        stamps_ns, smooth_m = stamps_ns[::stride].copy(), smooth_m[::stride].copy()
    return HandTrack(BOTH_HANDS[number], stamps_ns, smooth_m)


def known_smoothed(hands: Hands, number: int) -> tuple[Array, Array]:
    """Return the stamps (k,) at which the right (0) or the left hand (1) is known, and its smooth positions (k, 3)."""
    if steps is None:
        known = np.flatnonzero(np.isfinite(hands.positions_m[:, number, 0]))
        stamps_ns = hands.stamps_ns[known]
        return stamps_ns, _smoothed(hands.positions_m[known, number], stamps_ns)
    stamps_ns, smooth_m = np.empty(len(hands.stamps_ns)), np.empty((len(hands.stamps_ns), 3))
    count = steps.smoothed_hand(hands.stamps_ns, hands.positions_m, number, SMOOTHING_NS, stamps_ns, smooth_m)
    return stamps_ns[:count], smooth_m[:count]


def _smoothed(positions_m: Array, stamps_ns: Array) -> Array:
    """Average positions (n, 3) over a fifth of a second around each, over less time near both ends."""
    here = np.arange(len(stamps_ns))
    before = here - np.searchsorted(stamps_ns, stamps_ns - SMOOTHING_NS)
    after = np.searchsorted(stamps_ns, stamps_ns + SMOOTHING_NS, side="right") - 1 - here
    half = np.minimum(before, after)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(positions_m, axis=0)])
    mean: Array = (sums[here + half + 1] - sums[here - half]) / (2 * half + 1)[:, None]
    return mean


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
    rests = speeds[inside].min() <= RESTING_M_PER_S
    return inside & (speeds <= (RESTING_M_PER_S if rests else np.quantile(speeds[inside], SLOWEST_SHARE)))
