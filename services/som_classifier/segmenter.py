"""Cuts postures into segments by marks: whose, from when to when, with which frames, or why not.

A segment closes once its posture stream has reached the end, or after two seconds of waiting for it; while nobody's
postures come, as when a link is cut, after ten.
"""

from collections import OrderedDict, deque
from collections.abc import Callable, Sequence
from itertools import chain

from actum.flow import Flow
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS, MOST_OPEN_SEGMENTS
from actum.messages import Action, Posture, Segment
from actum.node import Counters, Tick
from actum.stamps import Order
from som_classifier.answered_segments import AnsweredSegments
from som_classifier.beginning import Beginning
from som_classifier.frames import Frame
from som_classifier.losses import NO_END, UNPLACED, why_incomplete, why_no_end
from som_classifier.segments import ClosedSegment, OpenSegment, with_cause
from som_classifier.spotting.search import NO_SEARCH, Search, SearchPlan
from som_classifier.streams import FAR_FUTURE_NS, Encode, Streams

LATE_FOR = 16
"""Segments remembered of those that closed before all their frames had come; their postures are counted as late."""
MARKED = 256
"""Closed marked segments remembered, more than anybody marks in minutes: they win over found ones."""


class Segmenter:
    """Keeps the open segments of one sensor and closes each exactly once."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._streams = Streams(counters)
        self._open: OrderedDict[str, OpenSegment] = OrderedDict()
        self._answered = AnsweredSegments(counters)
        self._marked: deque[OpenSegment] = deque(maxlen=MARKED)
        self._late: deque[tuple[int, range]] = deque(maxlen=LATE_FOR)
        self._session: str | None = None
        self._flow = Flow()
        self._beginning = Beginning()

    def remember(self, answers: Sequence[Action]) -> None:
        """Take the answers given before this process was there; marks that were put meanwhile may come now."""
        self._beginning.resume(answers)
        self._flow.expect()
        for answer in answers:
            self._answered.recall(answer)
            known = answer.segment_id, answer.start_ns, answer.agent, answer.hand, None, answer.end_ns
            self._marked.append(OpenSegment(*known))

    def use(self, encoders: Callable[[], Encode], plan: SearchPlan = NO_SEARCH) -> None:
        """Encode every agent's frames by an encoder of its own, kept ones and those to come; search the latter."""
        self._streams.use(encoders, plan)

    def adjust(self, plan: SearchPlan) -> None:
        """Search every agent's frames by another plan for the same model."""
        self._streams.adjust(plan)

    def posture(self, posture: Posture) -> tuple[Frame | None, list[ClosedSegment]]:
        """Take the next posture; return its frame, None if it is stale, and the segments it closes."""
        closed = self._restart(posture.session_id)
        order, frame = self._streams.add(posture)
        late = any(posture.agent == agent and posture.stamp_ns in stamps for agent, stamps in self._late)
        detail = f"posture of agent {posture.agent} at {posture.stamp_ns}"
        if frame is None:
            self._counters.reject("late" if late else "stale_stamp", detail)
            return None, closed
        if posture.valid and not frame.valid:
            self._counters.reject("bad_posture", f"{detail}: missing, non-finite or absurd joints or motion")
        if order is Order.RESTART:
            closed += self._close_all("the source started anew")
            self._marked.clear()
        elif late:
            self._counters.reject("late", f"{detail}, after its segment was answered")
        self._flow.note()
        self._note_progress(posture.stamp_ns)
        return frame, closed + self._settle()

    def mark(self, mark: Segment) -> list[ClosedSegment]:
        """Take a start or end mark; return the segments it closes."""
        if mark.segment_id not in self._open and self._answered.has(mark):
            return self._answered.mark_again(mark, self._streams.newest_ns or 0)
        if mark.stamp_ns is None and self._beginning.is_settling:
            self._answered.remember(mark.segment_id, None, None)
            return [OpenSegment.of(mark, self._streams.newest_ns).rejected(UNPLACED)]
        return self._start(mark) if mark.kind == "start" else self._end(mark)

    def decline(self, mark: Segment, reason: str) -> list[ClosedSegment]:
        """Reject a segment at its first mark, unless it is open already; return the segments that this closes."""
        if mark.segment_id in self._open:
            return self.mark(mark)
        if self._answered.has(mark):
            return []
        self._answered.remember(mark.segment_id, None, None)
        return [
            OpenSegment.of(mark, self._streams.newest_ns if mark.stamp_ns is None else mark.stamp_ns).rejected(reason)
        ]

    def tick(self, tick: Tick) -> list[ClosedSegment]:
        """Close the segments that have waited too long: 2 s for the last frames, a longest segment for an end mark."""
        self._flow.tick(tick.monotonic_ns)
        self._beginning.tick(tick.monotonic_ns)
        closed = []
        for segment in list(self._open.values()):
            if segment.waiting_since_ns is None:
                segment.waiting_since_ns = tick.monotonic_ns
            waited_ns = tick.monotonic_ns - segment.waiting_since_ns
            if segment.end_ns is None and waited_ns > MAX_SEGMENT_NS + MAX_SKEW_NS:
                closed.append(self._reject(segment, why_no_end(segment, self._streams)))
            elif segment.end_ns is not None and waited_ns > MAX_SKEW_NS and self._may_come_no_more(segment):
                closed.append(self._close(segment))
        return closed

    def _may_come_no_more(self, segment: OpenSegment) -> bool:
        """Tell whether a segment that has waited for its last frames is to be closed without them."""
        assert segment.end_ns is not None and segment.waiting_since_ns is not None
        passed = self._streams.newest_ns is not None and self._streams.newest_ns >= segment.end_ns
        return passed or self._flow.ended(segment.waiting_since_ns, MAX_SKEW_NS)

    def open_at(self, agent: int, stamp_ns: int) -> list[OpenSegment]:
        """List the open segments of an agent that hold this instant."""
        return [segment for segment in self._open.values() if segment.known_agent == agent and segment.holds(stamp_ns)]

    def search_of(self, agent: int) -> Search | None:
        """Return the search for unmarked actions in an agent's stream, if there is one."""
        stream = self._streams.of(agent)
        return None if stream is None else stream.search

    def is_marked(self, agent: int, start_ns: int, end_ns: int) -> bool:
        """Tell whether a marked segment, open or answered, shares a frame with these bounds.

        It may be the agent's or, as long as nobody knows whose it is, anybody's.
        """
        return any(
            segment.known_agent in (agent, None) and segment.overlaps(start_ns, end_ns)
            for segment in chain(self._open.values(), self._marked)
        )

    def cut(self, found: OpenSegment) -> ClosedSegment:
        """Close a segment that nobody marked, of a known agent whose frames have come up to its end."""
        assert found.known_agent is not None
        stream = self._streams.of(found.known_agent)
        return found.rejected("no person") if stream is None else stream.cut(found)

    def frames_between(self, agent: int, start_ns: int, end_ns: int) -> list[Frame]:
        """List an agent's frames with start <= stamp <= end."""
        stream = self._streams.of(agent)
        return [] if stream is None else stream.between(start_ns, end_ns)

    def frames_of(self, segment: OpenSegment) -> list[Frame]:
        """List the frames an open segment holds so far."""
        if segment.known_agent is None or segment.start_ns is None:
            return []
        return self.frames_between(segment.known_agent, segment.start_ns, segment.end_ns or FAR_FUTURE_NS)

    def _note_progress(self, stamp_ns: int) -> None:
        """Start segments that wait for the first posture; restart the wait for an end mark while postures come."""
        for segment in self._open.values():
            if segment.start_ns is None:
                segment.start_ns = stamp_ns
            if segment.end_ns is None and segment.start_ns <= stamp_ns:
                segment.waiting_since_ns = None

    def _settle(self) -> list[ClosedSegment]:
        """Determine agents where that is possible; close the segments whose end is reached and those too long."""
        closed = []
        for segment in list(self._open.values()):
            if segment.known_agent is None and segment.start_ns is not None:
                segment.nearest = self._streams.nearest(segment.start_ns, segment.latest_ns)
            if segment.end_ns is not None:
                if self._is_reached(segment) and self._why_incomplete(segment) is None:
                    closed.append(self._close(segment))
            elif segment.is_too_long(self._streams.newest_ns):
                closed.append(self._reject(segment, NO_END))
        return closed

    def _is_reached(self, segment: OpenSegment) -> bool:
        """Tell whether the acting person's stream has reached the end of a segment that has one."""
        assert segment.end_ns is not None
        return segment.known_agent is not None and self._streams.reached(segment.known_agent, segment.end_ns)

    def _why_incomplete(self, segment: OpenSegment) -> str | None:
        """Return why a segment that has its end mark lacks frames, which may yet come on other people's keys."""
        assert segment.end_ns is not None
        return why_incomplete(self._streams, segment.start_ns or 0, segment.end_ns, self._beginning.is_resumed)

    def _start(self, mark: Segment) -> list[ClosedSegment]:
        if mark.segment_id in self._open:
            self._counters.reject("duplicate_mark", f"second start of {mark.segment_id!r}")
            return []
        start_ns = self._streams.newest_ns if mark.stamp_ns is None else mark.stamp_ns
        segment = OpenSegment.of(mark, start_ns)
        if len(self._open) >= MOST_OPEN_SEGMENTS:
            self._answered.remember(mark.segment_id, start_ns, None)
            self._counters.reject("too_many_segments", f"{mark.segment_id!r} beside {len(self._open)} open ones")
            return [segment.rejected(f"too many open segments: {MOST_OPEN_SEGMENTS} at the most")]
        self._open[mark.segment_id] = segment
        return self._settle()

    def _end(self, mark: Segment) -> list[ClosedSegment]:
        segment = self._open.get(mark.segment_id)
        if segment is None:
            end_ns = mark.stamp_ns if mark.stamp_ns is not None else self._streams.newest_ns or 0
            self._answered.remember(mark.segment_id, None, end_ns)
            return [OpenSegment.of(mark, end_ns, end_ns).rejected("end without start")]
        if segment.end_ns is not None:
            self._counters.reject("duplicate_mark", f"second end of {mark.segment_id!r}")
            return []
        newest_ns = self._streams.newest_ns if self._streams.newest_ns is not None else segment.start_ns or 0
        segment.end_ns = newest_ns if mark.stamp_ns is None else mark.stamp_ns
        segment.nearest = segment.waiting_since_ns = None
        if segment.start_ns is not None and segment.end_ns < segment.start_ns:
            return [self._reject(segment, "end before start")]
        if segment.start_ns is not None and segment.end_ns - segment.start_ns > MAX_SEGMENT_NS:
            return [self._reject(segment, NO_END)]
        return self._settle()

    def _close(self, segment: OpenSegment) -> ClosedSegment:
        """Close a segment that has its end mark, with the frames that have come."""
        assert segment.end_ns is not None
        start_ns = segment.start_ns if segment.start_ns is not None else 0
        if (reason := self._why_incomplete(segment)) is not None:
            return self._reject(segment, reason)
        first = self._streams.first(start_ns, segment.end_ns) if segment.start_ns is not None else None
        agent = segment.known_agent if segment.known_agent is not None or first is None else first[1]
        stream = None if agent is None else self._streams.of(agent)
        if stream is None or agent is None:
            cause = self._streams.first_reason(start_ns, segment.end_ns) if agent is None else None
            reason = "no person" if cause is None else "no person with a usable frame"
            return self._reject(segment, with_cause(reason, cause))
        if segment.end_ns - start_ns > MAX_SEGMENT_NS:
            return self._reject(segment, NO_END)
        if stream.newest_ns < segment.end_ns:
            self._late.append((agent, range(start_ns, segment.end_ns + 1)))
        segment.nearest = agent
        self._forget(segment)
        return stream.cut(segment)

    def _reject(self, segment: OpenSegment, reason: str) -> ClosedSegment:
        self._forget(segment)
        return segment.rejected(reason)

    def _forget(self, segment: OpenSegment) -> None:
        """Move a segment from the open to the answered ones."""
        del self._open[segment.segment_id]
        self._marked.append(segment)
        self._answered.remember(segment.segment_id, segment.start_ns, segment.end_ns)

    def _restart(self, session_id: str) -> list[ClosedSegment]:
        """Close all segments and forget all frames where the session is another one than before."""
        if session_id == self._session:
            return []
        first, self._session = self._session is None, session_id
        if first and self._beginning.is_of(session_id):
            return []
        closed = [] if first else self._close_all("the source started anew")
        self._streams.clear()
        self._answered.end_session()
        self._marked.clear()
        self._late.clear()
        return closed

    def _close_all(self, reason: str) -> list[ClosedSegment]:
        return [
            self._close(segment) if segment.end_ns is not None else self._reject(segment, reason)
            for segment in list(self._open.values())
        ]
