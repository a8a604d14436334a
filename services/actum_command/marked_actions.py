"""The marked actions of recordings, as `actum takes` lists and changes them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import AUTO, MANUAL, Action, Event, Message, Segment, Truth
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.rewriting import Change
from actum_model_trainer.recorded_segments import classifier_input, closed_segments, sensors, why_unusable
from som_classifier.segments import ClosedSegment

Edit = Callable[[Segment | Action | Event | Truth], Message | None]
"""Returns the message to store in place of one that names the segment, or None to leave it out."""


@dataclass(frozen=True)
class MarkedAction:
    """One marked action: its number of valid frames, and why it cannot be trained on, None where it can."""

    segment_id: str
    label: str | None
    duration_s: float
    frames: int
    problem: str | None


def marked_actions(recording: Recording) -> Iterator[MarkedAction]:
    """Yield a recording's marked actions as training would get them.

    Raises:
        RecordingError: the file is damaged.
    """
    for sensor in sensors(recording):
        for closed in closed_segments(classifier_input(recording, sensor)):
            yield MarkedAction(
                closed.segment_id,
                closed.label,
                (closed.end_ns - closed.start_ns) / SECOND_NS,
                sum(frame.valid for frame in closed.frames),
                _problem(closed),
            )


def bounds_ns(recording: Recording, segment_id: str) -> tuple[int | None, int | None]:
    """Return the stamps of a segment's first start and end mark, None for one that is not there."""
    stamps_ns: dict[str, int] = {}
    for mark in recording.messages((keys.SEGMENT,)):
        if isinstance(mark, Segment) and mark.segment_id == segment_id and mark.stamp_ns is not None:
            stamps_ns.setdefault(mark.kind, mark.stamp_ns)
    return stamps_ns.get("start"), stamps_ns.get("end")


def relabelled(segment_id: str, label: str) -> Change:
    """Return the change that gives a segment another label; one that a classifier found is then the user's."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        named = {"label": label} if message.kind == "start" else {}
        return _mended(message, named)

    return _of_segment(segment_id, edit)


def trimmed(segment_id: str, later_start_ns: int, later_end_ns: int) -> Change:
    """Return the change that shifts a segment's start and end mark (ns, positive is later); recorded answers stay."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        assert message.stamp_ns is not None
        later_ns = later_start_ns if message.kind == "start" else later_end_ns
        return _mended(message, {"stamp_ns": message.stamp_ns + later_ns})

    return _of_segment(segment_id, edit)


def _mended(mark: Segment, update: dict[str, Any]) -> Segment:
    """Return a mark as somebody has mended it: one of a classifier's is then that person's."""
    origin = {"origin": MANUAL} if mark.origin == AUTO else {}
    changed = update | origin
    return mark.model_copy(update=changed) if changed else mark


def dropped(segment_id: str) -> Change:
    """Return the change that leaves out a segment's marks, its answers and its ground truth."""
    return _of_segment(segment_id, lambda _: None)


def _of_segment(segment_id: str, edit: Edit) -> Change:
    """Return the change that edits the messages that name a segment, and no others."""

    def change(stored: StoredMessage) -> StoredMessage | None:
        message = _message(stored)
        if not isinstance(message, Segment | Action | Event | Truth) or message.segment_id != segment_id:
            return stored
        edited = edit(message)
        if edited is None or edited is message:
            return None if edited is None else stored
        return replace(stored, payload=codec.encode(edited).payload, publish_ns=edited.stamp_ns)

    return change


def _message(stored: StoredMessage) -> Message | None:
    """Decode a message that may name a segment, None for any other. A mark without a stamp gets that of its storage."""
    try:
        if keys.parse(stored.key).topic not in (keys.SEGMENT, keys.ACTION, keys.EVENT, keys.TRUTH):
            return None
        message = codec.decode(stored.key, stored.payload, stored.encoding)
    except (keys.InvalidKeyError, codec.DecodeError):
        return None
    return message if message.stamp_ns is not None else message.model_copy(update={"stamp_ns": stored.publish_ns})


def _problem(closed: ClosedSegment) -> str | None:
    """Return why a segment cannot be trained on, None where it can."""
    problem = why_unusable(closed)
    return "no label" if problem is None and closed.label is None else problem
