"""Remembers which segments have been answered, so that none is answered twice when its marks are repeated."""

from collections import OrderedDict
from dataclasses import dataclass, field

from actum.messages import Action, Segment
from actum.node import Counters
from som_classifier.segments import WITHOUT_END, ClosedSegment, OpenSegment

REMEMBERED = 10_000
"""Segment ids kept: hours of actions, in a few megabytes."""


@dataclass
class _Answered:
    """The bounds of an answered segment, None where unknown, and whether a later segment has reused its id.

    `told_again` holds the kinds of marks that may come once more, since this process was not there when they were put.
    """

    start_ns: int | None
    end_ns: int | None
    reused: bool = False
    told_again: set[str] = field(default_factory=set)


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

    def recall(self, answer: Action) -> None:
        """Add a segment that was answered before this process was there; a second one of an id has reused it."""
        reused = answer.segment_id in self._answered
        ended = not (answer.reason or "").startswith(WITHOUT_END)
        self.remember(answer.segment_id, answer.start_ns, answer.end_ns if ended else None)
        self._answered[answer.segment_id].reused = reused
        self._answered[answer.segment_id].told_again = {"start", "end"}

    def mark_again(self, mark: Segment, newest_ns: int) -> list[ClosedSegment]:
        """Count a mark that repeats one of an answered segment; return the rejected segment of one that reuses its id.

        Args:
            mark: its id is that of an answered segment.
            newest_ns: the stamp that a mark without one gets.
        """
        answered = self._answered[mark.segment_id]
        if self._is_told_again(mark, answered):
            self._counters.counts["marks_told_again"] += 1
            return []
        if self._is_repetition(mark, answered):
            return []
        stamp_ns = mark.stamp_ns if mark.stamp_ns is not None else newest_ns
        answered.reused = True
        if mark.kind == "start":
            answered.start_ns = stamp_ns
        return [OpenSegment.of(mark, stamp_ns, stamp_ns).rejected("segment_id reused")]

    @staticmethod
    def _is_told_again(mark: Segment, answered: _Answered) -> bool:
        """Tell whether a mark is one to which the answer was given before this process was there."""
        known_ns = answered.start_ns if mark.kind == "start" else answered.end_ns
        if mark.kind not in answered.told_again or mark.stamp_ns not in (None, known_ns):
            return False
        answered.told_again.remove(mark.kind)
        return True

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
