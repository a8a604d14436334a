"""Marks and postures become segments: whose, from when to when, with which frames, or why not.

A segment is the frames with start <= stamp <= end. It closes once its posture stream has reached the end, or
after two seconds of waiting for it. Which frames belong to it is decided by stamps alone.
"""

from collections import OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass, field

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.messages import Hand, Posture, Segment
from actum.node import SECOND_NS, Counters, Tick
from actum.stamps import Order
from som_classifier.frames import Frame
from som_classifier.streams import Encode, Streams

REMEMBERED = 10_000
LATE_FOR = 16
LONGEST_WHY = 500
NO_END = "start without end: no end within 60 s"


@dataclass
class OpenSegment:
    """A segment under way.

    Attributes:
        start_ns: None until the first posture where none had been seen before.
        agent: whose it is, where the mark says so.
        nearest: whose it is otherwise, once that can be told.
        waiting_since_ns: the tick from which on its end, or the frames up to its end, have been waited for.
    """

    segment_id: str
    start_ns: int | None
    agent: int | None
    hand: Hand | None
    label: str | None
    end_ns: int | None = None
    nearest: int | None = None
    waiting_since_ns: int | None = None

    @property
    def whose(self) -> int | None:
        """The agent, as far as it is known."""
        return self.nearest if self.agent is None else self.agent


@dataclass(frozen=True)
class ClosedSegment:
    """An answered segment: its frames, or the reason for which it is rejected."""

    segment_id: str
    start_ns: int
    end_ns: int
    agent: int = 0
    hand: Hand | None = None
    label: str | None = None
    frames: list[Frame] = field(default_factory=list)
    missed: int = 0
    reason: str | None = None


@dataclass
class _Answered:
    start_ns: int | None
    end_ns: int | None
    reused: bool = False


