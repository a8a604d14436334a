"""Rewrites a recording with some messages changed, left out or added; all other records are copied unchanged."""

import os
import shutil
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import BinaryIO

from mcap.records import Attachment, Channel, Header, McapRecord, Message, Metadata, Schema
from mcap.writer import Writer

from actum import codec, messages
from actum.atomic_file import UNFINISHED, claim, created, replaced
from actum.mcap_file import AGAIN, McapFile, RecordingError, StoredMessage, encoding_of
from actum.recorder import CHUNK_BYTES, MESSAGE_ENCODING, METADATA, SCHEMA_ENCODING, TakenError, json_schema, unfinished

Change = Callable[[StoredMessage], StoredMessage | None]
"""Returns the message to write in place of the given one (only payload and stamp count), or None to leave it out."""


def unchanged(stored: StoredMessage) -> StoredMessage:
    """Return the message as it is: the change that changes nothing."""
    return stored


def rewrite(
    path: Path,
    change: Change,
    added: Iterable[messages.Message] = (),
    metadata: Mapping[str, str] | None = None,
) -> None:
    """Write the changed recording to a temporary file beside it, which replaces it once complete.

    Args:
        path: the recording.
        change: what becomes of each message.
        added: messages with stamps, written behind all others; readers sort by stamp.
        metadata: fields of the recording's metadata that get another value.

    Raises:
        RecordingError: the file is no recording, damaged, or not finished: whoever writes it would go on in vain.
        OSError: the temporary file cannot be written. In either case the recording is left as it was.
    """
    target = path.resolve()
    if target.suffix == UNFINISHED:
        name = path.with_suffix("")
        raise RecordingError(
            path, "the recording is unfinished", f"finish the recording with 'actum record {name} --finish'"
        )
    with replaced(target) as file:
        _copy(McapFile(path), file, change, added, metadata or {})
        shutil.copymode(target, file.name)


def finish(path: Path) -> int:
    """Make a recording of what a process that has ended left unfinished; return how many messages it holds.

    Raises:
        FileNotFoundError: nothing unfinished is there.
        TakenError: it is still being written, or another recording has the name.
        RecordingError: nothing can be read from it, or it is damaged.
        OSError: the recording cannot be written. In either case what is there is left as it was.
    """
    part = unfinished(path)
    with part.open("r+b") as claimed:  # to write, or a network file system gives no lock
        if not claim(claimed) or not os.path.samestat(os.fstat(claimed.fileno()), part.stat()):
            raise TakenError(
                part, f"another process is writing {part}: wait until that process ends, or stop that process"
            )
        if os.path.lexists(path):
            raise TakenError(
                path, f"{path} already exists, so {part} cannot be renamed to {path}: rename one of the two files"
            )
        with created(path) as file:
            count = _copy(McapFile(part), file, unchanged, (), {})
            shutil.copymode(part, file.name)
        part.unlink()
    return count


def _copy(
    source: McapFile, file: BinaryIO, change: Change, added: Iterable[messages.Message], metadata: Mapping[str, str]
) -> int:
    """Write the changed recording to a file; return how many messages of it are kept."""
    writer = Writer(file, chunk_size=CHUNK_BYTES)
    copying = _Copying(writer, change, metadata)
    for record in source.records():
        try:
            copying.receive(record)
        except KeyError as error:
            raise RecordingError(
                source.path,
                f"the recording is damaged (a message belongs to channel {error}, which the file does not describe)",
                AGAIN,
            ) from None
    if metadata and not copying.described:
        writer.add_metadata(METADATA, dict(metadata))
    for message in added:
        copying.add(message)
    writer.finish()  # type: ignore[no-untyped-call]
    return copying.kept


class _Copying:
    """Copies records to the writer. A complete file holds its schemas and channels twice; they are copied once."""

    def __init__(self, writer: Writer, change: Change, metadata: Mapping[str, str]) -> None:
        self._writer = writer
        self._change = change
        self._metadata = metadata
        self._schemas: dict[int, int] = {0: 0}
        self._schema_names: dict[int, str] = {}
        self._channels: dict[int, int] = {}
        self._channel_records: dict[int, Channel] = {}
        self._numbers: Counter[str] = Counter()
        self._new_channels: dict[str, int] = {}
        self.kept = 0
        self.described = False

    def receive(self, record: McapRecord) -> None:
        match record:
            case Header():
                self._writer.start(record.profile)
            case Schema() if record.id not in self._schemas:
                self._schemas[record.id] = self._writer.register_schema(record.name, record.encoding, record.data)
                self._schema_names[record.id] = record.name
            case Channel() if record.id not in self._channels:
                self._channel_records[record.id] = record
                self._channels[record.id] = self._writer.register_channel(
                    record.topic, record.message_encoding, self._schemas.get(record.schema_id, 0), record.metadata
                )
            case Message():
                self._message(record)
            case Metadata():
                changed = self._metadata if record.name == METADATA else {}
                self.described |= record.name == METADATA
                self._writer.add_metadata(record.name, {**record.metadata, **changed})
            case Attachment():
                self._writer.add_attachment(
                    record.create_time, record.log_time, record.name, record.media_type, record.data
                )

    def add(self, message: messages.Message) -> None:
        """Write a message on the channel of its key, a new one where there is none."""
        assert message.stamp_ns is not None
        frame = codec.encode(message)
        self._writer.add_message(
            channel_id=self._channel_of(frame, message),
            log_time=message.stamp_ns,
            data=frame.payload,
            publish_time=message.stamp_ns,
            sequence=self._numbers[frame.key],
        )
        self._numbers[frame.key] += 1

    def _channel_of(self, frame: codec.Frame, message: messages.Message) -> int:
        for number, channel in self._channel_records.items():
            if channel.topic == frame.key and channel.metadata.get("encoding") == frame.encoding:
                return self._channels[number]
        if frame.key not in self._new_channels:
            name = codec.schema_name(message)
            schema = self._writer.register_schema(name, SCHEMA_ENCODING, json_schema(type(message)))
            self._new_channels[frame.key] = self._writer.register_channel(
                frame.key, MESSAGE_ENCODING, schema, {"encoding": frame.encoding}
            )
        return self._new_channels[frame.key]

    def _message(self, record: Message) -> None:
        channel = self._channel_records[record.channel_id]
        self._numbers[channel.topic] = max(self._numbers[channel.topic], record.sequence + 1)
        encoding = encoding_of(channel, self._schema_names.get(channel.schema_id, ""))
        changed = self._change(StoredMessage(record.publish_time, channel.topic, record.data, encoding))
        if changed is not None:
            self.kept += 1
            self._writer.add_message(
                channel_id=self._channels[record.channel_id],
                log_time=record.log_time,
                data=changed.payload,
                publish_time=changed.publish_ns,
                sequence=record.sequence,
            )
