"""Serves messages to Foxglove over a WebSocket, or writes them to a file that it opens."""

import json
import logging
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import foxglove
from foxglove.messages import FrameTransforms
from pydantic_core import to_json

from actum import schemas
from actum.atomic_file import created
from actum.codec import schema_name
from actum.messages import Message
from actum.recorder import METADATA
from actum_command.viewers.foxglove_messages import CONTENTS, TRANSFORMS, FoxgloveMessages, below
from actum_command.viewers.foxglove_server import Channel, FoxgloveServer
from web_dashboard.admission import FORBIDDEN, MISDIRECTED, Rule
from web_dashboard.server import PageServer, socket_at

log = logging.getLogger("actum")

ADVICE = {FORBIDDEN: "use --origin to admit it", MISDIRECTED: "open the printed address"}
"""What to do where somebody is refused wrongly."""
Log = Callable[[bytes, int], object]
"""Puts a payload with its time (ns) on a channel."""
Schema = dict[str, Any]
"""A JSON Schema."""
KEPT = ("title", "description", "type")
"""What is taken over of each part as it is."""


class FoxgloveStream:
    """Puts messages on channels, at their stamps.

    The topics of `sensors` are there from the start, so that a client has subscribed before the first message.
    """

    def __init__(self, opened: Callable[[Channel], Log], sensors: Sequence[str] = ()) -> None:
        self._opened = opened
        self._messages = FoxgloveMessages()
        self._channels: dict[tuple[str, type], Log] = {}
        if sensors:
            self._channel(TRANSFORMS, FrameTransforms)
        for sensor in sensors:
            for leaf, kind in CONTENTS.items():
                self._channel(below(sensor, leaf), kind)

    def show(self, message: Message) -> None:
        """Log one message."""
        for put in self._messages.of(message):
            put_on = self._channel(put.topic, type(put.content))
            if put.content is message:  # as `actum watch --json` writes it: Foxglove reads URL-safe base64, too
                payload = to_json(message.model_dump(), bytes_mode="base64", inf_nan_mode="null")
            else:
                payload = put.content.encode()
            put_on(payload, message.stamp_ns)

    def _channel(self, topic: str, kind: type) -> Log:
        """Return the channel of a topic: one of Foxglove's own kinds, or of JSON with the schema of our message."""
        if (topic, kind) not in self._channels:
            self._channels[topic, kind] = self._opened(_described(topic, kind))
        return self._channels[topic, kind]


def _described(topic: str, kind: Any) -> Channel:
    if issubclass(kind, Message):
        schema = foxglove_schema(kind)
        return Channel(topic, "json", schema["title"], "jsonschema", json.dumps(schema).encode())
    own = kind.get_schema()
    return Channel(topic, own.encoding, own.name, own.encoding, own.data)


class ServerError(RuntimeError):
    """The server cannot be started; the text says why and what to do."""


@contextmanager
def served(
    sensors: Sequence[str],
    host: str,
    port: int,
    subscribed: threading.Event,
    origins: Sequence[str] = (),
    refused: Callable[[str], object] = lambda _: None,
) -> Iterator[tuple[FoxgloveStream, str]]:
    """Return a context in which messages are served, with the address; `subscribed` is set with the first subscriber.

    Programs may connect, and pages of the sites `origins`; `refused` is called with a line for each other one.

    Raises:
        ServerError: the address cannot be bound.
    """
    server = FoxgloveServer(subscribed)
    stream = FoxgloveStream(server.open, sensors)
    try:
        listening = socket_at(host, port)
    except OSError as error:
        raise ServerError(
            f"the Foxglove server cannot listen on {host}:{port} ({error}): choose another --port or --host"
        ) from None
    serving = PageServer(server.application(Rule(host, origins=origins, advice=ADVICE), refused), listening, host)
    with serving.serving():
        yield stream, serving.address.replace("http://", "ws://").rstrip("/")
    if server.left_out:
        log.warning(
            "%d messages were dropped, because Foxglove clients were too slow to receive them: close some panels in "
            "these clients, or use a faster network",
            server.left_out,
        )


@contextmanager
def written(path: Path, metadata: dict[str, str]) -> Iterator[FoxgloveStream]:
    """Return a context in which messages are written to an MCAP file that Foxglove opens.

    The file appears once it is complete.

    Raises:
        FileExistsError: there is a file of that name.
        OSError: it cannot be written.
    """
    context = foxglove.Context()
    path.parent.mkdir(parents=True, exist_ok=True)
    with created(path) as file, foxglove.open_mcap(file, context=context) as writer:
        writer.write_metadata(METADATA, metadata)

        def opened(channel: Channel) -> Log:
            schema = foxglove.Schema(name=channel.schema_name, encoding=channel.schema_encoding, data=channel.schema)
            own = foxglove.Channel(channel.topic, schema=schema, message_encoding=channel.encoding, context=context)
            return lambda payload, time_ns: own.log(payload, log_time=time_ns)

        yield FoxgloveStream(opened)


def foxglove_schema(kind: type[Message]) -> Schema:
    """Return the JSON Schema of a kind of message, under its name on the wire, in the subset that Foxglove reads.

    Foxglove's reader (`parseJsonSchema` in its open sources) takes a plain type for each field: no `$ref`, no `anyOf`,
    no object without `properties`. What may be null is declared as what it is otherwise; values are not checked.
    """
    given = json.loads(schemas.committed(schemas.file_name(kind)))
    return {**_plain(given, given.get("$defs", {})), "title": schema_name(kind)}


def _plain(part: Schema, definitions: Mapping[str, Schema]) -> Schema:
    """Return a part with references put in, alternatives to null chosen, and without limits."""
    while "$ref" in part or "anyOf" in part:
        part = _meant(part, definitions)
    plain = {key: part[key] for key in KEPT if key in part}
    if part["type"] == "object":
        plain["properties"] = {name: _plain(field, definitions) for name, field in part.get("properties", {}).items()}
    elif part["type"] == "array":
        plain["items"] = _plain(part["items"], definitions)
    elif part.get("format") == "binary":
        plain["contentEncoding"] = "base64"
    return plain


def _meant(part: Schema, definitions: Mapping[str, Schema]) -> Schema:
    """Return what a part refers to, or which alternative to null it names, under the part's own title."""
    own = {key: value for key, value in part.items() if key not in ("$ref", "anyOf")}
    if "$ref" in part:
        return {**definitions[part["$ref"].rpartition("/")[2]], **own}
    [meant] = [alternative for alternative in part["anyOf"] if alternative.get("type") != "null"]
    return {**meant, **own}
