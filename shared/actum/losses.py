"""Keeps the newest samples of a stream, and measures the longest part of a segment whose samples are lost."""

from bisect import bisect_left, bisect_right
from collections import deque
from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import Generic, Protocol, TypeVar

from actum.node import SECOND_NS

LOST_NS = SECOND_NS // 2
"""A lost part of a segment that is no longer than this (ns) hardly matters: it is interpolated well enough."""
LOST_SHARE = 0.25
"""A lost part of no more than this share of the segment hardly matters either: most of the action is left."""
MOST_ANSWERED = 16
"""Number of answered segments that are remembered of a stream, to recognise samples that come too late for them."""


class Stamped(Protocol):
    """Anything with a capture stamp."""

    @property
    def stamp_ns(self) -> int:
        """The capture time."""
        ...


S = TypeVar("S", bound=Stamped)


class StreamBuffer(Generic[S]):
    """The newest samples of one stream, stamps rising, and the segments that were answered without some of them.

    Args:
        memory_ns: how long samples are kept.
    """

    def __init__(self, memory_ns: int) -> None:
        self._memory_ns = memory_ns
        self._samples: list[S] = []
        self._stamps_ns: list[int] = []
        self._answered: deque[range] = deque(maxlen=MOST_ANSWERED)

    def __len__(self) -> int:
        return len(self._samples)

    def __iter__(self) -> Iterator[S]:
        return iter(self._samples)

    @property
    def newest_ns(self) -> int:
        """Stamp of the newest sample, -1 where there is none."""
        return self._stamps_ns[-1] if self._stamps_ns else -1

    @property
    def newest(self) -> S | None:
        """The newest sample; None where there is none."""
        return self._samples[-1] if self._samples else None

    def append(self, sample: S) -> None:
        """Add the next sample, and forget the samples that are too old."""
        self._samples.append(sample)
        self._stamps_ns.append(sample.stamp_ns)
        oldest_ns = sample.stamp_ns - self._memory_ns
        if self._stamps_ns[0] < oldest_ns:
            self._let_go(bisect_left(self._stamps_ns, oldest_ns))

    def let_go(self) -> None:
        """Forget the oldest sample."""
        self._let_go(1)

    def _let_go(self, count: int) -> None:
        del self._samples[:count], self._stamps_ns[:count]

    def clear(self) -> None:
        """Forget everything, after a restart of the stream."""
        self._samples.clear()
        self._stamps_ns.clear()
        self._answered.clear()

    def between(self, start_ns: int, end_ns: int) -> list[S]:
        """List the samples with start <= stamp <= end, in order."""
        first = bisect_left(self._stamps_ns, start_ns)
        if end_ns >= self.newest_ns:
            return self._samples[first:]
        return self._samples[first : bisect_right(self._stamps_ns, end_ns, lo=first)]

    def is_dense(self, start_ns: int, end_ns: int) -> bool:
        """Tell whether nowhere in a segment samples are further apart than a lost part that hardly matters."""
        first = bisect_left(self._stamps_ns, start_ns)
        stamps_ns = [start_ns, *self._stamps_ns[first : bisect_right(self._stamps_ns, end_ns, lo=first)], end_ns]
        return all(then_ns - before_ns <= LOST_NS for before_ns, then_ns in pairwise(stamps_ns))

    def mark_answered(self, start_ns: int, end_ns: int) -> None:
        """Remember that a segment has been answered, so that its later samples are too late."""
        self._answered.append(range(start_ns, end_ns + 1))

    def is_too_late(self, stamp_ns: int) -> bool:
        """Tell whether a sample belongs to a segment that has been answered without it."""
        return any(stamp_ns in segment for segment in self._answered)


def longest_loss_s(
    gaps_ns: Iterable[tuple[int, int]], start_ns: int, end_ns: int, tolerated_ns: float = LOST_NS
) -> float | None:
    """Return how long (s) the longest gap in a segment's samples is; None where all of them are tolerated.

    Args:
        gaps_ns: the stamps between which samples are lost; only time after the segment's start counts.
        start_ns: the segment's start.
        end_ns: its end.
        tolerated_ns: the longest gap that is tolerated in a short segment.
    """
    longest_ns = max((then_ns - max(before_ns, start_ns) for before_ns, then_ns in gaps_ns), default=0)
    return longest_ns / SECOND_NS if longest_ns > max(tolerated_ns, LOST_SHARE * (end_ns - start_ns)) else None
