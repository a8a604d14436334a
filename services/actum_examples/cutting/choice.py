"""The set of bursts that explains a stream best as repetitions of one of them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from actum.arrays import Array, Indices, Mask
from actum_examples.cutting.bursts import bursts_of
from actum_examples.cutting.courses import RATE_HZ, Course, averaged
from actum_examples.cutting.likeness import likeness_of
from actum_examples.cutting.movement import movement_about

STRICTNESS = 1.0
"""A burst speaks against being a repetition where its likeness is below a half: s / (1 + s)."""
BETWEEN = 0.4
"""Price of a second of movement between two repetitions: a scratch is left out, a repetition is not."""
OUTSIDE = 0.7
"""Price of a second of movement before the first and after the last repetition, at most for the
duration of one: people walk up and back for any time."""
RESTING = 0.3
"""Price of a second of rest within a repetition."""
MOST_REPETITIONS = 40
"""Most repetitions that are found where nobody says how many: ten minutes of quick ones."""
EVIDENT_S = 0.6
"""Time (s) over which a posture is averaged before its way is measured: outliers are shorter."""
EVIDENT_NOISE = 3.0
"""A repetition takes some joint farther than its standing noise by this factor: noise stays below that."""
LEAST_WAY_M = 0.12
"""It also takes it at least so far (m): sway and noise stay below it."""
MARGIN = 3
"""Instants of rest (at `RATE_HZ`) before and after a burst, 0.2 s, as marks by hand have."""
IMPOSSIBLE = -1e9
"""Worth of a chain that there is not."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Bursts one after the other, taken as repetitions of the same action.

    Attributes:
        bursts: (k, 2), first instant of each and the one after its last.
        likeness: (k,), to the one that is most typical.
        worth: how well they explain the movement, at most 1; below 0 where they explain less than they leave over.
    """

    bursts: Indices
    likeness: Array
    worth: float


class Chains:
    """The best chain of each length, about one posture of rest.

    Each burst in turn is the template t. A chain's worth is the sum over its bursts of t's time of movement times
    ((1 + s) likeness - s), s the strictness, less the price of rest within and of movement between and outside. The
    best chain of k bursts follows from those of k - 1 (dynamic programming), for all templates at once.
    """

    def __init__(self, course: Course, rest: Array, most: int = MOST_REPETITIONS) -> None:
        self._movement = movement_about(course, rest)
        self.activity = self._movement.activity
        bursts = bursts_of(self._movement)
        self._bursts = bursts[_evident(course, bursts)]
        self._likeness = likeness_of(course, self._movement, self._bursts) if len(self._bursts) else np.zeros((0, 0))
        self._worths: list[Array] = []
        self._before: list[Indices] = []
        if len(self._bursts):
            self._extend(most)

    @property
    def longest(self) -> int:
        """Bursts in the longest chain."""
        return len(self._worths)

    def chain(self, repetitions: int) -> Chain:
        """Return the best chain of so many bursts, at most `longest`; its worth is a mean over them."""
        worths = (self._worths[repetitions - 1] - self._after) / self._moved_s[:, None]
        template, last = np.unravel_index(int(np.argmax(worths)), worths.shape)
        chosen = [int(last)]
        for before in self._before[repetitions - 1 : 0 : -1]:
            chosen.insert(0, int(before[template, chosen[0]]))
        worth = float(worths[template, last]) / repetitions
        return Chain(self._bursts[chosen], self._likeness[template, chosen], worth)

    @cached_property
    def likeliest_number(self) -> int:
        """The number of repetitions whose best chain explains most movement; one where no two are alike."""
        explained_s = [float((worths - self._after).max()) for worths in self._worths]
        return 2 + int(np.argmax(explained_s[1:])) if len(explained_s) > 1 else len(explained_s)

    @cached_property
    def _moved_s(self) -> Array:
        """Time of movement within each burst, shape (b,)."""
        moved: Array = self._movement.moved_s[self._bursts[:, 1]] - self._movement.moved_s[self._bursts[:, 0]]
        return np.maximum(moved, 1 / RATE_HZ)

    @cached_property
    def _after(self) -> Array:
        """Price of the movement after each burst, were it the last one, for each template, shape (b, b)."""
        return self._price_outside(self._movement.moved_s[-1] - self._movement.moved_s[self._bursts[:, 1]])

    def _price_outside(self, moved_s: Array) -> Array:
        """Return the price of the times of movement (b,) outside a chain for each template, shape (b, b)."""
        priced: Array = OUTSIDE * np.minimum(moved_s, self._moved_s[:, None])
        return priced

    def _extend(self, most: int) -> None:
        """Find the worth (templates, last bursts) of the best chain of each length, and the burst before the last."""
        starts, ends = self._bursts.T
        until_start, until_end = self._movement.moved_s[starts], self._movement.moved_s[ends]
        resting_s = (ends - starts) / RATE_HZ - self._moved_s
        gains = self._moved_s[:, None] * ((1 + STRICTNESS) * self._likeness - STRICTNESS) - RESTING * resting_s
        earlier = np.searchsorted(ends, starts, side="right")
        after = earlier > 0
        self._worths, self._before = [gains - self._price_outside(until_start)], [np.full(gains.shape, -1)]
        while len(self._worths) < most:
            best, which = _running_maximum(self._worths[-1] + BETWEEN * until_end)
            worths, before = np.full(gains.shape, IMPOSSIBLE), np.full(gains.shape, -1)
            worths[:, after] = best[:, earlier[after] - 1] + gains[:, after] - BETWEEN * until_start[after]
            before[:, after] = which[:, earlier[after] - 1]
            if worths.max() < IMPOSSIBLE / 2:
                return
            self._worths.append(worths)
            self._before.append(before)


def _running_maximum(values: Array) -> tuple[Array, Indices]:
    """Return the largest value (rows, columns) of each row so far, and its column."""
    largest = np.maximum.accumulate(values, axis=1)
    columns = np.where(values >= largest, np.arange(values.shape[1]), -1)
    return largest, np.maximum.accumulate(columns, axis=1)


def _evident(course: Course, bursts: Indices) -> Mask:
    """Return for each burst (b, 2) whether some joint goes farther than it does while the person stands still."""
    least_m = np.maximum(LEAST_WAY_M, EVIDENT_NOISE * course.noise_m)
    steady = averaged(course.postures, EVIDENT_S)
    befores = np.maximum(bursts[:, 0] - MARGIN, 0)
    ways_m = [
        np.linalg.norm(steady[before : end + MARGIN] - steady[before], axis=2)
        for before, end in zip(befores, bursts[:, 1], strict=True)
    ]
    return np.array([bool((way_m >= least_m).any()) for way_m in ways_m], dtype=bool)
