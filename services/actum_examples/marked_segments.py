"""The segments of one recording, numbered in order of time, and what `actum label` may add beside them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import inf

from actum import keys
from actum.messages import CUT, Action, Event, Segment, Truth
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.rewriting import Change
from actum_examples.cutting.courses import recorded_courses
from actum_examples.cutting.repetitions import Cuts, cut
from actum_examples.edits import MixedMirroringError, following, mirrored_ids, refuse_mixed

FRAMES = (keys.SKELETON, keys.POSTURE)
"""What a person is seen in; a recording of made-up postures has no skeletons."""


class LabellingError(ValueError):
    """What cannot be done to a recording's segments; the text says why and what to do."""


@dataclass(frozen=True)
class LabelledSegment:
    """One marked segment of a recording.

    Attributes:
        number: from 1, in order of start.
        segment_id: as its marks name it.
        sensor: of its marks.
        start_ns: None where it has no start mark.
        end_ns: None where it has no end mark.
        label: the action; None where nobody said.
        origin: who marked it; None where the marks do not say.
        agent: who acts; None where the classifier is to find out.
        answer: the recorded answer in words; None where there is none.
        span_ns: within which stamps its name means this segment: one name is used again after a sensor's restart.
        mirrored: whether left and right are exchanged in its frames, as the trainer does.
    """

    number: int
    segment_id: str
    sensor: str
    start_ns: int | None
    end_ns: int | None
    label: str | None
    origin: str | None
    agent: int | None
    answer: str | None = None
    span_ns: tuple[float, float] = (-inf, inf)
    mirrored: bool = False

    def has(self, message: Segment | Action | Event | Truth) -> bool:
        """Tell whether a message with a stamp is a mark of this segment, an answer to it or its ground truth."""
        if (message.sensor, message.segment_id) != (self.sensor, self.segment_id):
            return False
        at_ns = message.start_ns if isinstance(message, Action | Event) else message.stamp_ns
        return at_ns is not None and self.span_ns[0] <= at_ns < self.span_ns[1]

    def overlaps(self, start_ns: int, end_ns: int, sensor: str, agent: int | None) -> bool:
        """Tell whether a segment of that sensor and agent within these stamps would share time with this one."""
        if self.start_ns is None or self.end_ns is None or sensor != self.sensor:
            return False
        same_person = agent is None or self.agent is None or agent == self.agent
        return same_person and self.start_ns < end_ns and start_ns < self.end_ns


def first_stamp_ns(recording: Recording) -> int:
    """Return the stamp from which a recording's times count: that of its first frame, or else of its first mark.

    Raises:
        RecordingError: the file is damaged.
        LabellingError: there is neither.
    """
    for topics in (FRAMES, (keys.SEGMENT,)):
        first = next(iter(recording.messages(topics)), None)
        if first is not None and first.stamp_ns is not None:
            return first.stamp_ns
    raise LabellingError(f"{recording.path} contains neither skeletons nor marks: give a recording of a person")


def labelled_segments(recording: Recording) -> list[LabelledSegment]:
    """List a recording's segments in order of start, each with the recorded answer to it.

    Raises:
        RecordingError: the file is damaged.
    """
    marks: dict[tuple[str, str], list[dict[str, Segment]]] = {}
    answers: list[Action | Event] = []
    for message in recording.messages((keys.SEGMENT, keys.ACTION, keys.EVENT)):
        if isinstance(message, Segment):
            uses = marks.setdefault((message.sensor, message.segment_id), [{}])
            if message.kind == "start" and "end" in uses[-1]:
                uses.append({})
            uses[-1].setdefault(message.kind, message)
        elif isinstance(message, Event) or (isinstance(message, Action) and message.final):
            answers.append(message)
    spans = [each for uses in marks.values() for each in zip(uses, _spans_ns(uses), strict=True)]
    ordered = sorted(spans, key=lambda each: _first_ns(each[0]))
    listed = [_segment(number, pair, span_ns) for number, (pair, span_ns) in enumerate(ordered, start=1)]
    mirrored = mirrored_ids(recording)
    return [replace(each, answer=_answer_to(each, answers), mirrored=each.segment_id in mirrored) for each in listed]


def segment_of(segments: Sequence[LabelledSegment], number: int) -> LabelledSegment:
    """Return the segment of that number.

    Raises:
        LabellingError: there is none.
    """
    if not 1 <= number <= len(segments):
        there = f"the recording has segments 1 to {len(segments)}" if segments else "the recording has no segments"
        raise LabellingError(f"there is no segment {number}: {there}; 'actum label REC' lists them")
    return segments[number - 1]


