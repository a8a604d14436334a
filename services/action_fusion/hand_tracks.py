"""Tracks of the hands in the camera frame, in which an object that nobody moves has a constant position.

Distances are the same as in the egocentric frame, because the two frames differ by a rigid transform at every instant.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.actors import BOTH_HANDS, Actor
from actum.arrays import Array, Indices, Mask
from actum.messages import Hand
from actum.node import SECOND_NS

MOST_INSTANTS = 600
"""Most instants of a track, to bound the computing time: 20 s at 30 Hz. Longer tracks are subsampled."""

SMOOTHING_NS = SECOND_NS // 10
"""Nanoseconds averaged on either side of an instant: reduces a joint's noise of a centimetre to four millimetres."""

SPEED_NS = SECOND_NS // 10
"""Nanoseconds on either side of an instant over which speed is measured: a centimetre of noise is then 7 cm/s."""

FURTHEST_SHARE = 0.8
"""Share of the greatest distance from which a position counts as furthest: the rest may be noise."""


@dataclass(frozen=True)
class HandTrack:
    """A hand's n known instants: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera frame."""

    side: Hand
    stamps_ns: Array
    positions_m: Array

    @property
    def in_segment(self) -> Mask:
        """Mask (n,) of the instants in the segment; the others lie before it."""
        inside: Mask = self.stamps_ns >= 0
        return inside

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate positions (p, 3) at stamps (p,) linearly, constant beyond both ends; NaN if there are none."""
        if not len(self.stamps_ns):
            return np.full((len(stamps_ns), 3), np.nan)
        return np.stack([np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T], axis=1)

    def speeds_m_per_s(self) -> Array:
        """Measure the speed (n,) over a fifth of a second around each instant."""
        before, after = self.stamps_ns - SPEED_NS, self.stamps_ns + SPEED_NS
        if not len(self.stamps_ns):
            return np.empty(0)
        first, last = self.stamps_ns[0], self.stamps_ns[-1]
        elapsed_s = (np.minimum(after, last) - np.maximum(before, first)) / SECOND_NS
        distances: Array = np.linalg.norm(self.at(after) - self.at(before), axis=1)
        speeds: Array = np.divide(distances, elapsed_s, out=np.zeros_like(distances), where=elapsed_s > 0)
        return speeds


@dataclass(frozen=True)
class HandTracks:
    """The tracks of the actor's own hands, and those of the other people in the image."""

    own: Mapping[Hand, HandTrack]
    others: Sequence[HandTrack] = ()

    @property
    def everyones(self) -> list[HandTrack]:
        """The tracks of all hands, the actor's first."""
        return [*self.own.values(), *self.others]


def hand_tracks(actor: Actor, others: Sequence[Actor]) -> HandTracks:
    """Track the hands of the actor and of other people; a hand whose joint is always missing has no track."""
    return HandTracks(_tracks_of(actor), [track for other in others for track in _tracks_of(other).values()])


def _tracks_of(actor: Actor) -> dict[Hand, HandTrack]:
    tracks = [_hand_track(actor, side) for side in BOTH_HANDS]
    return {track.side: track for track in tracks if len(track.stamps_ns)}


def _hand_track(actor: Actor, side: Hand) -> HandTrack:
    positions_m = actor.hand_in_camera_m(side)
    known = np.flatnonzero(np.isfinite(positions_m).all(axis=1))
    stamps_ns, smooth_m = actor.stamps_ns[known], _smoothed(positions_m[known], actor.stamps_ns[known])
    stride = max(1, math.ceil(len(known) / MOST_INSTANTS))
    return HandTrack(side, stamps_ns[::stride], smooth_m[::stride])


def _smoothed(positions_m: Array, stamps_ns: Array) -> Array:
    """Average positions (n, 3) over a fifth of a second around each, over less time near both ends."""
    if not len(positions_m):
        return positions_m
    here = np.arange(len(stamps_ns))
    before = here - np.searchsorted(stamps_ns, stamps_ns - SMOOTHING_NS)
    after = np.searchsorted(stamps_ns, stamps_ns + SMOOTHING_NS, side="right") - 1 - here
    half = np.minimum(before, after)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(positions_m, axis=0)])
    mean: Array = (sums[here + half + 1] - sums[here - half]) / (2 * half + 1)[:, None]
    return mean


def last_instants_away(positions_m: Array, step_m: float) -> Indices:
    """Find, for each of n positions (n, 3), the last earlier one that is `step_m` or more away.

    Returns:
        indices (n,), -1 where there is none.
    """
    last = np.full(len(positions_m), -1, dtype=np.int64)
    for i, position_m in enumerate(positions_m):
        away = np.flatnonzero(np.linalg.norm(positions_m[:i] - position_m, axis=1) >= step_m)
        if len(away):
            last[i] = away[-1]
    return last


def instants_furthest_away(positions_m: Array, stamps_ns: Array, within_ns: float) -> Indices:
    """Find, for each of n positions (n, 3) at stamps (n,), the earlier instant at which it was furthest away.

    That is the last instant within `within_ns` with at least four fifths of the greatest distance, so that time at
    rest before a motion does not count.

    Returns:
        indices (n,), each at most the position's own index.
    """
    if not len(positions_m):
        return np.empty(0, dtype=np.int64)
    here = np.arange(len(positions_m))
    earliest = np.searchsorted(stamps_ns, stamps_ns - within_ns)
    window = earliest[:, None] + np.arange((here - earliest).max() + 1)
    away = np.linalg.norm(positions_m[np.minimum(window, here[:, None])] - positions_m[:, None], axis=2)
    far = (away >= FURTHEST_SHARE * away.max(axis=1, keepdims=True)) & (window <= here[:, None])
    last: Indices = window[here, far.shape[1] - 1 - np.argmax(far[:, ::-1], axis=1)]
    return last
