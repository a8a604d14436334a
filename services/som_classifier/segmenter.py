"""Cuts postures into segments by marks: whose, from when to when, with which frames, or why not.

A segment closes once its posture stream has reached the end, or two seconds after the end is due; while nobody's
postures come, as when a link is cut, after ten. `som_classifier.segments.SegmentState` lists the states of a segment.
"""

from collections import defaultdict, deque
from collections.abc import Sequence
from itertools import chain

from actum.flow import Flow
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS, MOST_OPEN_SEGMENTS
from actum.messages import Action, Posture, Segment
from actum.node import SECOND_NS, Counters, Tick
from actum.stamps import Order
from som_classifier.answered_segments import AnsweredSegments
from som_classifier.frames import Frame
from som_classifier.open_segments import OpenSegments
from som_classifier.segments import ClosedSegment, Marked, OpenSegment, SegmentState, with_cause
from som_classifier.streams import Streams

MARKED = 256
"""Closed marked segments remembered, more than anybody marks in minutes: they win over found ones."""
SETTLING_NS = SECOND_NS
"""How long after its start a resumed process may be given marks that were put before it (ns): they come at once."""
NO_END = "start without end: no end within 60 s"
"""The reason of a segment that is longer than any may be."""
UNPLACED = "the classifier had only just started, so it could not date a mark without a stamp"
"""The reason of a segment whose mark may have waited for the classifier."""


