"""Tracks of the objects in a segment: positions interpolated between the images with a sighting or image tracking."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from action_fusion.intake.buffers import Sightings
from action_fusion.intake.stream_samples import ObjectsSample
from action_fusion.tracks.track import Track, bounds_m
from actum.arrays import Array, Mask, median
from actum.node import SECOND_NS

SETTLED_NS = SECOND_NS // 4
"""Nanoseconds from the start or end within which sightings are taken: the object may move in more."""

RESTING_M = 0.05
"""Largest distance from its last position at which a held object is at rest: twice a joint's noise and more."""

SETTLED_SAMPLES = 3
"""Number of positions whose median is an object's position: one outlier does no harm."""

TURN_TO_NOISE = 5.0
"""Least ratio of the way to the turn to the noise's standard deviation: the furthest of many positions may be noise."""

FEWEST_POSITIONS = 10
"""Fewest positions from which the noise can be estimated."""

MAD_TO_STD = 0.6745
"""Median absolute deviation of a Gaussian, in standard deviations."""


@dataclass(frozen=True, eq=False)
class ObjectTrack(Track):
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

    def turn(self, moved_m: float) -> int | None:
        """Find the index of the turn of an object that came back: its position in the segment furthest from the start.

        None where the object did not get `moved_m` away, or does not end nearer to the start than to that position.
        """
        if min(self.extent_m, self._most_away_m) < moved_m or self._furthest is None or self._furthest[1] < moved_m:
            return None
        return self._furthest[0]

    @cached_property
    def _most_away_m(self) -> float:
        """A distance from the start (m) that no position in the segment exceeds, by their bounds."""
        inside_m = self.positions_m[self.stamps_ns.searchsorted(0) :]
        if not len(inside_m):
            return 0.0
        x, y, z = np.abs(bounds_m(inside_m) - self._start_m).max(axis=0).tolist()
        return math.sqrt(x * x + y * y + z * z)

    @cached_property
    def _furthest(self) -> tuple[int, float] | None:
        """Index and distance of the position furthest from the start (m), where the object came back from it."""
        inside = np.flatnonzero(self.stamps_ns >= 0)
        if len(inside) < SETTLED_SAMPLES:
            return None
        positions_m = self.positions_m[inside]
        earlier_m, here_m, later_m = (positions_m[n : len(inside) - 2 + n] for n in range(SETTLED_SAMPLES))
        low_m, high_m = np.minimum(earlier_m, here_m), np.maximum(earlier_m, here_m)
        settled_m = np.maximum(low_m, np.minimum(high_m, later_m))  # the median
        away_m = np.linalg.norm(settled_m - self._start_m, axis=1)
        furthest = int(np.argmax(away_m))
        came_back = math.dist(self.end_m, self._start_m) < math.dist(self.end_m, settled_m[furthest])
        if not came_back or away_m[furthest] < TURN_TO_NOISE * noise_m(positions_m):
            return None
        return int(inside[furthest + SETTLED_SAMPLES // 2]), float(away_m[furthest])

    def displacement_m(self, moved_m: float) -> Array:
        """Measure the displacement (3,) from the segment's start to the turn or, without one, the end; camera frame."""
        index = self.turn(moved_m)
        half = SETTLED_SAMPLES // 2
        reached_m = self.end_m if index is None else median(self.positions_m[index - half : index + half + 1])
        displacement_m: Array = reached_m - self._start_m
        return displacement_m

    def is_displaced(self, moved_m: float) -> bool:
        """Whether the object is displaced by `moved_m` or more."""
        return self.extent_m >= moved_m and math.hypot(*self.displacement_m(moved_m).tolist()) >= moved_m

    @cached_property
    def extent_m(self) -> float:
        """The diagonal of these bounds: no two positions are further apart."""
        return math.dist(*self.bounds_m.tolist())

    @cached_property
    def end_m(self) -> Array:
        """The last position (3,): the median of the last sightings or, if occluded, the mean of the rest."""
        latest = int(self.stamps_ns.searchsorted(self.stamps_ns[-1] - SETTLED_NS))
        if self.seen[-1]:
            unseen = (~self.seen).nonzero()[0]
            return median(self.positions_m[max(latest, *unseen[-1:] + 1, len(self.seen) - SETTLED_SAMPLES) :])
        away = np.linalg.norm(self.positions_m - self.positions_m[-1], axis=1) > RESTING_M
        away[:latest] = True
        before = np.flatnonzero(away | self.seen)
        rest_m: Array = self.positions_m[before[-1] + 1 if len(before) else 0 :].mean(axis=0)
        return rest_m

    @cached_property
    def _start_m(self) -> Array:
        """The position (3,) at the segment's start, by the sightings around it."""
        first, beyond = self.stamps_ns.searchsorted((-SETTLED_NS, SETTLED_NS + 1)).tolist()
        around = first + self.seen[first:beyond].nonzero()[0]
        nearest = around[np.abs(self.stamps_ns[around]).argsort(kind="stable")[:SETTLED_SAMPLES]]
        return median(self.positions_m[nearest]) if len(nearest) else self.at(np.zeros(1))[0]


def object_tracks(sightings: Mapping[int, Sightings], frames: Sequence[ObjectsSample]) -> list[ObjectTrack]:
    """Track each object by its number, under its last name in the frames."""
    return [
        ObjectTrack(number, next(frame.names[number] for frame in reversed(frames) if number in frame.names), *sighted)
        for number, sighted in sightings.items()
    ]


def noise_m(positions_m: Array) -> float:
    """Estimate the noise of positions (n, 3) in metres (one standard deviation); infinite where they are too few.

    From second differences, whose standard deviation is sqrt(6) times as large.
    """
    if len(positions_m) < FEWEST_POSITIONS:
        return float(np.inf)
    deviations_m = median(np.abs(np.diff(positions_m, 2, axis=0)))
    return float(np.linalg.norm(deviations_m) / (MAD_TO_STD * np.sqrt(6)))