class Segmenter:
    """Keeps the open segments of one sensor and closes each exactly once."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._streams = Streams()
        self._open: OrderedDict[str, OpenSegment] = OrderedDict()
        self._answered: OrderedDict[str, _Answered] = OrderedDict()
        self._late: deque[tuple[int, range]] = deque(maxlen=LATE_FOR)
        self._session: str | None = None

    def use(self, encoders: Callable[[], Encode]) -> None:
        """Encode every agent's frames by an encoder of its own, those remembered and those to come."""
        self._streams.use(encoders)

    def posture(self, posture: Posture) -> tuple[Frame | None, list[ClosedSegment]]:
        """Take the next posture; return its frame, None if it is stale, and the segments it closes."""
        closed = self._restart(posture.session_id)
        order, frame = self._streams.add(posture)
        late = any(posture.agent == agent and posture.stamp_ns in stamps for agent, stamps in self._late)
        what = f"posture of agent {posture.agent} at {posture.stamp_ns}"
        if frame is None:
            self._counters.reject("late" if late else "stale_stamp", what)
            return None, closed
        if posture.valid and not frame.valid:
            self._counters.reject("bad_posture", f"{what}: missing, non-finite or absurd joints or motion")
        if order is Order.RESTART:
            closed += self._close_all("the source started anew")
        elif late:
            self._counters.reject("late", f"{what}, after its segment was answered")
        self._begin_or_go_on(posture.stamp_ns)
        return frame, closed + self._settle()

    def mark(self, mark: Segment) -> list[ClosedSegment]:
        """Take a start or end mark; return the segments it closes."""
        answered = self._answered.get(mark.segment_id)
        if answered is not None:
            return self._repeated(mark, answered)
        return self._start(mark) if mark.kind == "start" else self._end(mark)

    def tick(self, tick: Tick) -> list[ClosedSegment]:
        """Give up waiting: two seconds for the frames up to an end, a longest segment for an end that may come."""
        closed = []
        for segment in list(self._open.values()):
            if segment.waiting_since_ns is None:
                segment.waiting_since_ns = tick.monotonic_ns
            waited_ns = tick.monotonic_ns - segment.waiting_since_ns
            if segment.end_ns is None and waited_ns > MAX_SEGMENT_NS + MAX_SKEW_NS:
                closed.append(self._reject(segment, self._why_no_end(segment)))
            elif segment.end_ns is not None and waited_ns > MAX_SKEW_NS:
                closed.append(self._close(segment))
        return closed

    def _why_no_end(self, segment: OpenSegment) -> str:
        """Say when the stream ended that an end has been waited for in."""
        newest_ns = self._streams.newest_ns
        if newest_ns is None or segment.start_ns is None or newest_ns < segment.start_ns:
            return "start without end: no frame came after the start"
        return f"start without end: the frames ended {(newest_ns - segment.start_ns) / SECOND_NS:.1f} s after the start"

    def open_at(self, agent: int, stamp_ns: int) -> list[OpenSegment]:
        """List the segments of an agent that hold this instant."""
        return [
            segment
            for segment in self._open.values()
            if segment.whose == agent
            and segment.start_ns is not None
            and segment.start_ns <= stamp_ns
            and (segment.end_ns is None or stamp_ns <= segment.end_ns)
        ]

    def frames_of(self, segment: OpenSegment) -> list[Frame]:
        """List the frames an open segment holds so far."""
        stream = None if segment.whose is None else self._streams.of(segment.whose)
        if stream is None or segment.start_ns is None:
            return []
        return stream.between(segment.start_ns, segment.end_ns or 2**62)

    def _begin_or_go_on(self, stamp_ns: int) -> None:
        """Give a start to what waits for the first posture; an end may still come where postures come."""
        for segment in self._open.values():
            if segment.start_ns is None:
                segment.start_ns = stamp_ns
            if segment.end_ns is None and segment.start_ns <= stamp_ns:
                segment.waiting_since_ns = None

    def _settle(self) -> list[ClosedSegment]:
        """Name the agents that can be named, and close what has been reached or overrun."""
        closed = []
        for segment in list(self._open.values()):
            if segment.whose is None:
                segment.nearest = self._nearest(segment)
            if segment.end_ns is not None:
                if segment.whose is not None and self._streams.reached(segment.whose, segment.end_ns):
                    closed.append(self._close(segment))
            elif self._overrun(segment):
                closed.append(self._reject(segment, NO_END))
        return closed

    def _overrun(self, segment: OpenSegment) -> bool:
        newest_ns = self._streams.newest_ns
        if segment.start_ns is None or newest_ns is None:
            return False
        return newest_ns > segment.start_ns + MAX_SEGMENT_NS + MAX_SKEW_NS

    def _nearest(self, segment: OpenSegment) -> int | None:
        """Name the agent nearest to the camera at the first valid frame from the start on, once that is certain."""
        first = self._first(segment)
        if first is None or segment.start_ns is None:
            return None
        stamp_ns, agent = first
        return agent if self._streams.complete(segment.start_ns, stamp_ns) else None

    def _first(self, segment: OpenSegment) -> tuple[int, int] | None:
        if segment.start_ns is None:
            return None
        end_ns = segment.start_ns + MAX_SEGMENT_NS if segment.end_ns is None else segment.end_ns
        return self._streams.first(segment.start_ns, end_ns)

    def _start(self, mark: Segment) -> list[ClosedSegment]:
        if mark.segment_id in self._open:
            self._counters.reject("duplicate_mark", f"second start of {mark.segment_id!r}")
            return []
        start_ns = self._streams.newest_ns if mark.stamp_ns is None else mark.stamp_ns
        self._open[mark.segment_id] = OpenSegment(mark.segment_id, start_ns, mark.agent, mark.hand, mark.label)
        return self._settle()

    def _end(self, mark: Segment) -> list[ClosedSegment]:
        segment = self._open.get(mark.segment_id)
        if segment is None:
            return [self._end_without_start(mark)]
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

    def _end_without_start(self, mark: Segment) -> ClosedSegment:
        end_ns = mark.stamp_ns if mark.stamp_ns is not None else self._streams.newest_ns or 0
        segment = OpenSegment(mark.segment_id, end_ns, mark.agent, mark.hand, mark.label, end_ns)
        self._remember(mark.segment_id, _Answered(None, end_ns))
        return _rejected(segment, "end without start")

    def _repeated(self, mark: Segment, answered: _Answered) -> list[ClosedSegment]:
        """A mark of an answered segment: the same again, the end that came too late, or the id used anew."""
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
            stamp_ns = mark.stamp_ns if mark.stamp_ns is not None else self._streams.newest_ns or 0
            answered.reused, answered.start_ns = True, stamp_ns if is_start else answered.start_ns
            segment = OpenSegment(mark.segment_id, stamp_ns, mark.agent, mark.hand, mark.label, stamp_ns)
            return [_rejected(segment, "segment_id reused")]
        return []

    def _close(self, segment: OpenSegment) -> ClosedSegment:
        """Answer a segment that has its end, with the frames that are there."""
        assert segment.end_ns is not None
        start_ns = segment.start_ns if segment.start_ns is not None else 0
        first = self._first(segment)
        agent = segment.whose if segment.whose is not None or first is None else first[1]
        stream = None if agent is None else self._streams.of(agent)
        if stream is None or agent is None:
            why = self._streams.why_not(start_ns, segment.end_ns) if agent is None else None
            return self._reject(segment, _because("no person" if why is None else "no person with a usable frame", why))
        if segment.end_ns - start_ns > MAX_SEGMENT_NS:
            return self._reject(segment, NO_END)
        if stream.newest_ns < segment.end_ns:
            self._late.append((agent, range(start_ns, segment.end_ns + 1)))
        frames = stream.between(start_ns, segment.end_ns)
        missed = sum(frame.missed for frame in frames) + stream.missed_after(segment.end_ns)
        self._forget(segment)
        return ClosedSegment(
            segment.segment_id, start_ns, segment.end_ns, agent, segment.hand, segment.label, frames, missed,
            _why_unusable(frames),
        )  # fmt: skip

    def _reject(self, segment: OpenSegment, reason: str) -> ClosedSegment:
        self._forget(segment)
        return _rejected(segment, reason)

    def _forget(self, segment: OpenSegment) -> None:
        del self._open[segment.segment_id]
        self._remember(segment.segment_id, _Answered(segment.start_ns, segment.end_ns))

    def _remember(self, segment_id: str, answered: _Answered) -> None:
        self._answered[segment_id] = answered
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)

    def _restart(self, session_id: str) -> list[ClosedSegment]:
        if session_id == self._session:
            return []
        first, self._session = self._session is None, session_id
        if first:
            return []
        closed = self._close_all("the source started anew")
        self._streams.clear()
        self._answered.clear()
        self._late.clear()
        return closed

    def _close_all(self, reason: str) -> list[ClosedSegment]:
        return [
            self._close(segment) if segment.end_ns is not None else self._reject(segment, reason)
            for segment in list(self._open.values())
        ]


def _rejected(segment: OpenSegment, reason: str) -> ClosedSegment:
    start_ns = segment.start_ns if segment.start_ns is not None else 0
    end_ns = segment.end_ns if segment.end_ns is not None else start_ns
    return ClosedSegment(
        segment.segment_id, start_ns, end_ns, segment.whose or 0, segment.hand, segment.label, reason=reason
    )  # fmt: skip


def _why_unusable(frames: list[Frame]) -> str | None:
    if not frames:
        return "no person"
    if not any(frame.valid for frame in frames):
        return _because("no usable frame", next((frame.reason for frame in frames if frame.reason is not None), None))
    return None


def _because(reason: str, why: str | None) -> str:
    return f"{reason} ({why[:LONGEST_WHY]})" if why else reason
