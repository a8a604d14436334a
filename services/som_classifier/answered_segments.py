"""Remembers which segments have been answered, so that none is answered twice when its marks are repeated."""

from collections import OrderedDict
from dataclasses import dataclass

from actum.messages import Segment
from actum.node import Counters
from som_classifier.segments import ClosedSegment, OpenSegment

REMEMBERED = 10_000
"""Segment ids kept: hours of actions, in a few megabytes."""


@dataclass
class _Answered:
    """The bounds of an answered segment, None where unknown, and whether a later segment has reused its id."""

    start_ns: int | None
    end_ns: int | None
    reused: bool = False


class AnsweredSegments:
    """The segments answered last, by id, and the handling of further marks with such an id."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._answered: OrderedDict[str, _Answered] = OrderedDict()

    def __contains__(self, segment_id: str) -> bool:
        return segment_id in self._answered

    def clear(self) -> None:
        """Forget everything."""
        self._answered.clear()

    def remember(self, segment_id: str, start_ns: int | None, end_ns: int | None) -> None:
        """Add a segment that has just been answered."""
        self._answered[segment_id] = _Answered(start_ns, end_ns)
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)

    def mark_again(self, mark: Segment, newest_ns: int) -> list[ClosedSegment]:
        """Count a mark that repeats one of an answered segment; return the rejected segment of one that reuses its id.

        Args:
            mark: its id is that of an answered segment.
            newest_ns: the stamp that a mark without one gets.
        """
        answered = self._answered[mark.segment_id]
        if self._is_repetition(mark, answered):
            return []
        stamp_ns = mark.stamp_ns if mark.stamp_ns is not None else newest_ns
        answered.reused = True
        if mark.kind == "start":
            answered.start_ns = stamp_ns
        return [OpenSegment.of(mark, stamp_ns, stamp_ns).rejected("segment_id reused")]

    def _is_repetition(self, mark: Segment, answered: _Answered) -> bool:
        """Count a mark that repeats an earlier one, or an end that came too late; False if it begins a new segment."""
        is_start = mark.kind == "start"
        known_ns = answered.start_ns if is_start else answered.end_ns
        if not is_start and (answered.reused or mark.stamp_ns is None):
            self._counters.reject("duplicate_mark", f"end of the answered segment {mark.segment_id!r}")
        elif not is_start and known_ns is None:
            self._counters.reject("late", f"end of {mark.segment_id!r} after it was given up")
        elif mark.stamp_ns is not None and mark.stamp_ns == known_ns:
            self._counters.reject("duplicate_mark", f"{mark.kind} of the answered segment {mark.segment_id!r}")
        elif is_start and answered.reused and mark.stamp_ns is None:
            self._counters.reject("duplicate_mark", f"{mark.segment_id!r} is used up")
        else:
            return False
        return True
