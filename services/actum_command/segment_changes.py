"""What `actum takes` and `actum label` change in the marks of a recording: a segment's label or its bounds."""

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

from actum import codec, keys
from actum.mcap_file import StoredMessage
from actum.messages import AUTO, MANUAL, Action, Event, Message, Segment, Truth
from actum.rewriting import Change

Edit = Callable[[Segment | Action | Event | Truth], Message | None]
"""Returns the message to store in place of one that names the segment, or None to leave it out."""


def relabelled(segment_id: str, label: str) -> Change:
    """Return the change that gives a segment another label; one that a classifier found is then the user's."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        named = {"label": label} if message.kind == "start" else {}
        return _mended(message, named)

    return _of_segments([segment_id], edit)


def moved(segment_id: str, later_start_ns: int, later_end_ns: int) -> Change:
    """Return the change that shifts a segment's start and end mark (ns, positive is later); recorded answers stay."""

    def edit(message: Message) -> Message:
        if not isinstance(message, Segment):
            return message
        assert message.stamp_ns is not None
        later_ns = later_start_ns if message.kind == "start" else later_end_ns
        return _mended(message, {"stamp_ns": message.stamp_ns + later_ns})

    return _of_segments([segment_id], edit)


def _mended(mark: Segment, update: dict[str, Any]) -> Segment:
    """Return a mark as somebody has mended it: one of a classifier's is then that person's."""
    origin = {"origin": MANUAL} if mark.origin == AUTO else {}
    changed = update | origin
    return mark.model_copy(update=changed) if changed else mark


def _of_segments(segment_ids: Collection[str], edit: Edit) -> Change:
    """Return the change that edits the messages that name one of these segments, and no others."""

    def change(stored: StoredMessage) -> StoredMessage | None:
        message = _message(stored)
        if not isinstance(message, Segment | Action | Event | Truth) or message.segment_id not in segment_ids:
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
