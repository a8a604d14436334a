"""Which hand moves which object: what moves as the hand does, near it, is in it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from action_fusion.buffers import LOOK_BACK_NS
from action_fusion.hands import HandPath, furthest
from action_fusion.samples import Array, Mask
from action_fusion.tracks import Track
from actum.node import SECOND_NS

RECENT_NS = 1 * SECOND_NS
"""Steps are taken over this long: a joint's noise is small beside them, and what moves no further is at rest."""

STEADY_M = 0.05
"""What is in a hand stays within a hand's breadth of its place there."""

EXPLAINED = 0.5
"""The hand's step explains the object's where it takes away more than half of its square."""


@dataclass(frozen=True)
class Comotion:
    """A hand and an object at the hand's instants.

    `relative_m` (n, 3) is from hand to object, `steps_m` (n,) how far the object went since the instant before,
    `near` (n,) whether it was within reach, `moving` (n,) whether it moved noticeably, `with_hand` (n,) whether the
    hand moved it.
    """

    path: HandPath
    track: Track
    object_m: Array
    relative_m: Array
    steps_m: Array
    near: Mask
    moving: Mask
    with_hand: Mask

    @property
    def distances_m(self) -> Array:
        """How far the object was from the hand (n,)."""
        distances: Array = np.linalg.norm(self.relative_m, axis=1)
        return distances

    @property
    def recent(self) -> Mask:
        """Which instants are of the segment or of just before it (n,)."""
        recent: Mask = self.path.stamps_ns >= -LOOK_BACK_NS
        return recent

    @property
    def moved_nearby(self) -> bool:
        """Whether the object moved noticeably within reach during the segment."""
        return bool((self.near & self.moving & (self.path.stamps_ns >= 0)).any())

    def moved_by_hand_m(self, since_ns: float = -LOOK_BACK_NS) -> float:
        """Sum the object's way in the hand from an instant on, by default from just before the segment."""
        return float(self.steps_m[self.with_hand & (self.path.stamps_ns >= since_ns)].sum())

    def is_carried(self, moved_m: float) -> bool:
        """Whether the hand moved the object noticeably, and for more of its way near the hand than not.

        What it did before counts where it has held the object since; else only the segment and the time just before.
        """
        otherwise_m = float(self.steps_m[self.recent & self.moving & self.near & ~self.with_hand].sum())
        return self.moved_by_hand_m() >= max(moved_m, otherwise_m) or self._is_held_since(moved_m)

    def _is_held_since(self, moved_m: float) -> bool:
        """Whether the hand moved the object before the segment, and has had it at the same place in it up to there."""
        before = np.flatnonzero(self.path.stamps_ns < 0)
        recent = before[self.recent[before]]
        if not len(recent):
            return False
        place = np.median(self.relative_m[recent], axis=0)
        strayed = np.linalg.norm(self.relative_m[before] - place, axis=1) > STEADY_M
        held = before[np.flatnonzero(strayed)[-1] + 1 :] if strayed.any() else before
        return float(self.steps_m[held][self.with_hand[held]].sum()) >= moved_m


def comotion(path: HandPath, track: Track, reach_m: float, moved_m: float) -> Comotion:
    """Compare what hand and object did in the second before each instant.

    With d_o and d_h their displacements since the object was furthest from where it is, the hand moves the object
    where |d_o| is `moved_m` or more and 1 - |d_o - d_h|^2 / |d_o|^2 > 1/2, within reach.
    """
    object_m = track.at(path.stamps_ns)
    since = furthest(object_m, path.stamps_ns, RECENT_NS)
    first_recent = np.searchsorted(path.stamps_ns, -LOOK_BACK_NS)
    since[first_recent:] = np.maximum(since[first_recent:], first_recent)
    object_step = object_m - object_m[since]
    moving: Mask = np.linalg.norm(object_step, axis=1) >= moved_m
    difference = object_step - (path.positions_m - path.positions_m[since])
    unexplained = np.einsum("ij,ij->i", difference, difference)
    explained = unexplained < (1 - EXPLAINED) * np.einsum("ij,ij->i", object_step, object_step)
    relative = object_m - path.positions_m
    near: Mask = np.linalg.norm(relative, axis=1) <= reach_m
    steps = np.linalg.norm(np.diff(object_m, axis=0, prepend=object_m[:1]), axis=1)
    return Comotion(path, track, object_m, relative, steps, near, moving, moving & explained & near)


def carriers(pairs: Sequence[Comotion], moved_m: float) -> Mapping[int, Sequence[HandPath]]:
    """Tell the hands that carry each object, together or one after another, by the object's id."""
    carried: dict[int, list[HandPath]] = {}
    for pair in pairs:
        others = [other for other in pairs if other.track is pair.track and other is not pair]
        if pair.is_carried(moved_m) or _without(pair, others).is_carried(moved_m):
            carried.setdefault(pair.track.id, []).append(pair.path)
    return carried


def _without(pair: Comotion, others: Sequence[Comotion]) -> Comotion:
    """Leave out the instants at which another hand moved the object."""
    apart = np.ones_like(pair.with_hand)
    for other in others:
        if len(other.path.stamps_ns):
            apart &= np.interp(pair.path.stamps_ns, other.path.stamps_ns, other.with_hand) < 0.5
    return replace(pair, moving=pair.moving & apart, with_hand=pair.with_hand & apart)
