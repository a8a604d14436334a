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
from actum.core import steps

Sums = NDArray[np.uint32]

SCALE = float(2**19)
"""Quantisation steps per unit of activity; a finer step would leave fewer frames before a sum wraps around."""
MOST_FRAMES = 2**32 // 2**19 - 1
"""Longest run of frames of activity 1 whose sum stays below 2³²; longer segments are summed in runs of this length."""

MOST_SIGNED = 2**12
"""Frames from which on a sum may need all 32 bits; those of fewer are converted as signed numbers, which is faster."""


def quantised(activities: Floats) -> Sums:
    """Return activities within [0, 1] as whole quantisation steps, in the same shape."""
    whole: Sums = np.rint(activities * SCALE).astype(np.uint32)
    return whole


def running_sums(activities: Floats) -> Sums:
    """Return the sums of activities (n, units), quantised, before each row and after the last, (n + 1, units)."""
    sums = np.zeros((len(activities) + 1, activities.shape[1]), np.uint32)
    if steps is not None and activities.dtype == np.float32:
        steps.running_sums(activities, SCALE, activities.shape[1], sums)
        return sums
    for row, before, after in zip(quantised(activities), sums, sums[1:], strict=False):
        np.add(before, row, out=after)  # row by row: np.cumsum takes several times as long
    return sums


@dataclass(frozen=True, eq=False)
class PrefixSums:
    """The prefix sums of a segment of n frames, before, between and after its frames.

    Attributes:
        sums: of quantised activities modulo 2³², n + 1 times (units,).
        travelled_um: (n + 1,), of the displacements of all body parts, micrometres.
    """

    sums: Sequence[Sums] | Sums
    travelled_um: NDArray[np.int64]

    def __len__(self) -> int:
        return len(self.sums) - 1

    def between(self, first: int, after: int) -> "PrefixSums":
        """Return the prefix sums of the frames from `first` up to the one before `after`."""
        return PrefixSums(self.sums[first : after + 1], self.travelled_um[first : after + 1])

    def since_start(self, at: Sequence[int]) -> NDArray[np.unsignedinteger]:
        """Return the quantised activities summed up to each of the instants `at` (0 to n), shape (len(at), units)."""
        if len(self) > MOST_FRAMES:
            return self._since_start_in_runs(at)
        sums = self._sums(at)
        sums -= self.sums[0]
        return sums

    def _since_start_in_runs(self, at: Sequence[int]) -> NDArray[np.uint64]:
        """Return the same for segments over which a sum may wrap around 2³² more than once."""
        run_starts = self._sums(range(0, len(self.sums), MOST_FRAMES))
        before = np.cumsum(np.diff(run_starts, axis=0, prepend=run_starts[:1]), axis=0, dtype=np.uint64)
        run = [k // MOST_FRAMES for k in at]
        summed: NDArray[np.uint64] = before[run] + (self._sums(at) - run_starts[run])
        return summed

    def _sums(self, at: Sequence[int]) -> Sums:
        if isinstance(self.sums, np.ndarray):
            return self.sums.take(at, axis=0)
        return np.concatenate([self.sums[k] for k in at]).reshape(len(at), -1)

    def instants_of(self, progress: Sequence[float] | Floats) -> Floats:
        """Return the instants, as fractional frame numbers from 0 to n, at which a segment reaches given progress.

        Progress rises from 0 to 1: half of it with time, half with the distance that the body parts travel; with time
        alone where nothing moves. Within a frame it is linear.

        Args:
            progress: (k,); the result has the same shape.
        """
        so_far_um, frames = self.travelled_um - self.travelled_um[0], np.arange(len(self.sums))
        moved_um = int(so_far_um[-1])
        per_frame, per_um = (0.5 / len(self), 0.5 / moved_um) if moved_um > 0 else (1.0 / len(self), 0.0)
        instants: Floats = np.interp(progress, per_frame * frames + per_um * so_far_um, frames)
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

    @cached_property
    def cells(self) -> int:
        """How many cells there are in all."""
        return sum(self.levels)

    def vector(self, segment: PrefixSums) -> NDArray[np.float32]:
        """Return the fourth root of each cell's mean activity, cell after cell, shape (cells * units,).

        Raises:
            ValueError: there is no frame.
        """
        if not len(segment):
            raise ValueError("the segment contains no frame, so it has no feature vector: give at least one frame")
        vector = np.empty(self.cells * len(segment.sums[0]), np.float32)
        self.pool(segment, np.array([[0, len(segment)]]), vector[None])
        return vector

    def pool(self, run: PrefixSums, spans: NDArray[np.int64], out: NDArray[np.float32]) -> None:
        """Write the vectors of spans of a run's frames.

        Args:
            run: of all frames.
            spans: (n, 2), the first frame of each, and the one after its last; none is empty.
            out: (n, cells * units), room for the vectors, which lie one after the other in memory.
        """
        if steps is None or np.diff(spans).max(initial=0) > MOST_FRAMES:
            for vector, (first, after) in zip(out, spans.tolist(), strict=True):
                vector[:] = self._vector(run.between(first, after))
        else:
            sums, whole = np.ascontiguousarray(run.sums), np.ascontiguousarray(spans)
            steps.pooled(sums, run.travelled_um, whole, *self.compiled, SCALE, out)

    def _vector(self, segment: PrefixSums) -> NDArray[np.float32]:
        at = segment.instants_of(self._borders)
        last = len(segment) - 1
        below = [min(int(instant), last) for instant in at.tolist()]
        whole = segment.since_start([*below, *[k + 1 for k in below]])
        if len(segment) < MOST_SIGNED:
            whole = whole.view(np.int32)
        sums, growth = whole.astype(np.float32).reshape(2, len(below), -1)
        growth -= sums
        growth *= (at - below).astype(np.float32)[:, None]
        sums += growth
        pooled: NDArray[np.float32] = sums.take(self._ends, axis=0)
        pooled -= sums.take(self._begins, axis=0)
        pooled /= ((at[self._ends] - at[self._begins]) * SCALE).astype(np.float32)[:, None]
        np.sqrt(np.sqrt(pooled, out=pooled), out=pooled)
        return pooled.ravel()

    @cached_property
    def compiled(self) -> tuple[bytes, bytes, bytes]:
        """Borders, and at which of them each cell begins and ends, as the compiled steps read them."""
        begins, ends = (each.astype(np.int32).tobytes() for each in (self._begins, self._ends))
        return self._borders.tobytes(), begins, ends

    @cached_property
    def _spans(self) -> list[tuple[float, float]]:
        """The progress at which each cell begins and ends."""
        return [
            (max((cell - self.overlap) / level, 0.0), min((cell + 1 + self.overlap) / level, 1.0))
            for level in self.levels
            for cell in range(level)
        ]

    @cached_property
    def _borders(self) -> Floats:
        """Where cells begin or end, each once, rising, shape (borders,)."""
        return np.array(sorted({border for span in self._spans for border in span}))

    @cached_property
    def _begins(self) -> Indices:
        """At which of the borders each cell begins, shape (cells,)."""
        return self._borders.searchsorted([begin for begin, _ in self._spans])

    @cached_property
    def _ends(self) -> Indices:
        """At which of the borders each cell ends, shape (cells,)."""
        return self._borders.searchsorted([end for _, end in self._spans])
