"""Remembers which segments have been answered, so that none is answered twice when its marks are repeated."""

from collections import OrderedDict
from dataclasses import dataclass, field

from actum.messages import Action, Segment
from actum.node import Counters
from som_classifier.segments import ClosedSegment, OpenSegment

REMEMBERED = 10_000
"""Segment ids kept: hours of actions, in a few megabytes."""


@dataclass
class _Answered:
    """An answered segment.

    Attributes:
        start_ns: None where unknown, as the next.
        end_ns: its end.
        reused: whether a later segment has reused its id.
        told_again: the kinds of marks that may come once more, or late, though it is answered.
        is_of_before: whether the source has started anew since, so that its id may be used again.
    """

    start_ns: int | None
    end_ns: int | None
    reused: bool = False
    told_again: set[str] = field(default_factory=set)
    is_of_before: bool = False

    def stamp_ns(self, kind: str) -> int | None:
        """Return the stamp of its start or its end; None where it is unknown."""
        return self.start_ns if kind == "start" else self.end_ns


class AnsweredSegments:
    """The segments answered last, by id, and the handling of further marks with such an id."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._answered: OrderedDict[str, _Answered] = OrderedDict()

    def has(self, mark: Segment) -> bool:
        """Tell whether a mark is of an answered segment, and not of a new one with the id of one of an earlier session.

        Of that one are the marks with its stamps, and the end where it was given up without.
        """
        answered = self._answered.get(mark.segment_id)
        if answered is None or not answered.is_of_before:
            return answered is not None
        if mark.kind == "end" and answered.end_ns is None:
            return True
        return mark.stamp_ns is not None and mark.stamp_ns == answered.stamp_ns(mark.kind)

    def end_session(self) -> None:
        """Note that the source has started anew: ids may be used again, and marks of before may still come."""
        for answered in self._answered.values():
            answered.told_again, answered.is_of_before = {"start", "end"}, True

    def remember(self, segment_id: str, start_ns: int | None, end_ns: int | None) -> None:
        """Add a segment that has just been answered."""
        self._answered[segment_id] = _Answered(start_ns, end_ns)
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)

    def recall(self, answer: Action) -> None:
        """Add a segment that was answered before this process was there; a second one of an id has reused it."""
        reused = answer.segment_id in self._answered
        ended = answer.valid or answer.end_ns != answer.start_ns
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
        known_ns = answered.stamp_ns(mark.kind)
        expected = mark.stamp_ns in (None, known_ns) or (mark.kind == "end" and known_ns is None)
        if mark.kind not in answered.told_again or not expected:
            return False
        answered.told_again.remove(mark.kind)
        return True

    def _is_repetition(self, mark: Segment, answered: _Answered) -> bool:
        """Count a mark that repeats an earlier one, or an end that came too late; False if it begins a new segment."""
        is_start, known_ns = mark.kind == "start", answered.stamp_ns(mark.kind)
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
