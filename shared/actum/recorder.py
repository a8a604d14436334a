"""Writes recordings: MCAP files whose channels are Zenoh keys, and whose messages are the payloads put on them.

`publish_time` is a message's stamp, `log_time` the time of its receipt, `sequence` its number on its key. A metadata
record `actum.recording` holds `person`, `source` and free fields.
"""

import errno
import os
from collections.abc import Iterable
from contextlib import suppress
from datetime import datetime
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.writer import Writer

from actum import codec, schemas
from actum.atomic_file import UNFINISHED, claim, give_name
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


class TakenError(FileExistsError):
    """A name under which a recording lies already, finished or not; the text says which and what to do."""

    def __init__(self, path: Path, text: str) -> None:
        super().__init__(errno.EEXIST, text, str(path))

    def __str__(self) -> str:
        return str(self.strerror)


def unfinished(path: Path) -> Path:
    """Return the name that a recording has until it is finished."""
    return path.with_name(path.name + UNFINISHED)


def refuse_taken(path: Path) -> None:
    """Refuse to write a recording where one lies, finished or not.

    Raises:
        TakenError: there is one.
    """
    part = unfinished(path)
    if os.path.lexists(path):
        raise TakenError(path, f"{path} already exists: name another file, or remove the existing file")
    if not os.path.lexists(part):
        return
    stat = part.lstat()
    size, written = f"{stat.st_size / 1e6:.1f} MB", datetime.fromtimestamp(stat.st_mtime).strftime("%Y-%m-%d %H:%M:%S")
    remedy = (
        "another process is writing it: name another file"
        if is_being_written(part)
        else f"turn it into a recording with 'actum record {path} --finish', or remove it"
    )
    raise TakenError(part, f"{part} is an unfinished recording ({size}, last written {written}): {remedy}")


def is_being_written(part: Path) -> bool:
    """Tell whether a process, on this machine or another that can lock files here, is writing an unfinished file."""
    try:
        with part.open("r+b") as file:
            return not claim(file)
    except OSError:
        return False


class Recorder:
    """Writes a recording. The file carries the suffix `.part` until it is closed, and is readable up to a crash.

    Where an exception ends the `with` block the file keeps the suffix. Neither a recording nor what is left of one is
    ever overwritten.

    Raises:
        TakenError: a recording lies there, finished or not.
        OSError: the file cannot be written.
    """

    _chunk_bytes: int | None = CHUNK_BYTES

    def __init__(self, path: Path, *, person: str, source: str, **fields: str) -> None:
        self.path = path
        self._numbering = Numbering()
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}
        self._torn = False
        path.parent.mkdir(parents=True, exist_ok=True)
        refuse_taken(path)
        self._lies_at = unfinished(path)
        try:
            self._file = self._lies_at.open("xb")
        except FileExistsError:  # since a moment ago
            refuse_taken(path)
            raise
        claim(self._file)
        try:
            self._begin({"person": person, "source": source, **fields})
        except OSError:
            self.discard()
            raise

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        elif self._torn:
            self.abandon()
        else:
            self._finish()

    def close(self) -> None:
        """Finish the file, have it stored and remove the suffix `.part` from its name.

        Raises:
            FileExistsError: somebody else has put a file there meanwhile; the recording keeps the suffix.
            OSError: it cannot be finished; the recording keeps the suffix.
        """
        self._finish()
        give_name(self._lies_at, self.path)
        self._lies_at = self.path

    def discard(self) -> None:
        """Drop the file, whether it is finished or not."""
        self.abandon()
        self._lies_at.unlink(missing_ok=True)

    def abandon(self) -> None:
        """Leave the file as it is, unfinished: the disk takes no more, and what is written behind a tear is lost."""
        with suppress(OSError):
            self._file.close()

    def write(self, message: Message, log_time_ns: int | None = None) -> None:
        """Store one message, numbered on its key where it has no number.

        Raises:
            ValueError: the message is a mark without a stamp.
            OSError: the disk takes no more; nothing can be written after that.
        """
        if message.stamp_ns is None:
            raise ValueError(
                f"a message without a time stamp cannot be recorded: set stamp_ns of the message {message!r}"
            )
        numbered = self._numbering.numbered(message)
        frame = codec.encode(numbered)
        assert numbered.seq is not None
        try:
            self._writer.add_message(
                channel_id=self._channel(frame, message),
                log_time=message.stamp_ns if log_time_ns is None else log_time_ns,
                data=frame.payload,
                publish_time=message.stamp_ns,
                sequence=numbered.seq % SEQUENCE_MODULUS,
            )
        except OSError:
            self._torn = True
            raise

    def _begin(self, metadata: dict[str, str]) -> None:
        """Write what stands before the first message: who reads the file meanwhile finds a recording."""
        chunked = self._chunk_bytes is not None
        self._writer = Writer(self._file, chunk_size=self._chunk_bytes or 0, use_chunking=chunked)
        self._writer.start()
        self._writer.add_metadata(METADATA, metadata)
        self._file.flush()

    def _channel(self, frame: codec.Frame, message: Message) -> int:
        if frame.key not in self._channels:
            schema = codec.schema_name(message)
            if schema not in self._schemas:
                json_text = json_schema(type(message))
                self._schemas[schema] = self._writer.register_schema(schema, SCHEMA_ENCODING, json_text)
            self._channels[frame.key] = self._writer.register_channel(
                frame.key, MESSAGE_ENCODING, self._schemas[schema], {"encoding": frame.encoding}
            )
        return self._channels[frame.key]

    def _finish(self) -> None:
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
        except OSError:
            self.abandon()
            raise


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


def write_recording(path: Path, messages: Iterable[Message], *, person: str, source: str, **fields: str) -> None:
    """Write a recording as a whole, or leave nothing: one that can be made again.

    Raises:
        TakenError: a recording lies there, finished or not.
        OSError: the file cannot be written.
    """
    recorder = Recorder(path, person=person, source=source, **fields)
    try:
        for message in messages:
            recorder.write(message)
        recorder.close()
    except BaseException:
        recorder.discard()
        raise


@cache
def json_schema(kind: type[Message]) -> bytes:
    """Return the JSON Schema that stands in a recording beside messages of a kind."""
    return schemas.committed(schemas.file_name(kind)).encode()
