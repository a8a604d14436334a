"""Co-motion of a hand and an object: an object that moves near a hand and as the hand does is in that hand."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from action_fusion.intake.buffers import LOOK_BACK_NS
from action_fusion.tracks.hand_tracks import HandTrack
from action_fusion.tracks.object_tracks import ObjectTrack
from actum.arrays import Array, Indices, Mask, median, stacked
from actum.core import steps
from actum.node import SECOND_NS

STEP_NS = 1 * SECOND_NS
"""Nanoseconds over which displacements are measured: long enough for motion to exceed a joint's noise."""

STEADY_M = 0.05
"""Largest deviation of a held object's offset from the hand: the breadth of a hand."""

EXPLAINED = 0.5
"""Least share of the object's squared displacement that the hand's displacement explains."""

FURTHEST_SHARE = 0.8
"""Share of the greatest distance from which a position counts as furthest: the rest may be noise."""


@dataclass(frozen=True, eq=False)
class Comotion:
    """The motion of an object relative to a hand, at the n instants of the hand's track.

    `object_m` (n, 3) is the object's position in the camera frame, `hand_to_object_m` (n, 3) the vector from the hand
    to it, `distances_m` (n,) the length of that vector, `path_m` (n,) the object's path since the previous instant.
    `near` (n,) tells whether the object is within reach, `in_motion` (n,) whether its displacement over `STEP_NS` is
    noticeable, too, and `with_hand` (n,) whether it is the hand that moves it.
    """

    hand: HandTrack
    track: ObjectTrack
    object_m: Array
    hand_to_object_m: Array
    distances_m: Array
    path_m: Array
    near: Mask
    in_motion: Mask
    with_hand: Mask

    @property
    def in_motion_nearby(self) -> bool:
        """Whether the object was in motion within reach during the segment."""
        return bool(self.in_motion[self.hand.stamps_ns.searchsorted(0) :].any())

    def transport_m(self, since_ns: float = -LOOK_BACK_NS) -> float:
        """Return the length of the object's path in the hand since an instant, by default just before the segment."""
        first = self.hand.stamps_ns.searchsorted(since_ns)
        return float(self.path_m[first:][self.with_hand[first:]].sum())

    def is_transported(self, moved_m: float) -> bool:
        """Whether the hand moved the object by `moved_m` or more, and for at least half of its path near the hand.

        Only the segment and `LOOK_BACK_NS` before it count, and earlier motion if the hand has held the object since.
        """
        if not self.with_hand.any():
            return False
        otherwise_m = float(self.path_m[self.hand.recent & self.in_motion & ~self.with_hand].sum())
        return self.transport_m() >= max(moved_m, otherwise_m) or self._is_held_since(moved_m)

    def _is_held_since(self, moved_m: float) -> bool:
        """Whether the hand moved the object before the segment, and kept it at a constant offset up to the segment."""
        recent, begin = self.hand.stamps_ns.searchsorted((-LOOK_BACK_NS, 0)).tolist()
        if recent == begin or not self.with_hand[:begin].any():
            return False
        in_hand_m = median(self.hand_to_object_m[recent:begin])
        slipped = (distances_m(self.hand_to_object_m[:begin], in_hand_m) > STEADY_M).nonzero()[0]
        held = slice(slipped[-1] + 1 if len(slipped) else 0, begin)
        return float(self.path_m[held][self.with_hand[held]].sum()) >= moved_m


def comotion(hand: HandTrack, track: ObjectTrack, reach_m: float, moved_m: float) -> Comotion:
    """Compare the displacements of hand and object at each instant of the hand's track.

    The displacements d_o and d_h are taken since the instant of the last second at which the object was furthest from
    its present position. The hand moves the object where |d_o| is `moved_m` or more, the explained share
    1 - |d_o - d_h|^2 / |d_o|^2 exceeds 1/2, and the object is within `reach_m`.
    """
    if steps is None:
        return _comotion_in_numpy(hand, track, reach_m, moved_m)
    n = len(hand.stamps_ns)
    numbers, marks = np.empty(8 * n), np.empty((3, n), np.bool_)
    steps.comotion(
        hand.stamps_ns, hand.positions_m, track.stamps_ns, track.positions_m, STEP_NS, -LOOK_BACK_NS, FURTHEST_SHARE,
        reach_m, moved_m if track.extent_m >= moved_m else np.inf, 1 - EXPLAINED, numbers, marks,
    )  # fmt: skip
    return Comotion(hand, track, *numbers[: 6 * n].reshape(2, n, 3), *numbers[6 * n :].reshape(2, n), *marks)


