"""Remembers which segments have been answered, so that none is answered twice when its marks are repeated."""

from collections import OrderedDict
from dataclasses import dataclass, field

from actum.messages import Action, Segment
from actum.node import Counters
from som_classifier.segments import SegmentState

REMEMBERED = 10_000
"""Segment ids kept: hours of actions, in a few megabytes."""


@dataclass
class _Answered:
    """An answered segment.

    Attributes:
        start_ns: None where unknown, as the next.
        end_ns: its end.
        state: `ANSWERED`, `USED_UP` or `FORMER`.
        awaited: the kinds of marks that may come once more, or late, though it is answered.
        recalled_ns: the starts and ends of other segments of its id that were answered before this process was there.
    """

    start_ns: int | None
    end_ns: int | None
    state: SegmentState = SegmentState.ANSWERED
    awaited: set[str] = field(default_factory=set)
    recalled_ns: set[int | None] = field(default_factory=set)

    def stamp_ns(self, kind: str) -> int | None:
        """Return the stamp of its start or its end; None where it is unknown."""
        return self.start_ns if kind == "start" else self.end_ns


class AnsweredSegments:
    """The segments answered last, by id, and the handling of further marks with such an id."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._answered: OrderedDict[str, _Answered] = OrderedDict()

    def __contains__(self, segment_id: str) -> bool:
        return segment_id in self._answered

    def state(self, mark: Segment) -> SegmentState:
        """Return how far the segment of a mark has come; `NEW` where it is not answered.

        Of a former segment are the marks with its stamps, and the end mark where it was given up without one.
        """
        answered = self._answered.get(mark.segment_id)
        if answered is None:
            return SegmentState.NEW
        known_ns = answered.stamp_ns(mark.kind)
        own = mark.kind == "end" if known_ns is None else mark.stamp_ns == known_ns
        return answered.state if own or answered.state is not SegmentState.FORMER else SegmentState.NEW

    def end_session(self) -> None:
        """Note that the source has started anew: ids may be used again, and marks of before may still come."""
        for answered in self._answered.values():
            answered.awaited, answered.state = {"start", "end"}, SegmentState.FORMER

    def remember(self, segment_id: str, start_ns: int | None, end_ns: int | None) -> None:
        """Add a segment that has just been answered."""
        self._add(segment_id, _Answered(start_ns, end_ns))

    def recall(self, answer: Action) -> None:
        """Add a segment that was answered before this process was there; a second one of an id has used it up."""
        before = self._answered.get(answer.segment_id)
        state = SegmentState.ANSWERED if before is None else SegmentState.USED_UP
        end_ns = answer.end_ns if answer.valid or answer.end_ns != answer.start_ns else None
        recalled = _Answered(answer.start_ns, end_ns, state, {"start", "end"})
        if before is not None:
            recalled.recalled_ns = before.recalled_ns
            recalled.recalled_ns.update((before.start_ns, before.end_ns))
        self._add(answer.segment_id, recalled)

    def _add(self, segment_id: str, answered: _Answered) -> None:
        self._answered[segment_id] = answered
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)

    def mark_again(self, mark: Segment, stamp_ns: int) -> bool:
        """Take a mark with the id of an answered segment; return whether it uses the id for another segment.

        Any other mark is counted: one that was put before this process was there, or before the source started anew,
        and one that repeats an earlier mark or comes too late.

        Args:
            mark: its id is that of an answered segment.
            stamp_ns: its stamp, or the newest one where it has none.
        """
        answered = self._answered[mark.segment_id]
        known_ns, is_end = answered.stamp_ns(mark.kind), mark.kind == "end"
        if mark.stamp_ns is not None and mark.stamp_ns in answered.recalled_ns:
            self._counters.counts["marks_told_again"] += 1
        elif mark.kind in answered.awaited and (mark.stamp_ns in (None, known_ns) or (is_end and known_ns is None)):
            answered.awaited.remove(mark.kind)
            self._counters.counts["marks_told_again"] += 1
        elif is_end and known_ns is None and mark.stamp_ns is not None and answered.state is not SegmentState.USED_UP:
            self._counters.reject("late", f"end of {mark.segment_id!r} after it was given up")
        elif (mark.stamp_ns is not None and mark.stamp_ns == known_ns) or (
            is_end and (mark.stamp_ns is None or answered.state is SegmentState.USED_UP)
        ):
            self._counters.reject("duplicate_mark", f"{mark.kind} of the answered segment {mark.segment_id!r}")
        elif mark.stamp_ns is None and answered.state is SegmentState.USED_UP:
            self._counters.reject("duplicate_mark", f"{mark.segment_id!r} is used up")
        else:
            answered.state = SegmentState.USED_UP
            answered.start_ns = answered.start_ns if is_end else stamp_ns
            return True
        return False