class Segmenter:
    """Keeps the open segments of one sensor and closes each exactly once.

    Attributes:
        streams: the frames of all agents.
    """

    def __init__(self, counters: Counters) -> None:
        self.streams = Streams(counters)
        self._counters = counters
        self._open = OpenSegments()
        self._passed_ns = -1  # the newest stamp since the last tick
        self._answered = AnsweredSegments(counters)
        self._marked: deque[Marked] = deque(maxlen=MARKED)
        self._recalled: defaultdict[str, list[Marked | None]] = defaultdict(list)  # by session
        self._session: str | None = None
        self._flow = Flow()
        self._is_resumed = False
        self._now_ns = self._first_tick_ns = -1

    @property
    def is_busy(self) -> bool:
        """Whether a marked segment is open, or the search sees an action going on."""
        return bool(self._open) or self.streams.any_ongoing

    def remember(self, answers: Sequence[Action]) -> None:
        """Take the answers given before this process was there; marks that were put meanwhile may come now."""
        self._is_resumed = True
        self._session = next((answer.session_id for answer in reversed(answers) if answer.session_id), None)
        self._flow.expect()
        for answer in answers:
            self._answered.recall(answer)
            known = answer.segment_id, answer.start_ns, answer.agent, answer.hand, None, answer.end_ns
            self._recalled[answer.session_id].append(OpenSegment(*known).marked)
        self._recall_marked(self._session or "")

    def posture(self, posture: Posture) -> tuple[Frame | None, list[ClosedSegment]]:
        """Receive the next posture; return its frame, None if it is stale, and the segments it closes."""
        closed = self._restart(posture.session_id)
        order, frame = self.streams.add(posture)
        stream = self.streams.of(posture.agent)
        late = stream is not None and stream.is_too_late(posture.stamp_ns)
        if frame is None:
            self._counters.reject("late" if late else "stale_stamp", _name(posture))
            return None, closed
        if posture.valid and not frame.valid:
            self._counters.reject("bad_posture", f"{_name(posture)}: missing, non-finite or absurd joints or motion")
        if order is Order.RESTART:
            closed += self._close_all()
            self._marked.clear()
        elif late:
            self._counters.reject("late", f"{_name(posture)}, after its segment was answered")
        self._flow.note()
        self._passed_ns = max(self._passed_ns, posture.stamp_ns)
        self._open.date(posture.stamp_ns)
        return frame, closed + self._settle()

    def mark(self, mark: Segment) -> list[ClosedSegment]:
        """Take a start or end mark; return the segments it closes."""
        state = self._state(mark)
        if state not in (SegmentState.NEW, SegmentState.OPEN, SegmentState.ENDED):
            used_up = self._answered.mark_again(mark, self._stamp_ns(mark) or 0)
            return [self._rejected(mark, "segment_id reused")] if used_up else []
        is_settling = self._is_resumed and (self._now_ns < 0 or self._now_ns - self._first_tick_ns < SETTLING_NS)
        is_unplaced = mark.stamp_ns is None and is_settling
        match state, mark.kind:
            case SegmentState.NEW, kind if is_unplaced or kind == "end":
                self._answered.remember(mark.segment_id, None, None if is_unplaced else self._stamp_ns(mark) or 0)
                return [self._rejected(mark, UNPLACED if is_unplaced else "end without start")]
            case SegmentState.NEW, _:
                return self._start(mark)
            case SegmentState.OPEN, "end" if is_unplaced:
                return [self._reject(self._open[mark.segment_id], UNPLACED)]
            case SegmentState.OPEN, "end":
                return self._end(self._open[mark.segment_id], self._stamp_ns(mark))
        self._counters.reject("duplicate_mark", f"second {mark.kind} of {mark.segment_id!r}")
        return []

    def decline(self, mark: Segment, reason: str) -> list[ClosedSegment]:
        """Reject a segment at its first mark, unless it is open already; return the segments that this closes."""
        match self._state(mark):
            case SegmentState.OPEN | SegmentState.ENDED:
                return self.mark(mark)
            case SegmentState.NEW:
                self._answered.remember(mark.segment_id, None, None)
                return [self._rejected(mark, reason)]
        return []

    def tick(self, tick: Tick) -> list[ClosedSegment]:
        """Close the segments that have waited too long: 2 s for frames that are due, a longest segment for an end."""
        self._flow.tick(tick.monotonic_ns)
        self._now_ns = tick.monotonic_ns
        self._first_tick_ns = self._now_ns if self._first_tick_ns < 0 else self._first_tick_ns
        closed = []
        for segment in self._open:
            if segment.waiting_since_ns is None or segment.is_passed(self._passed_ns):
                segment.waiting_since_ns = tick.monotonic_ns + segment.ahead_ns(self.streams.newest_ns)
            waited_ns = tick.monotonic_ns - segment.waiting_since_ns
            if segment.state is SegmentState.OPEN and waited_ns > MAX_SEGMENT_NS + MAX_SKEW_NS:
                closed.append(self._reject(segment, self._why_no_end(segment)))
            if segment.state is SegmentState.ENDED and waited_ns > MAX_SKEW_NS:
                newest_ns = self.streams.newest_ns
                passed = newest_ns is not None and newest_ns >= segment.latest_ns
                if passed or self._flow.ended(segment.waiting_since_ns, MAX_SKEW_NS):
                    closed.append(self._close(segment))
        self._passed_ns = -1
        return closed

    def open_at(self, agent: int, stamp_ns: int) -> list[OpenSegment]:
        """List the open segments of an agent that hold this instant."""
        return [segment for segment in self._open.of(agent) if segment.holds(stamp_ns)]

    def is_marked(self, agent: int, start_ns: int, end_ns: int) -> bool:
        """Tell whether a marked segment, open or answered, shares a frame with these bounds.

        It may be the agent's or, as long as nobody knows whose it is, anybody's.
        """
        is_open = (each.marked for of in (agent, None) for each in self._open.of(of))
        return any(
            of in (agent, None) and first_ns <= end_ns and start_ns <= until_ns
            for of, first_ns, until_ns in chain(filter(None, is_open), self._marked)
        )

    def is_answered(self, segment_id: str) -> bool:
        """Tell whether a segment of this id was marked, or answered before this process was there."""
        return segment_id in self._answered

    def _state(self, mark: Segment) -> SegmentState:
        segment = self._open.get(mark.segment_id)
        return self._answered.state(mark) if segment is None else segment.state

    def _stamp_ns(self, mark: Segment) -> int | None:
        """Return a mark's stamp; of a mark without one the newest stamp of a frame, None where there is none."""
        return self.streams.newest_ns if mark.stamp_ns is None else mark.stamp_ns

    def _rejected(self, mark: Segment, reason: str) -> ClosedSegment:
        return OpenSegment.of(mark, self._stamp_ns(mark)).rejected(reason)

    def _settle(self) -> list[ClosedSegment]:
        """Determine agents where that is possible; close the segments whose end is reached and those too long."""
        closed, newest_ns = [], self.streams.newest_ns
        for segment in self._open.undecided(newest_ns):
            if segment.known_agent is None and segment.start_ns is not None:
                segment.nearest = self.streams.nearest(segment.start_ns, segment.latest_ns)
                if segment.nearest is not None:
                    self._open.sort()
            agent = segment.known_agent
            reached = agent is not None and self.streams.reached(agent, segment.latest_ns)
            if segment.state is SegmentState.OPEN and segment.is_too_long(newest_ns):
                closed.append(self._reject(segment, NO_END))
            elif segment.state is SegmentState.ENDED and reached and self._why_incomplete(segment) is None:
                closed.append(self._close(segment))
        return closed

    def _start(self, mark: Segment) -> list[ClosedSegment]:
        segment = OpenSegment.of(mark, self._stamp_ns(mark))
        if len(self._open) >= MOST_OPEN_SEGMENTS:
            self._answered.remember(mark.segment_id, segment.start_ns, None)
            self._counters.reject("too_many_segments", f"{mark.segment_id!r} beside {len(self._open)} open ones")
            return [segment.rejected(f"too many open segments: {MOST_OPEN_SEGMENTS} at the most")]
        self._open.add(segment)
        return self._settle()

    def _end(self, segment: OpenSegment, end_ns: int | None) -> list[ClosedSegment]:
        segment.end_ns = (segment.start_ns or 0) if end_ns is None else end_ns
        segment.nearest = segment.waiting_since_ns = None
        if segment.start_ns is not None and segment.end_ns < segment.start_ns:
            return [self._reject(segment, "end before start")]
        if segment.start_ns is not None and segment.end_ns - segment.start_ns > MAX_SEGMENT_NS:
            return [self._reject(segment, NO_END)]
        self._open.sort()
        return self._settle()

    def _close(self, segment: OpenSegment) -> ClosedSegment:
        """Close a segment that has its end mark, with the frames that have come."""
        start_ns, end_ns = segment.start_ns or 0, segment.latest_ns
        if (reason := self._why_incomplete(segment)) is not None:
            return self._reject(segment, reason)
        agent = segment.known_agent
        if agent is None and segment.start_ns is not None:
            first = self.streams.first(start_ns, end_ns)
            agent = None if first is None else first[1]
        stream = None if agent is None else self.streams.of(agent)
        if stream is None:
            cause = self.streams.first_reason(start_ns, end_ns) if agent is None else None
            reason = "no person" if cause is None else "no person with a usable frame"
            return self._reject(segment, with_cause(reason, cause))
        if end_ns - start_ns > MAX_SEGMENT_NS:
            return self._reject(segment, NO_END)
        if stream.newest_ns < end_ns:
            stream.mark_answered(start_ns, end_ns)
        segment.nearest = agent
        self._forget(segment)
        return stream.cut(segment)

    def _why_incomplete(self, segment: OpenSegment) -> str | None:
        """Return why a segment that has its end mark lacks frames; None where it has enough."""
        return self.streams.why_incomplete(segment.start_ns or 0, segment.latest_ns, self._is_resumed)

    def _why_no_end(self, segment: OpenSegment) -> str:
        """Return the reason for which a segment is given up whose end mark has not come."""
        newest_ns = self.streams.newest_ns
        if newest_ns is None or segment.start_ns is None or newest_ns < segment.start_ns:
            return "start without end: no frame came after the start"
        elapsed_s = (newest_ns - segment.start_ns) / SECOND_NS
        return f"start without end: the frames ended {elapsed_s:.1f} s after the start"

    def _reject(self, segment: OpenSegment, reason: str) -> ClosedSegment:
        self._forget(segment)
        return segment.rejected(reason)

    def _forget(self, segment: OpenSegment) -> None:
        """Move a segment from the open to the answered ones."""
        self._open.remove(segment)
        self._remember_marked(segment)
        self._answered.remember(segment.segment_id, segment.start_ns, segment.end_ns)

    def _remember_marked(self, segment: OpenSegment) -> None:
        if segment.marked is not None:
            self._marked.append(segment.marked)

    def _recall_marked(self, session_id: str) -> None:
        """Remember the marked segments of a session that were answered before this process was there, and no others."""
        self._marked = deque(filter(None, self._recalled.get(session_id, ())), MARKED)

    def _restart(self, session_id: str) -> list[ClosedSegment]:
        """Close all segments and forget all frames where the session is another one than before."""
        before, self._session = self._session, session_id
        if before in (None, session_id):
            return []
        closed = [] if self.streams.newest_ns is None else self._close_all()
        self.streams.clear()
        self._answered.end_session()
        self._recall_marked(session_id)
        return closed

    def _close_all(self) -> list[ClosedSegment]:
        return [
            self._reject(segment, "the source started anew")
            if segment.state is SegmentState.OPEN
            else self._close(segment)
            for segment in self._open
        ]


def _name(posture: Posture) -> str:
    return f"posture of agent {posture.agent} at {posture.stamp_ns}"
