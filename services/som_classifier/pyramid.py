"""The temporal pyramid: mean activity of the first maps in overlapping cells of a segment, from prefix sums.

Activities are kept as whole numbers and added up modulo 2³², so that the sum over any window is the difference of two
running sums to the bit, whenever the summing began.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]
Sums = NDArray[np.uint32]

SCALE = float(2**19)
"""The whole number that stands for an activity of 1: 8191 frames of it stay below 2³²."""


def quantised(activities: Floats) -> Sums:
    """Return activities within [0, 1] as whole numbers."""
    whole: Sums = np.rint(activities * SCALE).astype(np.uint32)
    return whole


@dataclass(frozen=True, eq=False)
class Trail:
    """Running sums at the n + 1 instants before, between and after the n frames of a segment.

    Attributes:
        sums: n + 1 arrays (units,), modulo 2³².
        travelled_um: n + 1 running sums of how far the parts have moved, micrometres.
    """

    sums: Sequence[Sums]
    travelled_um: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.sums) - 1

    def until(self, frames: int) -> "Trail":
        """Return the first frames alone."""
        return Trail(self.sums[: frames + 1], self.travelled_um[: frames + 1])


@dataclass(frozen=True)
class Pyramid:
    """Cells that divide a segment evenly on each level, each reaching over its borders.

    Where a cell begins and ends is measured half by time and half by movement, so that rests before and after an
    action shift the cells less.

    Attributes:
        levels: the number of cells on each level.
        overlap: how far a cell reaches over each border, in parts of its length.
    """

    levels: tuple[int, ...]
    overlap: float

    @property
    def cells(self) -> int:
        """How many cells there are in all."""
        return sum(self.levels)

    def vector(self, trail: Trail) -> NDArray[np.float32]:
        """Return the fourth root of each cell's mean activity, shape (cells * units,).

        Raises:
            ValueError: there is no frame.
        """
        if not len(trail):
            raise ValueError("no frame to pool over")
        at = np.interp(self._borders, _progress(trail.travelled_um), np.arange(len(trail) + 1))
        below = np.minimum(at.astype(np.intp), len(trail) - 1)
        sums = [trail.sums[k] for k in below.tolist()] + [trail.sums[k + 1] for k in below.tolist()]
        until, beyond = np.concatenate(sums).reshape(2, len(below), -1)
        whole = until[self._ends] - until[self._begins]
        partly = (beyond - until).astype(np.float32)
        lengths = np.maximum((at[self._ends] - at[self._begins]) * SCALE, 1.0)[:, None]
        means: NDArray[np.float32] = whole.astype(np.float32)
        means += (self._differences * (at - below)).astype(np.float32) @ partly
        means /= lengths.astype(np.float32)
        np.maximum(means, 0.0, out=means)
        np.sqrt(np.sqrt(means, out=means), out=means)
        return means.ravel()

    @cached_property
    def _spans(self) -> list[tuple[float, float]]:
        return [
            (max((cell - self.overlap) / level, 0.0), min((cell + 1 + self.overlap) / level, 1.0))
            for level in self.levels
            for cell in range(level)
        ]

    @cached_property
    def _borders(self) -> Floats:
        """Where cells begin or end, each once."""
        return np.unique(np.array(self._spans))

    @cached_property
    def _begins(self) -> NDArray[np.intp]:
        """At which border each cell begins."""
        return np.searchsorted(self._borders, [begin for begin, _ in self._spans])

    @cached_property
    def _ends(self) -> NDArray[np.intp]:
        return np.searchsorted(self._borders, [end for _, end in self._spans])

    @cached_property
    def _differences(self) -> Floats:
        """What takes each cell's end less its beginning, shape (cells, borders)."""
        borders = np.eye(len(self._borders))
        differences: Floats = borders[self._ends] - borders[self._begins]
        return differences


def _progress(travelled_um: NDArray[np.int64]) -> Floats:
    """Return how far a segment is at each instant, 0 to 1: half time, half movement; time alone where all is still."""
    frames = len(travelled_um) - 1
    time = np.arange(frames + 1) / frames
    moved = travelled_um - travelled_um[0]
    if moved[-1] <= 0:
        return time
    progress: Floats = 0.5 * time + 0.5 * (moved / moved[-1])
    return progress
