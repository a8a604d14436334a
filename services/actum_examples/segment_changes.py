"""What `actum takes` and `actum label` change in the marks of a recording: a segment's label or its bounds."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from actum import codec
from actum.mcap_file import StoredMessage
from actum.messages import AUTO, MANUAL, Message, Segment
from actum.rewriting import Change
from actum_examples.edits import NAMING, Naming, decoded
from actum_examples.marked_segments import LabelledSegment

Edit = Callable[[Naming], Message]
"""Returns the message to store in place of one that names the segment."""


def relabelled(segment: LabelledSegment, label: str) -> Change:
    """Return the change that gives a segment another label; one that a classifier found is then the user's."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        named = {"label": label} if message.kind == "start" else {}
        return _mended(message, named)

    return _of_segment(segment, edit)


def moved(segment: LabelledSegment, later_start_ns: int, later_end_ns: int) -> Change:
    """Return the change that shifts a segment's start and end mark (ns, positive is later); recorded answers stay."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        assert message.stamp_ns is not None
        later_ns = later_start_ns if message.kind == "start" else later_end_ns
        return _mended(message, {"stamp_ns": message.stamp_ns + later_ns})

    return _of_segment(segment, edit)


def _mended(mark: Segment, update: dict[str, Any]) -> Segment:
    """Return a mark as somebody has mended it: one of a classifier's is then that person's."""
    origin = {"origin": MANUAL} if mark.origin == AUTO else {}
    changed = update | origin
    return mark.model_copy(update=changed) if changed else mark


def _of_segment(segment: LabelledSegment, edit: Edit) -> Change:
    """Return the change that edits the messages that name a segment, and no others."""

    def change(stored: StoredMessage) -> StoredMessage | None:
        message = decoded(stored, NAMING)
        if not isinstance(message, Naming) or not segment.has(message):
            return stored
        edited = edit(message)
        return (
            stored
            if edited is message
            else replace(stored, payload=codec.encode(edited).payload, publish_ns=edited.stamp_ns)
        )

    return change
