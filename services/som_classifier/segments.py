"""Marks and postures become segments: whose, from when to when, with which frames, or why not.

A segment is the frames with start <= stamp <= end. It closes once its posture stream has reached the end, or
after two seconds of waiting for it. Which frames belong to it is decided by stamps alone.
"""

from collections import OrderedDict
from dataclasses import dataclass, field

from actum.messages import Hand, Posture, Segment
from actum.node import SECOND_NS, Tally, Tick
from actum.stamps import Order
from som_classifier.streams import Frame, Stream

LONGEST_NS = 60 * SECOND_NS
SKEW_NS = 2 * SECOND_NS
REMEMBERED = 10_000


@dataclass
class OpenSegment:
    """A segment under way. `start_ns` is None until the first posture where none had been seen before."""

    segment_id: str
    start_ns: int | None
    agent: int | None
    hand: Hand | None
    label: str | None
    end_ns: int | None = None
    waiting_since_ns: int | None = None


@dataclass(frozen=True)
class Closed:
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

    def __init__(self, tally: Tally) -> None:
        self._tally = tally
        self._streams: dict[int, Stream] = {}
        self._open: OrderedDict[str, OpenSegment] = OrderedDict()
        self._answered: OrderedDict[str, _Answered] = OrderedDict()
        self._late_until: dict[int, int] = {}
        self._session: str | None = None
        self._newest_ns: int | None = None
        self._silent_since_ns: int | None = None

    @property
    def frames(self) -> list[Frame]:
        """List every remembered frame."""
        return [frame for stream in self._streams.values() for frame in stream]

    def posture(self, posture: Posture) -> tuple[Frame | None, list[Closed]]:
        """Take the next posture; return its frame, None if it is stale, and the segments it closes."""
        closed = self._restart(posture.session_id)
        stream = self._streams.setdefault(posture.agent, Stream())
        order, frame = stream.add(posture)
        if frame is None:
            late = posture.stamp_ns <= self._late_until.get(posture.agent, -1)
            self._tally.reject("late" if late else "stale_stamp", f"posture of agent {posture.agent}")
            return None, closed
        if order is Order.RESTART:
            closed += self._close_all("the source started anew")
        elif posture.stamp_ns <= self._late_until.get(posture.agent, -1):
            self._tally.reject("late", f"posture of agent {posture.agent} after its segment was answered")
        self._advance(posture.stamp_ns)
        return frame, closed + self._settle()

    def mark(self, mark: Segment) -> list[Closed]:
        """Take a start or end mark; return the segments it closes."""
        answered = self._answered.get(mark.segment_id)
        if answered is not None:
            return self._repeated(mark, answered)
        return self._start(mark) if mark.kind == "start" else self._end(mark)

    def tick(self, tick: Tick) -> list[Closed]:
        """Give up waiting where two seconds, or a longest segment without postures, have gone by."""
        if self._silent_since_ns is None:
            self._silent_since_ns = tick.monotonic_ns
        silent_ns = tick.monotonic_ns - self._silent_since_ns
        closed = []
        for segment in list(self._open.values()):
            if segment.end_ns is None:
                if silent_ns > LONGEST_NS + SKEW_NS:
                    closed.append(self._reject(segment, "start without end: no end within 60 s"))
            elif segment.waiting_since_ns is None:
                segment.waiting_since_ns = tick.monotonic_ns
            elif tick.monotonic_ns - segment.waiting_since_ns > SKEW_NS:
                closed.append(self._close(segment))
        return closed

    def open_at(self, agent: int, stamp_ns: int) -> list[OpenSegment]:
        """List the segments of an agent that hold this instant."""
        return [
            segment
            for segment in self._open.values()
            if segment.agent == agent
            and segment.start_ns is not None
            and segment.start_ns <= stamp_ns
            and (segment.end_ns is None or stamp_ns <= segment.end_ns)
        ]

    def frames_of(self, segment: OpenSegment) -> list[Frame]:
        """List the frames an open segment holds so far."""
        assert segment.agent is not None and segment.start_ns is not None
        return self._streams[segment.agent].between(segment.start_ns, segment.end_ns or 2**62)

    def _advance(self, stamp_ns: int) -> None:
        self._newest_ns = max(stamp_ns, self._newest_ns if self._newest_ns is not None else 0)
        self._silent_since_ns = None
        for segment in self._open.values():
            if segment.start_ns is None:
                segment.start_ns = stamp_ns

    def _settle(self) -> list[Closed]:
        """Name the agents that can be named, and close what has been reached or overrun."""
        closed = []
        for segment in list(self._open.values()):
            if segment.agent is None:
                segment.agent = self._nearest(segment, waited=False)
            if segment.end_ns is not None:
                if segment.agent is not None and self._reached(segment.agent, segment.end_ns):
                    closed.append(self._close(segment))
            elif self._overrun(segment):
                closed.append(self._reject(segment, "start without end: no end within 60 s"))
        return closed

    def _overrun(self, segment: OpenSegment) -> bool:
        if segment.start_ns is None or self._newest_ns is None:
            return False
        return self._newest_ns > segment.start_ns + LONGEST_NS + SKEW_NS

    def _reached(self, agent: int, stamp_ns: int) -> bool:
        return agent in self._streams and self._streams[agent].newest_ns >= stamp_ns

    def _nearest(self, segment: OpenSegment, waited: bool) -> int | None:
        """Name the agent nearest to the camera at the first valid frame from the start on.

        Every agent of the frames up to there must have been heard, unless there was time enough for it.
        """
        if segment.start_ns is None:
            return None
        end_ns = 2**62 if segment.end_ns is None else segment.end_ns
        held = {agent: stream.between(segment.start_ns, end_ns) for agent, stream in self._streams.items() if agent}
        first_ns = min((f.stamp_ns for frames in held.values() for f in frames if f.valid), default=None)
        if first_ns is None:
            return None
        named = {a for frames in held.values() for f in frames if f.stamp_ns <= first_ns for a in f.agents}
        if not waited and not all(self._reached(agent, first_ns) for agent in named):
            return None
        at_first = [(f.distance_m, a) for a, fs in held.items() for f in fs if f.stamp_ns == first_ns and f.valid]
        return min(at_first)[1]

    def _start(self, mark: Segment) -> list[Closed]:
        if mark.segment_id in self._open:
            self._tally.reject("duplicate_mark", f"second start of {mark.segment_id!r}")
            return []
        start_ns = self._newest_ns if mark.stamp_ns is None else mark.stamp_ns
        self._open[mark.segment_id] = OpenSegment(mark.segment_id, start_ns, mark.agent, mark.hand, mark.label)
        return self._settle()

    def _end(self, mark: Segment) -> list[Closed]:
        segment = self._open.get(mark.segment_id)
        if segment is None:
            return [self._end_without_start(mark)]
        if segment.end_ns is not None:
            self._tally.reject("duplicate_mark", f"second end of {mark.segment_id!r}")
            return []
        newest_ns = self._newest_ns if self._newest_ns is not None else segment.start_ns or 0
        segment.end_ns = newest_ns if mark.stamp_ns is None else mark.stamp_ns
        start_ns = segment.start_ns if segment.start_ns is not None else 0
        if segment.end_ns < start_ns:
            return [self._reject(segment, "end before start")]
        if segment.start_ns is not None and segment.end_ns - start_ns > LONGEST_NS:
            return [self._reject(segment, "start without end: no end within 60 s")]
        return self._settle()

    def _end_without_start(self, mark: Segment) -> Closed:
        end_ns = mark.stamp_ns if mark.stamp_ns is not None else self._newest_ns or 0
        segment = OpenSegment(mark.segment_id, end_ns, mark.agent, mark.hand, mark.label, end_ns)
        self._remember(mark.segment_id, _Answered(None, end_ns))
        return _rejected(segment, "end without start")

    def _repeated(self, mark: Segment, answered: _Answered) -> list[Closed]:
        """A mark of an answered segment: the same again, the end that came too late, or the id used anew."""
        is_start = mark.kind == "start"
        known_ns = answered.start_ns if is_start else answered.end_ns
        if not is_start and (answered.reused or mark.stamp_ns is None):
            self._tally.reject("duplicate_mark", f"end of the answered segment {mark.segment_id!r}")
        elif not is_start and known_ns is None:
            self._tally.reject("late", f"end of {mark.segment_id!r} after it was given up")
        elif mark.stamp_ns is not None and mark.stamp_ns == known_ns:
            self._tally.reject("duplicate_mark", f"{mark.kind} of the answered segment {mark.segment_id!r}")
        elif is_start and answered.reused and mark.stamp_ns is None:
            self._tally.reject("duplicate_mark", f"{mark.segment_id!r} is used up")
        else:
            answered.reused = True
            stamp_ns = mark.stamp_ns if mark.stamp_ns is not None else self._newest_ns or 0
            segment = OpenSegment(mark.segment_id, stamp_ns, mark.agent, mark.hand, mark.label, stamp_ns)
            return [_rejected(segment, "segment_id reused")]
        return []

    def _close(self, segment: OpenSegment) -> Closed:
        """Answer a segment that has its end, with the frames that are there."""
        assert segment.end_ns is not None
        start_ns = segment.start_ns if segment.start_ns is not None else 0
        agent = segment.agent if segment.agent is not None else self._nearest(segment, waited=True)
        stream = self._streams.get(agent) if agent is not None else None
        if stream is None or agent is None:
            return self._reject(segment, "no person")
        if stream.newest_ns < segment.end_ns:
            self._late_until[agent] = max(segment.end_ns, self._late_until.get(agent, -1))
        frames = stream.between(start_ns, segment.end_ns)
        missed = sum(frame.missed for frame in frames) + stream.missed_after(segment.end_ns)
        self._forget(segment)
        return Closed(
            segment.segment_id, start_ns, segment.end_ns, agent, segment.hand, segment.label, frames, missed,
            _why_unusable(frames),
        )  # fmt: skip

    def _reject(self, segment: OpenSegment, reason: str) -> Closed:
        self._forget(segment)
        return _rejected(segment, reason)

    def _forget(self, segment: OpenSegment) -> None:
        del self._open[segment.segment_id]
        self._remember(segment.segment_id, _Answered(segment.start_ns, segment.end_ns))

    def _remember(self, segment_id: str, answered: _Answered) -> None:
        self._answered[segment_id] = answered
        while len(self._answered) > REMEMBERED:
            self._answered.popitem(last=False)

    def _restart(self, session_id: str) -> list[Closed]:
        if session_id == self._session:
            return []
        first, self._session = self._session is None, session_id
        if first:
            return []
        closed = self._close_all("the source started anew")
        self._streams.clear()
        self._answered.clear()
        self._late_until.clear()
        self._newest_ns = None
        return closed

    def _close_all(self, reason: str) -> list[Closed]:
        return [
            self._close(segment) if segment.end_ns is not None else self._reject(segment, reason)
            for segment in list(self._open.values())
        ]


def _rejected(segment: OpenSegment, reason: str) -> Closed:
    start_ns = segment.start_ns if segment.start_ns is not None else 0
    end_ns = segment.end_ns if segment.end_ns is not None else start_ns
    return Closed(
        segment.segment_id, start_ns, end_ns, segment.agent or 0, segment.hand, segment.label, reason=reason
    )  # fmt: skip


def _why_unusable(frames: list[Frame]) -> str | None:
    if not frames:
        return "no person"
    if not any(frame.valid for frame in frames):
        return "no usable frame"
    return None
