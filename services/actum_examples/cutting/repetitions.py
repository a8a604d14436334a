"""The repetitions in what several people did: who repeats something, and from when to when each time."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum_examples.cutting.choice import MARGIN, MOST_REPETITIONS, Chain, Chains
from actum_examples.cutting.courses import RATE_HZ, Course
from actum_examples.cutting.doubts import Doubt, doubts_of
from actum_examples.cutting.movement import rest_postures

AS_GOOD = 0.1
"""Of people whose repetitions are worth the same within this, the nearest to the camera is meant."""
LEAST_SPEED_MPS = 0.03
"""Who never is faster than this (root mean square over the joints) has done nothing: a slow wave of a hand is."""
ALIKE = 0.4
"""Repetitions count along while the least like of them is at least so like the most typical one."""
OTHER_NUMBER = 0.5
"""How sure the cuts are, at most, where another number of repetitions would explain the movement better."""

STIRRING = 0.2
"""Activity above which a person may be in the midst of a repetition that was not cut."""
ABOUT_S = 0.5
"""Time (s) about such movement that may belong to it."""


@dataclass(frozen=True)
class Repetition:
    """One repetition: stamps of its start and end (ns), and how like the most typical one it is, 0 to 1."""

    start_ns: int
    end_ns: int
    likeness: float


@dataclass(frozen=True, eq=False)
class Cuts:
    """What was found of one person's repetitions.

    Attributes:
        course: the movement they are cut from.
        activity: (n,), of the course: 0 at rest, about 1 in the midst of a movement.
        repetitions: in order; they do not overlap.
        sureness: 0 to 1; of those above 0.5, nearly all are right.
        doubted: what may be wrong and where; times count from the start of the recording.
    """

    course: Course
    activity: Array
    repetitions: tuple[Repetition, ...]
    sureness: float
    doubted: tuple[Doubt, ...]

    @property
    def doubts(self) -> tuple[str, ...]:
        """Sentences that say what may be wrong and where."""
        return tuple(doubt.text for doubt in self.doubted)

    @property
    def resting_s(self) -> float:
        """How long the person has been at rest since the last repetition; 0 where there is none (s)."""
        if not self.repetitions:
            return 0.0
        return (self.course.stamp_ns(len(self.activity) - 1) - self.repetitions[-1].end_ns) / SECOND_NS

    @property
    def longest_pause_s(self) -> float:
        """The longest time between two repetitions (s); 0 where there are no two."""
        pauses_ns = [after.start_ns - before.end_ns for before, after in pairwise(self.repetitions)]
        return max(pauses_ns, default=0) / SECOND_NS

    @property
    def uncut_ns(self) -> list[tuple[int, int]]:
        """From when to when the person moves outside of the repetitions, with some time about it: stamps (ns)."""
        stamps_ns = np.array([self.course.stamp_ns(index) for index in range(len(self.activity))])
        moves = np.convolve(self.activity > STIRRING, np.ones(2 * round(ABOUT_S * RATE_HZ) + 1), mode="same") > 0
        for each in self.repetitions:
            moves &= (stamps_ns < each.start_ns) | (stamps_ns > each.end_ns)
        edges = np.flatnonzero(np.diff(np.concatenate([[0], moves, [0]])))
        return [(int(stamps_ns[a]), int(stamps_ns[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


@dataclass(frozen=True, eq=False)
class _Found:
    """The best chain of one course, the activity about its posture of rest, and the number that would be likeliest."""

    course: Course
    activity: Array
    chain: Chain
    likeliest_number: int

    def rank(self, asked: int | None) -> tuple[int, float]:
        """Return what a course is chosen by: enough repetitions, then how well they explain the movement."""
        return min(len(self.chain.bursts), asked or 2), self.chain.worth


def cut(courses: Sequence[Course], asked: int | None, first_ns: int) -> Cuts | None:
    """Cut the repetitions of one action out of what people did; None where nobody moved.

    Args:
        courses: of everybody who was seen.
        asked: how many repetitions there should be; None where nobody knows.
        first_ns: stamp from which doubts count their times.
    """
    return _cut(courses, asked, first_ns, lambda chains: min(asked or chains.likeliest_number, chains.longest))


def cut_so_far(courses: Sequence[Course], asked: int, first_ns: int) -> Cuts | None:
    """Cut as many repetitions, up to the number asked, as are alike: of a stream that still goes on; else as `cut`."""

    def number_alike(chains: Chains) -> int:
        numbers = range(min(asked, chains.longest), 1, -1)
        return next((number for number in numbers if chains.chain(number).likeness.min() >= ALIKE), 1)

    return _cut(courses, None, first_ns, number_alike)


def _cut(
    courses: Sequence[Course], asked: int | None, first_ns: int, number_of: Callable[[Chains], int]
) -> Cuts | None:
    found = [best for best in (_best_chain(course, asked, number_of) for course in courses) if best is not None]
    if not found:
        return None
    most = max(each.rank(asked) for each in found)
    as_good = [each for each in found if each.rank(asked) >= (most[0], most[1] - AS_GOOD)]
    chosen = min(as_good, key=lambda each: (each.course.distance_m, -each.chain.worth))
    repetitions = tuple(_repetitions(chosen))
    sureness = float(chosen.chain.likeness.min())
    if chosen.likeliest_number != len(repetitions) or asked not in (None, len(repetitions)):
        sureness = min(sureness, OTHER_NUMBER)
    doubted = doubts_of(chosen.course, chosen.activity, chosen.chain, asked, first_ns)
    return Cuts(chosen.course, chosen.activity, repetitions, sureness, tuple(doubted))


def _best_chain(course: Course, asked: int | None, number_of: Callable[[Chains], int]) -> _Found | None:
    """Return the best chain about any posture of rest; None where the person does not move."""
    if course.speeds_mps.max() < LEAST_SPEED_MPS:
        return None
    found = []
    for rest in rest_postures(course):
        chains = Chains(course, rest, max(asked or 0, MOST_REPETITIONS))
        if chains.longest:
            chain = chains.chain(number_of(chains))
            found.append(_Found(course, chains.activity, chain, chains.likeliest_number))
    return max(found, key=lambda each: each.rank(asked), default=None)


def _repetitions(found: _Found) -> Iterator[Repetition]:
    """Yield the chain's bursts with some rest before and after; two that are close share it, an instant apart."""
    starts, ends = found.chain.bursts[:, 0], found.chain.bursts[:, 1] - 1
    middles = (ends[:-1] + starts[1:]) / 2
    earliest = np.concatenate([[0.0], middles + 0.5])
    latest = np.concatenate([middles - 0.5, [len(found.activity) - 1.0]])
    bounds = np.stack([np.maximum(starts - MARGIN, earliest), np.minimum(ends + MARGIN, latest)], axis=1)
    for (start, end), likeness in zip(bounds, found.chain.likeness, strict=True):
        yield Repetition(found.course.stamp_ns(start), found.course.stamp_ns(end), float(likeness))
