"""The marked segments of a recording. One with a label and both bounds is an example."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf

from actum.messages import Action, Event, Hand, Intent, Segment, Truth

Naming = Segment | Action | Event | Intent | Truth
"""The messages that name a segment: its marks, its answers, the intents while it went on, and its ground truth."""


@dataclass(frozen=True)
class MarkedSegment:
    """One marked segment of a recording.

    Attributes:
        segment_id: as its marks name it.
        sensor: of its marks.
        start_ns: stamp of the start mark; None without one.
        end_ns: stamp of the end mark; None without one.
        label: the action; None where nobody said.
        origin: who marked it; None where the marks do not say.
        agent: who acts; None where the classifier is to find out.
        hand: which hand acts; None where the marks do not say.
        span_ns: within which stamps its name means this segment: a name is used again after a sensor's restart.
        mirrored: whether left and right are exchanged in its frames.
        doubts: what may be wrong with it, in sentences.
    """

    segment_id: str
    sensor: str
    start_ns: int | None
    end_ns: int | None
    label: str | None
    origin: str | None = None
    agent: int | None = None
    hand: Hand | None = None
    span_ns: tuple[float, float] = (-inf, inf)
    mirrored: bool = False
    doubts: tuple[str, ...] = ()

    @property
    def bounds_ns(self) -> tuple[int, int] | None:
        """Stamps of its start and its end (ns); None where a mark is missing."""
        return None if self.start_ns is None or self.end_ns is None else (self.start_ns, self.end_ns)

    @property
    def is_example(self) -> bool:
        """Whether training can learn from it: it has a label and both bounds."""
        return self.label is not None and self.bounds_ns is not None

    def has(self, message: Naming) -> bool:
        """Return whether a message with a stamp names this segment: as a mark, an answer, an intent or its truth."""
        if (message.sensor, message.segment_id) != (self.sensor, self.segment_id):
            return False
        at_ns = message.start_ns if isinstance(message, Action | Event) else message.stamp_ns
        return at_ns is not None and self.span_ns[0] <= at_ns < self.span_ns[1]

    def holds(self, agent: int | None, stamp_ns: int) -> bool:
        """Return whether a person's frame, or anybody's, belongs to it: those at its bounds do."""
        if self.start_ns is None or self.end_ns is None:
            return False
        return self.start_ns <= stamp_ns <= self.end_ns and (agent is None or self.agent in (None, agent))

    def shares_frames(self, other: "MarkedSegment") -> bool:
        """Return whether a frame of one person may belong to two segments."""
        if self.bounds_ns is None or other.bounds_ns is None or self.sensor != other.sensor:
            return False
        same_person = self.agent is None or other.agent is None or self.agent == other.agent
        return same_person and self.bounds_ns[0] <= other.bounds_ns[1] and other.bounds_ns[0] <= self.bounds_ns[1]

    def overlaps(self, other: "MarkedSegment") -> bool:
        """Return whether two segments share more of one person's time than an instant."""
        return self.shares_frames(other) and self.start_ns != other.end_ns and other.start_ns != self.end_ns


def marked_segments(marks: Iterable[Segment]) -> list[MarkedSegment]:
    """List the segments of a recording's marks (with stamps) in order of start. The first mark of each kind counts."""
    by_name: dict[tuple[str, str], list[dict[str, Segment]]] = {}
    for mark in marks:
        uses = by_name.setdefault((mark.sensor, mark.segment_id), [{}])
        if mark.kind == "start" and "end" in uses[-1]:
            uses.append({})
        uses[-1].setdefault(mark.kind, mark)
    spans = [each for uses in by_name.values() for each in zip(uses, _spans_ns(uses), strict=True)]
    return [_segment(pair, span_ns) for pair, span_ns in sorted(spans, key=lambda each: _first_ns(each[0]))]


def _first_ns(pair: dict[str, Segment]) -> int:
    return min(mark.stamp_ns or 0 for mark in pair.values())


def _spans_ns(uses: Sequence[dict[str, Segment]]) -> Iterator[tuple[float, float]]:
    """Yield for each use of one name from which stamp to which it means that use: to half-way to the next one."""
    between = [((before["end"].stamp_ns or 0) + _first_ns(after)) // 2 for before, after in pairwise(uses)]
    yield from zip([-inf, *between], [*between, inf], strict=True)


def _segment(pair: dict[str, Segment], span_ns: tuple[float, float]) -> MarkedSegment:
    start, end = pair.get("start"), pair.get("end")
    either = start or pair["end"]
    return MarkedSegment(
        either.segment_id,
        either.sensor,
        None if start is None else start.stamp_ns,
        None if end is None else end.stamp_ns,
        either.label,
        either.origin,
        either.agent,
        either.hand,
        span_ns,
    )
