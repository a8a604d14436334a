"""Tracks of the objects in a segment: positions interpolated between the images with a sighting or image tracking."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from action_fusion.stream_samples import ObjectsSample
from action_fusion.turns import SETTLED_SAMPLES, turn
from actum.arrays import Array, Mask
from actum.node import SECOND_NS

SETTLED_NS = SECOND_NS // 4
"""Nanoseconds from the start or end within which sightings are taken: the object may move in more."""

RESTING_M = 0.05
"""Largest distance from its last position at which a held object is at rest: twice a joint's noise and more."""


@dataclass(frozen=True)
class ObjectTrack:
    """An object's n positions: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera frame.

    `seen` (n,) marks the sightings; the other positions are image-tracked, or inferred from the hand that occludes
    the object. `depth_shift_m` (3,) is what depth alignment has added to all positions.
    """

    id: int
    name: str
    stamps_ns: Array
    positions_m: Array
    seen: Mask
    depth_shift_m: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def label(self) -> str:
        """The object's name in sentences, e.g. `object 3 "cup"`."""
        return f'object {self.id} "{self.name}"'

    @property
    def is_occluded(self) -> bool:
        """Whether the object is occluded at some positions."""
        return not bool(self.seen.all())

    def keeping(self, kept: Mask) -> "ObjectTrack":
        """Drop the positions that are not `kept` (n,)."""
        return replace(self, stamps_ns=self.stamps_ns[kept], positions_m=self.positions_m[kept], seen=self.seen[kept])

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate positions (p, 3) at stamps (p,) linearly, constant beyond both ends."""
        axes = [np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T]
        return np.stack(axes, axis=1)

    def turn(self, moved_m: float) -> int | None:
        """Find the index of the position at which the object turned back in the segment; None where it did not."""
        inside = np.flatnonzero(self.stamps_ns >= 0)
        index = turn(self.positions_m[inside], self._start_m(), self.end_m(), moved_m)
        return None if index is None else int(inside[index])

    def displacement_m(self, moved_m: float) -> Array:
        """Measure the displacement (3,) from the segment's start to the turn or, without one, the end; camera frame."""
        index = self.turn(moved_m)
        half = SETTLED_SAMPLES // 2
        reached_m = self.end_m() if index is None else _median(self.positions_m[index - half : index + half + 1])
        displacement_m: Array = reached_m - self._start_m()
        return displacement_m

    def is_displaced(self, moved_m: float) -> bool:
        """Whether the object is displaced by `moved_m` or more."""
        return float(np.linalg.norm(self.displacement_m(moved_m))) >= moved_m

    def end_m(self) -> Array:
        """Estimate the last position (3,): the median of the last sightings or, if occluded, the mean of the rest."""
        latest = self.stamps_ns >= self.stamps_ns[-1] - SETTLED_NS
        if self.seen[-1]:
            unseen = np.flatnonzero(~self.seen)
            latest[: unseen[-1] + 1 if len(unseen) else 0] = False
            return _median(self.positions_m[latest][-SETTLED_SAMPLES:])
        away = ~latest | (np.linalg.norm(self.positions_m - self.positions_m[-1], axis=1) > RESTING_M)
        before = np.flatnonzero(away | self.seen)
        rest_m: Array = self.positions_m[before[-1] + 1 if len(before) else 0 :].mean(axis=0)
        return rest_m

    def _start_m(self) -> Array:
        """Estimate the position (3,) at the segment's start, by the sightings around it."""
        apart_ns = np.abs(self.stamps_ns[self.seen])
        nearest = np.argsort(apart_ns, kind="stable")[:SETTLED_SAMPLES]
        around = nearest[apart_ns[nearest] <= SETTLED_NS]
        return _median(self.positions_m[self.seen][around]) if len(around) else self.at(np.zeros(1))[0]


def _median(positions_m: Array) -> Array:
    median_m: Array = np.median(positions_m, axis=0)
    return median_m


def object_tracks(frames: Sequence[ObjectsSample], start_ns: int) -> list[ObjectTrack]:
    """Collect the positions of each object, by id; stamps count from `start_ns`."""
    ids = sorted({number for frame in frames for number in frame.positions_m})
    return [_track(number, [frame for frame in frames if number in frame.positions_m], start_ns) for number in ids]


def _track(number: int, frames: Sequence[ObjectsSample], start_ns: int) -> ObjectTrack:
    return ObjectTrack(
        number,
        frames[-1].names[number],
        np.array([frame.stamp_ns - start_ns for frame in frames], dtype=np.float64),
        np.stack([frame.positions_m[number] for frame in frames]),
        np.array([number not in frame.image_tracked for frame in frames]),
    )