def check_span(
    segments: Sequence[LabelledSegment], start_ns: int, end_ns: int, sensor: str, agent: int | None, first_ns: int
) -> None:
    """Refuse a span that a segment cannot have beside these others.

    Raises:
        LabellingError: it ends before it starts, starts before the recording does, or overlaps another segment.
    """
    start_s, end_s = (start_ns - first_ns) / SECOND_NS, (end_ns - first_ns) / SECOND_NS
    if end_ns <= start_ns:
        raise LabellingError(
            f"the segment would run from {start_s:.2f} s to {end_s:.2f} s: the end has to be later than the start"
        )
    if start_ns < first_ns:
        raise LabellingError(f"the segment would start at {start_s:.2f} s, before the recording: use 0 or later")
    for other in segments:
        if other.overlaps(start_ns, end_ns, sensor, agent):
            assert other.start_ns is not None and other.end_ns is not None
            span = f"{(other.start_ns - first_ns) / SECOND_NS:.2f} to {(other.end_ns - first_ns) / SECOND_NS:.2f} s"
            raise LabellingError(
                f"{start_s:.2f} s to {end_s:.2f} s overlaps segment {other.number} ({span}): move or delete that "
                "segment first"
            )


def refuse_outside(recording: Recording, sensor: str, *stamps_ns: int) -> None:
    """Refuse bounds that lie outside of a sensor's frames: whoever reads the recording would skip them.

    Raises:
        RecordingError: the file is damaged.
        LabellingError: one of them does.
    """
    for stamp_ns in stamps_ns:
        if recording.lacks_frames_at(sensor, stamp_ns):
            at_s = (stamp_ns - first_stamp_ns(recording)) / SECOND_NS
            raise LabellingError(f"{at_s:.2f} s lies outside the recording's frames: use a time within them")


def followed(segments: Sequence[LabelledSegment], moved: LabelledSegment) -> Change:
    """Return the change by which the frames of a recording follow one of its segments that was moved.

    Raises:
        LabellingError: it would share frames with another, where only one of both is mirrored.
    """
    others = [other for other in segments if other.number != moved.number]
    try:
        refuse_mixed(moved, others)
    except MixedMirroringError as error:
        raise LabellingError(str(error)) from None
    return following(segments, [*others, moved])


def only_sensor(recording: Recording) -> str:
    """Return the sensor whose frames a recording holds.

    Raises:
        RecordingError: the file is damaged.
        LabellingError: there is none, or there are several.
    """
    names = sorted({sensor for topic in FRAMES for sensor in recording.sensors(topic)})
    if len(names) != 1:
        raise LabellingError(
            f"{recording.path} contains skeletons of {', '.join(names) or 'nobody'}: labelling needs a recording of "
            "exactly one sensor"
        )
    return names[0]


def cut_anew(recording: Recording, segments: Sequence[LabelledSegment], asked: int) -> Cuts:
    """Cut so many repetitions out of a recording, beside the segments that were not cut before.

    Raises:
        RecordingError: the file is damaged.
        LabellingError: nobody moves, or a repetition would overlap a segment of another origin.
    """
    sensor, first_ns = only_sensor(recording), first_stamp_ns(recording)
    cuts = cut(recorded_courses(recording, sensor), asked, first_ns)
    if cuts is None:
        raise LabellingError(
            f"{recording.path} shows no person who moves, so no repetitions can be found: record the action again"
        )
    kept = [segment for segment in segments if segment.origin != CUT]
    for repetition in cuts.repetitions:
        check_span(kept, repetition.start_ns, repetition.end_ns, sensor, cuts.course.agent, first_ns)
    return cuts


def _first_ns(marks: dict[str, Segment]) -> int:
    return min(mark.stamp_ns or 0 for mark in marks.values())


def _spans_ns(uses: Sequence[dict[str, Segment]]) -> Iterator[tuple[float, float]]:
    """Yield for each use of one name from which stamp to which it means that use: to half-way to the next one."""
    between = [((before["end"].stamp_ns or 0) + _first_ns(after)) // 2 for before, after in pairwise(uses)]
    yield from zip([-inf, *between], [*between, inf], strict=True)


def _segment(number: int, pair: dict[str, Segment], span_ns: tuple[float, float]) -> LabelledSegment:
    start, end = pair.get("start"), pair.get("end")
    either = start or pair["end"]
    return LabelledSegment(
        number,
        either.segment_id,
        either.sensor,
        None if start is None else start.stamp_ns,
        None if end is None else end.stamp_ns,
        either.label,
        either.origin,
        either.agent,
        span_ns=span_ns,
    )


def _answer_to(segment: LabelledSegment, answers: Sequence[Action | Event]) -> str | None:
    """Return the last answer to a segment, or, where none names it, the answer that shares most of its time."""
    own = [answer for answer in answers if segment.has(answer)]
    if own or segment.start_ns is None or segment.end_ns is None:
        return _in_words(own[-1]) if own else None
    answers = [answer for answer in answers if answer.sensor == segment.sensor]
    shared_ns = [
        min(answer.end_ns or answer.start_ns, segment.end_ns) - max(answer.start_ns, segment.start_ns)
        for answer in answers
    ]
    best = max(range(len(answers)), key=lambda index: shared_ns[index], default=None)
    return _in_words(answers[best]) if best is not None and shared_ns[best] > 0 else None


def _in_words(answer: Action | Event) -> str:
    if not answer.valid or answer.action is None:
        return "rejected"
    return f"{answer.action} {answer.confidence:.2f}" + (" (unknown)" if answer.unknown else "")
