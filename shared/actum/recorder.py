"""Writes recordings: MCAP files whose channels are Zenoh keys, and whose messages are the payloads put on them.

`publish_time` is a message's stamp, `log_time` the time of its receipt, `sequence` its number on its key. A metadata
record `actum.recording` holds `person`, `source` and free fields.
"""

import os
from contextlib import suppress
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.writer import Writer

from actum import codec, schemas
from actum.atomic_file import UNFINISHED, store_names
from actum.messages import Message
from actum.node import Numbering

METADATA = "actum.recording"
"""The name of the metadata record."""
MESSAGE_ENCODING = "msgpack"
"""MCAP's name for the encoding of the messages."""
SCHEMA_ENCODING = "jsonschema"
"""MCAP's name for the encoding of the schemas."""
CHUNK_BYTES = 256 * 1024
"""Size of an MCAP chunk: a crash loses at most one, about three seconds of a skeleton stream."""
SEQUENCE_MODULUS = 2**32
"""MCAP's message numbers have 32 bits."""


class Recorder:
    """Writes a recording. The file carries the suffix `.part` until it is closed, and is readable up to a crash.

    Where an exception ends the `with` block the file keeps the suffix.
    """

    _chunk_bytes: int | None = CHUNK_BYTES

    def __init__(self, path: Path, *, person: str, source: str, **fields: str) -> None:
        self.path = path
        self._part = path.with_name(path.name + UNFINISHED)
        self._numbering = Numbering()
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = self._part.open("wb")
        chunked = self._chunk_bytes is not None
        self._writer = Writer(self._file, chunk_size=self._chunk_bytes or 0, use_chunking=chunked)
        self._writer.start()
        self._writer.add_metadata(METADATA, {"person": person, "source": source, **fields})

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._finish()

    def close(self) -> None:
        """Finish the file, have it stored and remove the suffix `.part` from its name."""
        self._finish()
        self._part.replace(self.path)
        store_names(self.path.parent)

    def discard(self) -> None:
        """Drop the file, whether it is finished or not."""
        with suppress(OSError):  # a full disk, which no longer matters
            self._file.close()
        self._part.unlink(missing_ok=True)
        self.path.unlink(missing_ok=True)

    def write(self, message: Message, log_time_ns: int | None = None) -> None:
        """Store one message, numbered on its key where it has no number.

        Raises:
            ValueError: the message is a mark without a stamp.
        """
        if message.stamp_ns is None:
            raise ValueError(f"a recorded message needs its stamp: {message!r}")
        numbered = self._numbering.numbered(message)
        frame = codec.encode(numbered)
        assert numbered.seq is not None
        self._writer.add_message(
            channel_id=self._channel(frame, message),
            log_time=message.stamp_ns if log_time_ns is None else log_time_ns,
            data=frame.payload,
            publish_time=message.stamp_ns,
            sequence=numbered.seq % SEQUENCE_MODULUS,
        )

    def _channel(self, frame: codec.Frame, message: Message) -> int:
        if frame.key not in self._channels:
            self._channels[frame.key] = self._writer.register_channel(
                frame.key, MESSAGE_ENCODING, self._schema(message), {"encoding": frame.encoding}
            )
        return self._channels[frame.key]

    def _schema(self, message: Message) -> int:
        name = codec.schema_name(message)
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(name, SCHEMA_ENCODING, json_schema(type(message)))
        return self._schemas[name]

    def _finish(self) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.flush()
        os.fsync(self._file.fileno())
        self._file.close()


class StoredRecorder(Recorder):
    """Writes a recording of rare messages: each by itself, so that a crash loses none that `store` was called after."""

    _chunk_bytes = None

    @property
    def size_bytes(self) -> int:
        """How long the file is so far."""
        return self._file.tell()

    def store(self) -> None:
        """Have stored on the disk what was written.

        Raises:
            OSError: the disk does not take it.
        """
        self._file.flush()
        os.fsync(self._file.fileno())

    def abandon(self) -> None:
        """Leave the file as it is, unfinished: the disk takes no more."""
        with suppress(OSError):
            self._file.close()


@cache
def json_schema(kind: type[Message]) -> bytes:
    """Return the JSON Schema that stands in a recording beside messages of a kind."""
    return schemas.committed(schemas.file_name(kind)).encode()
