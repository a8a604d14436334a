"""Decoding: which of many overlapping candidates are the actions of a stream, decided as it goes on.

It is the segmental Viterbi search of a semi-Markov chain without transitions: of all sets of candidates that do not
overlap, that with the largest sum of gains; background has gain 0. A candidate of the best set is decided once it ended
longer ago than a fixed lag, and then none that overlaps it can take its place.
"""

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.core import steps

Stamps = NDArray[np.int64]


@dataclass(frozen=True)
class Candidate:
    """A span that may be an action.

    Attributes:
        action: the action's index.
        completeness: the head's answer for it.
        gain: what it is worth, more than 0.
    """

    start_ns: int
    end_ns: int
    action: int
    completeness: float
    gain: float


class Spans(NamedTuple):
    """Candidates (n,) in the order of their ends: their starts and ends (ns), and what each is worth, more than 0."""

    starts_ns: Stamps
    ends_ns: Stamps
    gains: Array


class Decoder:
    """Decides on one person's candidates, which come in the order in which they end.

    Args:
        lag_ns: how long after its end a candidate is decided.
        memory_ns: how long a candidate is remembered after its end.
        overlap: the share of its duration by which a candidate may reach into the one decided before it. That much is
            cut off: the end of an action is often found a little late.
    """

    def __init__(self, lag_ns: int, memory_ns: int, overlap: float) -> None:
        self.lag_ns, self.memory_ns, self.overlap = lag_ns, memory_ns, overlap
        self._pending: list[Candidate] = []
        self._decided_ns = -1

    def step(self, now_ns: int, candidates: Iterable[Candidate]) -> list[Candidate]:
        """Take the candidates that end now; return those that are decided thereby, in order."""
        remembered = [each for each in self._pending if each.end_ns >= now_ns - self.memory_ns]
        self._pending = [each for each in (*remembered, *candidates) if self.is_free(each.start_ns, each.end_ns)]
        if not self._pending:
            return []
        decided = [each for each in best_set(self._pending) if each.end_ns <= now_ns - self.lag_ns]
        starts_ns = [max(each.start_ns, self._decided_ns + 1) for each in decided]
        if decided:
            self._decided_ns = decided[-1].end_ns
        return [replace(each, start_ns=start_ns) for each, start_ns in zip(decided, starts_ns, strict=True)]

    def forget(self) -> None:
        """Forget what is not decided: after a gap nobody knows how it went on."""
        self._pending.clear()

    def is_free(self, start_ns: int, end_ns: int) -> bool:
        """Tell whether a span follows the candidate decided last, or reaches into it no further than is allowed."""
        return end_ns > self._decided_ns and self._decided_ns - start_ns <= self.overlap * (end_ns - start_ns)


@dataclass(frozen=True)
class Decided:
    """A segment that a decoder found: the number of its candidate, its start, and when it was decided (ns)."""

    candidate: int
    start_ns: int
    decided_ns: int


def decoded(decoder: Decoder, spans: Spans, decisions_ns: Stamps, restarts: NDArray[np.bool_]) -> list[Decided]:
    """Decide on all candidates of a stream, as a new decoder does live.

    Args:
        decoder: which has taken no candidate yet.
        spans: the candidates.
        decisions_ns: (k,), rising, the instants of its steps; the ends of all candidates are among them.
        restarts: (k,), at which of them it forgets first.
    """
    if steps is not None:
        found = steps.decoded(*spans, decisions_ns, restarts, decoder.lag_ns, decoder.memory_ns, decoder.overlap)
        return [Decided(*each) for each in found]
    ending = defaultdict(list)
    for number, (start_ns, end_ns, gain) in enumerate(zip(*(column.tolist() for column in spans), strict=True)):
        ending[end_ns].append(Candidate(start_ns, end_ns, number, 0.0, gain))
    decided = []
    for now_ns, restarts_now in zip(decisions_ns.tolist(), restarts.tolist(), strict=True):
        if restarts_now:
            decoder.forget()
        decided += [Decided(each.action, each.start_ns, now_ns) for each in decoder.step(now_ns, ending[now_ns])]
    return decided


def best_set(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return those that do not overlap and whose sum of gains is largest, in order; of equal sets the earliest.

    Args:
        candidates: in the order of their ends.
    """
    ends_ns, gains = [-1], [0.0]
    chosen: list[tuple[Candidate, int] | None] = [None]
    for candidate in candidates:
        before = max(bisect_left(ends_ns, candidate.start_ns) - 1, 0)
        gain = gains[before] + candidate.gain
        ends_ns.append(candidate.end_ns)
        chosen.append((candidate, before) if gain > gains[-1] else None)
        gains.append(max(gain, gains[-1]))
    best, node = [], len(chosen) - 1
    while node > 0:
        step = chosen[node]
        node = node - 1 if step is None else step[1]
        best += [] if step is None else [step[0]]
    return best[::-1]
