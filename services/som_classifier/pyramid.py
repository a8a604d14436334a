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
"""The whole number that stands for an activity of 1."""
MOST_FRAMES = 2**32 // 2**19 - 1
"""So many frames of it stay below 2³²."""


def quantised(activities: Floats) -> Sums:
    """Return activities within [0, 1] as whole numbers."""
    whole: Sums = np.rint(activities * SCALE).astype(np.uint32)
    return whole


@dataclass(frozen=True, slots=True, eq=False)
class Instant:
    """Running totals between two frames.

    Attributes:
        sums: for each side (the actor as seen, and in a mirror) those of its activities, (units,), modulo 2³².
        travelled_um: how far the parts have moved, micrometres.
    """

    sums: Sequence[Sums]
    travelled_um: int


@dataclass(frozen=True, eq=False)
class Trail:
    """A segment of n frames.

    Attributes:
        instants: the n + 1 before, between and after its frames.
        side: which of their sums count.
    """

    instants: Sequence[Instant]
    side: int = 0

    def __len__(self) -> int:
        return len(self.instants) - 1

    def until(self, frames: int) -> "Trail":
        """Return the first frames alone."""
        return Trail(self.instants[: frames + 1], self.side)

    def gained(self, at: Sequence[int]) -> NDArray[np.unsignedinteger]:
        """Return the sums at these instants, 0 to n, less those at the start, shape (instants, units)."""
        if len(self) > MOST_FRAMES:
            return self._gained_in_steps(at)
        sums = self._sums(at)
        sums -= self.instants[0].sums[self.side]
        return sums

    def _gained_in_steps(self, at: Sequence[int]) -> NDArray[np.uint64]:
        """Return the same where the sums may have passed 2³² more than once."""
        marks = self._sums(range(0, len(self.instants), MOST_FRAMES))
        before = np.cumsum(np.diff(marks, axis=0, prepend=marks[:1]), axis=0, dtype=np.uint64)
        step = [k // MOST_FRAMES for k in at]
        gained: NDArray[np.uint64] = before[step] + (self._sums(at) - marks[step])
        return gained

    def _sums(self, at: Sequence[int]) -> Sums:
        instants, side = self.instants, self.side
        return np.concatenate([instants[k].sums[side] for k in at]).reshape(len(at), -1)

    def when(self, shares: Sequence[float]) -> Floats:
        """Return at which instants, 0 to n, the segment is on by these shares (0 to 1): half by time, half by movement.

        By time alone where all is still. Between instants it goes on evenly.
        """
        begin_um = self.instants[0].travelled_um
        moved_um = self.instants[-1].travelled_um - begin_um
        per_frame, per_um = (0.5 / len(self), 0.5 / moved_um) if moved_um > 0 else (1.0 / len(self), 0.0)
        progress = [per_frame * k + per_um * (at.travelled_um - begin_um) for k, at in enumerate(self.instants)]
        instants: Floats = np.interp(shares, progress, np.arange(len(self.instants)))
        return instants


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
        at = trail.when(self._borders)
        below = np.minimum(at.astype(np.intp), len(trail) - 1)
        sums, beyond = _sums_beside(trail, below.tolist())
        beyond -= sums
        beyond *= (at - below).astype(np.float32)[:, None]
        sums += beyond
        pooled: NDArray[np.float32] = sums[self._ends]
        pooled -= sums[self._begins]
        pooled /= ((at[self._ends] - at[self._begins]) * SCALE).astype(np.float32)[:, None]
        np.sqrt(np.sqrt(pooled, out=pooled), out=pooled)
        return pooled.ravel()

    @cached_property
    def _spans(self) -> list[tuple[float, float]]:
        return [
            (max((cell - self.overlap) / level, 0.0), min((cell + 1 + self.overlap) / level, 1.0))
            for level in self.levels
            for cell in range(level)
        ]

    @cached_property
    def _borders(self) -> list[float]:
        """Where cells begin or end, each once, from the start on."""
        return sorted({border for span in self._spans for border in span})

    @cached_property
    def _begins(self) -> NDArray[np.intp]:
        """At which border each cell begins."""
        return np.array([self._borders.index(begin) for begin, _ in self._spans])

    @cached_property
    def _ends(self) -> NDArray[np.intp]:
        return np.array([self._borders.index(end) for _, end in self._spans])


def _sums_beside(trail: Trail, below: Sequence[int]) -> NDArray[np.float32]:
    """Return the sums at these instants and at those that follow, less those at the start, (2, instants, units)."""
    sums = trail.gained([*below, *(k + 1 for k in below)])
    return sums.astype(np.float32).reshape(2, len(below), -1)
