"""Messages as browsers read them: JSON text, and images as a JSON header with the picture's bytes behind it."""

from typing import Any

from pydantic_core import to_json

from actum import keys
from actum.messages import Action, Event, HeldBack, Image, Message, Segment, Status, Training
from web_dashboard.hub import Envelope

LENGTH_BYTES = 4
"""Bytes of the header's length, little-endian, at the beginning of a binary payload."""


def envelope_of(message: Message) -> Envelope:
    """Encode a message; its `type` is the topic without the agent or service, such as `image/color`."""
    address = keys.address_of(message)
    kind = address.topic.leaf.removesuffix("/{}")
    stream = kind if address.name is None else f"{kind}/{address.name}"
    if isinstance(message, Image):
        header = text(type=kind, **message.model_dump(exclude={"data"})).encode()
        length = len(header).to_bytes(LENGTH_BYTES, "little")
        return Envelope(stream, length + header + message.data)
    queued = isinstance(message, Segment | Event | HeldBack) or (isinstance(message, Action) and message.final)
    kept = isinstance(message, Status | Training)
    return Envelope(stream, text(type=kind, **message.model_dump()), queued, kept)


def text(**fields: Any) -> str:
    """Return fields as JSON: NaN as null, bytes in base64."""
    return to_json(fields, inf_nan_mode="null", bytes_mode="base64").decode()