def _comotion_in_numpy(hand: HandTrack, track: ObjectTrack, reach_m: float, moved_m: float) -> Comotion:
    object_m = track.at(hand.stamps_ns)
    hand_to_object_m = object_m - hand.positions_m
    apart_m = distances_m(object_m, hand.positions_m)
    path_m = distances_m(object_m, object_m[[0, *range(len(object_m) - 1)]])
    near: Mask = apart_m <= reach_m
    in_motion, with_hand = np.zeros_like(near), np.zeros_like(near)
    instants = np.flatnonzero(near)
    if len(instants) and track.extent_m >= moved_m:
        since = instants_furthest_away(object_m, hand.stamps_ns, STEP_NS, instants)
        first_recent = np.searchsorted(hand.stamps_ns, -LOOK_BACK_NS)
        since = np.where(instants < first_recent, since, np.maximum(since, first_recent))
        object_step, hand_step = (each[instants] - each[since] for each in (object_m, hand.positions_m))
        moved2_m2 = squared_distances_m2(object_step, np.zeros(3))
        in_motion[instants] = np.sqrt(moved2_m2) >= moved_m
        explained = squared_distances_m2(object_step, hand_step) < (1 - EXPLAINED) * moved2_m2
        with_hand[instants] = in_motion[instants] & explained
    return Comotion(hand, track, object_m, hand_to_object_m, apart_m, path_m, near, in_motion, with_hand)


def gaps_m(hands: Sequence[HandTrack], tracks: Sequence[ObjectTrack]) -> Array:
    """Return how far the bounds of each hand's and each object's positions are apart, (hands, tracks).

    No hand was ever closer to an object than that.
    """
    hand_bounds_m = stacked([hand.bounds_m for hand in hands], 2, 3)[:, None]
    track_bounds_m = stacked([track.bounds_m for track in tracks], 2, 3)
    beyond_m = np.maximum(hand_bounds_m[:, :, 0] - track_bounds_m[:, 1], track_bounds_m[:, 0] - hand_bounds_m[:, :, 1])
    gaps: Array = np.linalg.norm(np.maximum(beyond_m, 0.0), axis=2)
    return gaps


def transporting(pairs: Sequence[Comotion], moved_m: float) -> frozenset[Comotion]:
    """Return the pairs in which the hand transports the object, together with other hands or one after another."""
    moving = [pair for pair in pairs if pair.with_hand.any()]
    return frozenset(pair for pair in moving if _is_transported_among(pair, moving, moved_m))


def _is_transported_among(pair: Comotion, pairs: Sequence[Comotion], moved_m: float) -> bool:
    """Whether the hand transports the object, perhaps only at the instants at which no other hand moved the object."""
    if pair.is_transported(moved_m):
        return True
    others = [other for other in pairs if other.track is pair.track and other is not pair]
    if not others:
        return False
    alone = np.ones_like(pair.with_hand)
    for other in others:
        alone &= np.interp(pair.hand.stamps_ns, other.hand.stamps_ns, other.with_hand) < 0.5
    pair_alone = replace(pair, in_motion=pair.in_motion & alone, with_hand=pair.with_hand & alone)
    return pair_alone.is_transported(moved_m)


def instants_furthest_away(positions_m: Array, stamps_ns: Array, within_ns: float, instants: Indices) -> Indices:
    """Find, for some of n positions (n, 3) at stamps (n,), the earlier instant at which it was furthest away.

    That is the last instant within `within_ns` with at least four fifths of the greatest distance, so that time at
    rest before a motion does not count.

    Args:
        positions_m: (n, 3).
        stamps_ns: (n,), rising.
        within_ns: how far back.
        instants: (k,), of which positions; one at least.

    Returns:
        indices (k,), each at most the position's own index.
    """
    earliest = np.searchsorted(stamps_ns, stamps_ns[instants] - within_ns)
    window = earliest[:, None] + np.arange((instants - earliest).max() + 1)
    away = distances_m(positions_m[instants, None], positions_m[np.minimum(window, instants[:, None])])
    far = (away >= FURTHEST_SHARE * away.max(axis=1, keepdims=True)) & (window <= instants[:, None])
    last: Indices = window[np.arange(len(instants)), far.shape[1] - 1 - np.argmax(far[:, ::-1], axis=1)]
    return last


def distances_m(points_m: Array, others_m: Array) -> Array:
    """Return the distances between points (…, 3) and others, which broadcast to each other."""
    distances: Array = np.sqrt(squared_distances_m2(points_m, others_m))
    return distances


def squared_distances_m2(points_m: Array, others_m: Array) -> Array:
    """Return the squares of these distances.

    An axis at a time, since NumPy takes several times as long to sum over an axis of three.
    """
    x, y, z = (points_m[..., axis] - others_m[..., axis] for axis in range(3))
    squares: Array = x * x + y * y + z * z
    return squares
