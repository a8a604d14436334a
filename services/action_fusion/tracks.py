"""Where each object was at any instant of a segment, from the frames in which it was seen."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from action_fusion.samples import Array, ObjectsSample

SETTLED_SAMPLES = 3
"""An object's place at an instant is the median of this many sightings, so that one bad one does no harm."""


@dataclass(frozen=True)
class Track:
    """An object's sightings: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3), camera frame.

    Where it is `carried`, some are no sightings but places in the hand that covered it.
    """

    id: int
    name: str
    stamps_ns: Array
    positions_m: Array
    carried: bool = False

    def at(self, stamps_ns: Array) -> Array:
        """Interpolate linearly between sightings, holding the first and the last: (p,) to (p, 3)."""
        axes = [np.interp(stamps_ns, self.stamps_ns, axis) for axis in self.positions_m.T]
        return np.stack(axes, axis=1)

    def shift(self) -> Array:
        """Measure the displacement (3,) from the segment's start to the last sighting, camera frame."""
        before = self.positions_m[self.stamps_ns <= 0]
        start = before[-SETTLED_SAMPLES:] if len(before) else self.positions_m[:SETTLED_SAMPLES]
        end = self.positions_m[-SETTLED_SAMPLES:]
        shift: Array = np.median(end, axis=0) - np.median(start, axis=0)
        return shift


def tracks(frames: Sequence[ObjectsSample], start_ns: int) -> list[Track]:
    """Collect the sightings of each object, by id; stamps count from `start_ns`."""
    ids = sorted({number for frame in frames for number in frame.positions_m})
    return [_track(number, [frame for frame in frames if number in frame.positions_m], start_ns) for number in ids]


def _track(number: int, frames: Sequence[ObjectsSample], start_ns: int) -> Track:
    return Track(
        number,
        frames[-1].names[number],
        np.array([frame.stamp_ns - start_ns for frame in frames], dtype=np.float64),
        np.stack([frame.positions_m[number] for frame in frames]),
    )
