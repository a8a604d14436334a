"""The edits of a take: every program changes marked segments by these, and the frames follow the segments.

Each replaces the file as a whole, or raises an OSError and leaves it as it was.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

from actum.messages import AUTO, CUT, MANUAL, Hand, segment_marks
from actum.node import SECOND_NS
from actum.rewriting import rewrite, unchanged
from actum_examples.cutting.courses import recorded_courses
from actum_examples.cutting.repetitions import Cuts, cut
from actum_examples.marked_segment import MarkedSegment
from actum_examples.marking import cut_marks, free_names
from actum_examples.stored_changes import deleted, following, in_turn, mirrored_with, remarked, without_messages
from actum_examples.take import Take, frames_topic

OTHER: dict[Hand | None, Hand | None] = {"left": "right", "right": "left", None: None}
"""The hand that acts in a mirror."""
SHORTEST_NS = 100_000_000
"""Shortest segment (ns): three frames at 30 Hz, the fewest that a model answers."""


class EditError(ValueError):
    """What cannot be done to a recording's segments; the text says why and what to do."""


def relabel(take: Take, segment: MarkedSegment, label: str) -> None:
    """Give a segment another label; one that a classifier found is then the user's.

    Raises:
        EditError: it has no start mark to hold the label.
    """
    if segment.start_ns is None:
        raise EditError(
            f"segment {segment.segment_id} cannot be labelled, because it has no start mark: delete the segment"
        )
    origin = MANUAL if segment.origin == AUTO else segment.origin
    _mend(take, [(segment, replace(segment, label=label, origin=origin))])


def move(take: Take, segment: MarkedSegment, start_ns: int, end_ns: int) -> None:
    """Give a segment another start and end. It is then the user's, and what was doubted about it is settled.

    Raises:
        EditError: a mark is missing, or the segment cannot have these bounds beside the others.
    """
    if segment.bounds_ns is None:
        missing = "start" if segment.start_ns is None else "end"
        raise EditError(f"segment {segment.segment_id} has no {missing} mark: delete the segment and add it again")
    moved = replace(segment, start_ns=start_ns, end_ns=end_ns, origin=MANUAL, doubts=())
    others = [other for other in take.segments if other is not segment]
    _refuse_bounds(take, moved, others)
    for other in others:
        if moved.mirrored != other.mirrored and moved.shares_frames(other):
            mirrored, plain = (each.segment_id for each in ((moved, other) if moved.mirrored else (other, moved)))
            raise EditError(
                f"segment {mirrored} is mirrored (left and right exchanged) and segment {plain} is not, so the two "
                f"must not overlap: leave time between the two segments, or mirror {plain} first"
            )
    _mend(take, [(segment, moved)])


def mirror(take: Take, segment: MarkedSegment) -> None:
    """Exchange left and right of whoever acts in a segment, and in those that share frames with it."""
    together = [each for each in mirrored_with(segment, take.segments) if each.mirrored == segment.mirrored]
    _mend(take, [(each, replace(each, mirrored=not each.mirrored, hand=OTHER[each.hand])) for each in together])


def delete(take: Take, segments: Sequence[MarkedSegment]) -> None:
    """Delete segments: what names them, and the frames of whoever acts in them unless another example needs those."""
    kept = [each for each in take.segments if each not in segments]
    rewrite(take.path, deleted(segments, kept), metadata=take.fields_with(kept))


def add(take: Take, start_ns: int, end_ns: int, label: str, agent: int | None) -> None:
    """Add a labelled segment to a recording of one sensor.

    Raises:
        EditError: the recording has several sensors, or the segment cannot have these bounds beside the others.
    """
    name = next(free_names([segment.segment_id for segment in take.segments], "added"))
    added = MarkedSegment(name, _only_sensor(take), start_ns, end_ns, label, MANUAL, agent)
    _refuse_bounds(take, added, take.segments)
    rewrite(take.path, unchanged, segment_marks(start_ns, end_ns, added.sensor, name, label, agent, origin=MANUAL))


def cut_again(take: Take, times: int, label: str) -> Cuts:
    """Cut so many repetitions out of a recording in place of those that were cut before; return what was cut.

    Raises:
        EditError: nobody moves, or a repetition would overlap a segment of another origin.
    """
    sensor = _only_sensor(take)
    cuts = cut(recorded_courses(take.recording, sensor), times, take.first_ns)
    if cuts is None:
        raise EditError(
            f"{take.path} shows no person who moves, so no repetitions can be found: record the action again"
        )
    old = [each for each in take.segments if each.origin == CUT]
    kept = [each for each in take.segments if each.origin != CUT]
    for each in cuts.repetitions:
        repetition = MarkedSegment("", sensor, each.start_ns, each.end_ns, label, CUT, cuts.course.agent)
        _refuse_overlap(take, repetition, kept)
    marks = cut_marks(cuts, label, sensor, [each.segment_id for each in kept])
    change = in_turn(without_messages(old), following(take.segments, kept))
    rewrite(take.path, change, marks, take.fields_with(kept))
    return cuts


def _mend(take: Take, changed: Sequence[tuple[MarkedSegment, MarkedSegment]]) -> None:
    """Put segments in the place of others; the frames follow."""
    new = {id(before): after for before, after in changed}
    segments = [new.get(id(each), each) for each in take.segments]
    marks = (remarked(before, after) for before, after in changed)
    rewrite(take.path, in_turn(*marks, following(take.segments, segments)), metadata=take.fields_with(segments))


def _refuse_bounds(take: Take, segment: MarkedSegment, others: Iterable[MarkedSegment]) -> None:
    """Refuse a segment that is too short, lies outside of the frames, or overlaps another of its person."""
    assert segment.bounds_ns is not None
    start_ns, end_ns = segment.bounds_ns
    span = f"{_seconds(take, start_ns)} to {_seconds(take, end_ns)} s"
    if end_ns - start_ns < SHORTEST_NS:
        raise EditError(
            f"the segment would extend from {span}, which is too short: set the end at least 0.1 s after the start"
        )
    if start_ns < take.first_ns or end_ns > take.last_ns:
        raise EditError(
            f"the segment would extend from {span}, but the recording has frames only from 0 to "
            f"{_seconds(take, take.last_ns)} s: use times in this range"
        )
    _refuse_overlap(take, segment, others)


def _refuse_overlap(take: Take, segment: MarkedSegment, others: Iterable[MarkedSegment]) -> None:
    for other in others:
        if segment.overlaps(other):
            other_span, span = (
                " to ".join(_seconds(take, ns) for ns in each.bounds_ns or ()) for each in (other, segment)
            )
            raise EditError(
                f"the segment would extend from {span} s and overlap the segment {other.segment_id} ({other_span} s): "
                "move or delete that segment first"
            )


def _seconds(take: Take, stamp_ns: int) -> str:
    return f"{(stamp_ns - take.first_ns) / SECOND_NS:.2f}"


def _only_sensor(take: Take) -> str:
    names = take.recording.sensors(frames_topic(take.recording))
    if len(names) != 1:
        found = f" ({', '.join(names)})" if names else ""
        raise EditError(
            f"{take.path} contains skeletons of {len(names)} sensors{found}: give a recording of exactly one sensor"
        )
    return names[0]
