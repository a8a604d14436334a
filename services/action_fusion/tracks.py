"""Where each object was at any instant of a segment, from the frames in which it was seen or followed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from action_fusion.samples import Array, Mask, ObjectsSample
from actum.node import SECOND_NS

SETTLED_SAMPLES = 3
"""An object's place at an instant is the median of this many sightings, so that one bad one does no harm."""

SETTLED_NS = SECOND_NS // 4
"""Sightings further apart than this are not of one place."""

RESTING_M = 0.05
"""What a hand carries is at rest where it stays within a hand's breadth: a joint's noise is less than half of it."""


@dataclass(frozen=True)
class Track:
    """An object's places: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera frame.

    `seen` (n,) tells the sightings; the others are places in the hand that covered it, or of what did. `brought_m` (3,)
    is how far all places were brought along the line of sight, to the hand of a body whose distance is uncertain.
    """

    id: int
    name: str
    stamps_ns: Array
    positions_m: Array
    seen: Mask
    brought_m: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def carried(self) -> bool:
        """Whether some places are no sightings."""
        return not bool(self.seen.all())

    def only(self, kept: Mask) -> "Track":
        """Leave out places: all that are not kept (n,)."""
        return replace(self, stamps_ns=self.stamps_ns[kept], positions_m=self.positions_m[kept], seen=self.seen[kept])

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate linearly between places, holding the first and the last: (p,) to (p, 3)."""
        axes = [np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T]
        return np.stack(axes, axis=1)

    def shift(self) -> Array:
        """Measure the displacement (3,) from the segment's start to the last place, camera frame."""
        shift: Array = self.end() - self._start()
        return shift

    def end(self) -> Array:
        """Find the last place, by the last sightings or, where the object is in a hand, by where that rests."""
        latest = self.stamps_ns >= self.stamps_ns[-1] - SETTLED_NS
        if self.seen[-1]:
            hidden = np.flatnonzero(~self.seen)
            latest[: hidden[-1] + 1 if len(hidden) else 0] = False
            return _middle(self.positions_m[latest][-SETTLED_SAMPLES:])
        gone = ~latest | (np.linalg.norm(self.positions_m - self.positions_m[-1], axis=1) > RESTING_M)
        since = np.flatnonzero(gone | self.seen)
        rest: Array = self.positions_m[since[-1] + 1 if len(since) else 0 :].mean(axis=0)
        return rest

    def _start(self) -> Array:
        """Find the place at the segment's start, by the sightings around it."""
        away_ns = np.abs(self.stamps_ns[self.seen])
        nearest = np.argsort(away_ns, kind="stable")[:SETTLED_SAMPLES]
        around = nearest[away_ns[nearest] <= SETTLED_NS]
        return _middle(self.positions_m[self.seen][around]) if len(around) else self.at(np.zeros(1))[0]


def _middle(places_m: Array) -> Array:
    middle: Array = np.median(places_m, axis=0)
    return middle


def tracks(frames: Sequence[ObjectsSample], start_ns: int) -> list[Track]:
    """Collect the places of each object, by id; stamps count from `start_ns`."""
    ids = sorted({number for frame in frames for number in frame.positions_m})
    return [_track(number, [frame for frame in frames if number in frame.positions_m], start_ns) for number in ids]


def _track(number: int, frames: Sequence[ObjectsSample], start_ns: int) -> Track:
    return Track(
        number,
        frames[-1].names[number],
        np.array([frame.stamp_ns - start_ns for frame in frames], dtype=np.float64),
        np.stack([frame.positions_m[number] for frame in frames]),
        np.array([number not in frame.followed for frame in frames]),
    )
