"""Serves messages to Foxglove over a WebSocket, or writes them to a file that it opens."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import foxglove
from foxglove import channels
from foxglove.messages import FrameTransforms
from foxglove.websocket import ServerListener
from pydantic_core import to_json

from actum.atomic_file import created
from actum.messages import Message
from actum.recorder import METADATA
from actum_command.viewers.foxglove_messages import CONTENTS, TRANSFORMS, FoxgloveMessages, below
from actum_command.viewers.foxglove_schemas import foxglove_schema


class FoxgloveStream:
    """Logs messages to all that listen to a context of Foxglove's, at their stamps.

    The topics of `sensors` are there from the start, so that a client has subscribed before the first message.
    """

    def __init__(self, context: foxglove.Context, sensors: Sequence[str] = ()) -> None:
        self._context = context
        self._messages = FoxgloveMessages()
        self._channels: dict[tuple[str, type], Any] = {}
        if sensors:
            self._channel(TRANSFORMS, FrameTransforms)
        for sensor in sensors:
            for leaf, kind in CONTENTS.items():
                self._channel(below(sensor, leaf), kind)

    def show(self, message: Message) -> None:
        """Log one message."""
        for put in self._messages.of(message):
            channel = self._channel(put.topic, type(put.content))
            channel.log(_as_json(message) if put.content is message else put.content, log_time=message.stamp_ns)

    def _channel(self, topic: str, kind: type) -> Any:
        """Return the channel of a topic: one of Foxglove's own kinds, or of JSON with the schema of our message."""
        if (topic, kind) not in self._channels:
            self._channels[topic, kind] = (
                foxglove.Channel(topic, schema=foxglove_schema(kind), context=self._context)
                if issubclass(kind, Message)
                else getattr(channels, f"{kind.__name__}Channel")(topic, context=self._context)
            )
        return self._channels[topic, kind]


def _as_json(message: Message) -> bytes:
    """Write a message as `actum watch --json` does: bytes as URL-safe base64, which Foxglove reads, too."""
    return to_json(message.model_dump(), bytes_mode="base64", inf_nan_mode="null")


class _FirstSubscriber(ServerListener):  # type: ignore[misc]  # the package may be absent
    """Sets a flag once somebody subscribes to anything."""

    def __init__(self, subscribed: threading.Event) -> None:
        self._subscribed = subscribed

    def on_subscribe(self, client: Any, channel: Any) -> None:
        self._subscribed.set()


class ServerError(RuntimeError):
    """The server cannot be started; the text says why and what to do."""


@contextmanager
def served(
    sensors: Sequence[str], host: str, port: int, subscribed: threading.Event
) -> Iterator[tuple[FoxgloveStream, str]]:
    """Return a context in which messages are served, with the address; `subscribed` is set with the first subscriber.

    Raises:
        ServerError: the address cannot be bound.
    """
    context = foxglove.Context()
    stream = FoxgloveStream(context, sensors)
    try:
        server = foxglove.start_server(
            name="actum", host=host, port=port, context=context, server_listener=_FirstSubscriber(subscribed)
        )
    except (RuntimeError, OSError, ValueError) as error:
        raise ServerError(f"{host}:{port} cannot be served ({error}): name another --port or --host") from None
    try:
        yield stream, f"ws://{host}:{server.port}"
    finally:
        server.stop()


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
        yield FoxgloveStream(context)
