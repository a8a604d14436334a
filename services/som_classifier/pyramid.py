"""The temporal pyramid: mean activity of the first maps in overlapping cells of a segment, from prefix sums.

Activities are quantised and added up modulo 2³², so that the sum over any window of frames is exactly the difference
of two prefix sums, wherever the summation began.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Indices

Sums = NDArray[np.uint32]

SCALE = float(2**19)
"""Quantisation steps per unit of activity; a finer step would leave fewer frames before a sum wraps around."""
MOST_FRAMES = 2**32 // 2**19 - 1
"""Longest run of frames of activity 1 whose sum stays below 2³²; longer segments are summed in runs of this length."""


def quantised(activities: Floats) -> Sums:
    """Return activities within [0, 1] as whole quantisation steps, in the same shape."""
    whole: Sums = np.rint(activities * SCALE).astype(np.uint32)
    return whole


@dataclass(frozen=True, slots=True, eq=False)
class Prefix:
    """Sums over all frames up to an instant between two frames.

    Attributes:
        sums: of quantised activities modulo 2³², (units,) each: of the actor as seen and, where kept, mirrored.
        travelled_um: of the displacements of all body parts, micrometres.
    """

    sums: Sequence[Sums]
    travelled_um: int


@dataclass(frozen=True, eq=False)
class PrefixSums:
    """The prefix sums of a segment of n frames.

    Attributes:
        prefixes: the n + 1 before, between and after its frames.
        side: which of their sums are read: 0 for the actor as seen, 1 for the mirror image.
    """

    prefixes: Sequence[Prefix]
    side: int = 0

    def __len__(self) -> int:
        return len(self.prefixes) - 1

    def until(self, frames: int) -> "PrefixSums":
        """Return the prefix sums of the segment's first `frames` frames."""
        return PrefixSums(self.prefixes[: frames + 1], self.side)

    def since_start(self, at: Sequence[int]) -> NDArray[np.unsignedinteger]:
        """Return the quantised activities summed up to each of the instants `at` (0 to n), shape (len(at), units)."""
        if len(self) > MOST_FRAMES:
            return self._since_start_in_runs(at)
        sums = self._sums(at)
        sums -= self.prefixes[0].sums[self.side]
        return sums

    def _since_start_in_runs(self, at: Sequence[int]) -> NDArray[np.uint64]:
        """Return the same for segments over which a sum may wrap around 2³² more than once."""
        run_starts = self._sums(range(0, len(self.prefixes), MOST_FRAMES))
        before = np.cumsum(np.diff(run_starts, axis=0, prepend=run_starts[:1]), axis=0, dtype=np.uint64)
        run = [k // MOST_FRAMES for k in at]
        summed: NDArray[np.uint64] = before[run] + (self._sums(at) - run_starts[run])
        return summed

    def _sums(self, at: Sequence[int]) -> Sums:
        prefixes, side = self.prefixes, self.side
        return np.concatenate([prefixes[k].sums[side] for k in at]).reshape(len(at), -1)

    def instants_of(self, progress: Sequence[float]) -> Floats:
        """Return the instants, as fractional frame numbers from 0 to n, at which a segment reaches given progress.

        Progress rises from 0 to 1: half of it with time, half with the distance that the body parts travel; with time
        alone where nothing moves. Within a frame it is linear.

        Args:
            progress: (k,); the result has the same shape.
        """
        begin_um = self.prefixes[0].travelled_um
        moved_um = self.prefixes[-1].travelled_um - begin_um
        per_frame, per_um = (0.5 / len(self), 0.5 / moved_um) if moved_um > 0 else (1.0 / len(self), 0.0)
        reached = [per_frame * k + per_um * (at.travelled_um - begin_um) for k, at in enumerate(self.prefixes)]
        instants: Floats = np.interp(progress, reached, np.arange(len(self.prefixes)))
        return instants


@dataclass(frozen=True)
class Pyramid:
    """Cells that divide a segment evenly on each level, each reaching over its borders into its neighbours.

    Their borders are placed by progress (see `PrefixSums.instants_of`), so that rests before and after an action shift
    the cells less.

    Attributes:
        levels: the number of cells on each level.
        overlap: how far a cell reaches over each border, as a fraction of its length.
    """

    levels: tuple[int, ...]
    overlap: float

    @property
    def cells(self) -> int:
        """How many cells there are in all."""
        return sum(self.levels)

    def vector(self, segment: PrefixSums) -> NDArray[np.float32]:
        """Return the fourth root of each cell's mean activity, cell after cell, shape (cells * units,).

        Raises:
            ValueError: there is no frame.
        """
        if not len(segment):
            raise ValueError("the segment contains no frame")
        at = segment.instants_of(self._borders)
        below = np.minimum(at.astype(np.intp), len(segment) - 1)
        sums, growth = (
            segment.since_start([*below.tolist(), *(below + 1).tolist()]).astype(np.float32).reshape(2, len(below), -1)
        )
        growth -= sums
        growth *= (at - below).astype(np.float32)[:, None]
        sums += growth
        pooled: NDArray[np.float32] = sums[self._ends]
        pooled -= sums[self._begins]
        pooled /= ((at[self._ends] - at[self._begins]) * SCALE).astype(np.float32)[:, None]
        np.sqrt(np.sqrt(pooled, out=pooled), out=pooled)
        return pooled.ravel()

    @cached_property
    def _spans(self) -> list[tuple[float, float]]:
        """The progress at which each cell begins and ends."""
        return [
            (max((cell - self.overlap) / level, 0.0), min((cell + 1 + self.overlap) / level, 1.0))
            for level in self.levels
            for cell in range(level)
        ]

    @cached_property
    def _borders(self) -> list[float]:
        """Where cells begin or end, each once, rising."""
        return sorted({border for span in self._spans for border in span})

    @cached_property
    def _begins(self) -> Indices:
        """At which of the borders each cell begins, shape (cells,)."""
        return np.array([self._borders.index(begin) for begin, _ in self._spans])

    @cached_property
    def _ends(self) -> Indices:
        """At which of the borders each cell ends, shape (cells,)."""
        return np.array([self._borders.index(end) for _, end in self._spans])
