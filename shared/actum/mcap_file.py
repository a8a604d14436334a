"""Reads MCAP files of any origin, also truncated and damaged ones: metadata, and messages in the order of the file."""

import os
import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO, cast

import lz4.frame
import zstandard
from mcap.exceptions import EndOfFile, McapError
from mcap.records import Channel, Chunk, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.writer import MCAP0_MAGIC

DAMAGE = (McapError, zstandard.ZstdError, ValueError, OverflowError, RuntimeError, KeyError, struct.error, MemoryError)
"""What the library and its decompressors raise on bytes that are not valid MCAP."""

LARGEST_CHUNK = 80_000_000
"""Largest chunk once decompressed, and largest other record (bytes): an image of the largest size, and other messages.
A recording's own chunks hold a quarter of a megabyte, or one image."""
MOST_INFLATION = 5000
"""How many times its size a file may grow by decompression: recordings do twenty times, raw black images two thousand.
Files made to fill memory and time do more."""

REMEDY = "give a recording made by `actum record` or `actum import`"
"""What to do about a file that cannot be used."""
AGAIN = "record or import the recording again"
"""What to do about a damaged file."""


class RecordingError(ValueError):
    """A file that is no usable recording; the text names the file, the problem and what to do."""

    def __init__(self, path: Path, problem: str, remedy: str) -> None:
        super().__init__(f"{path}: {problem}; {remedy}")
        self.path = path
        self.problem = problem


@dataclass(frozen=True)
class StoredMessage:
    """A message of the file, not decoded."""

    publish_ns: int
    key: str
    payload: bytes
    encoding: str


class McapFile:
    """An MCAP file, read from its start on each pass. `truncated` tells whether a pass found that it breaks off."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.truncated = False

    def metadata(self, name: str) -> dict[str, str]:
        """Return the first metadata record of that name; empty where there is none.

        Raises:
            RecordingError: the file cannot be opened, is no MCAP, or is damaged.
        """
        for record in self.records():
            if isinstance(record, Metadata) and record.name == name:
                return dict(record.metadata)
        return {}

    def stored(self) -> Iterator[StoredMessage]:
        """Yield the messages in the order of the file, up to its end or to where it breaks off.

        Raises:
            RecordingError: as `metadata`.
        """
        schemas: dict[int, str] = {}
        channels: dict[int, Channel] = {}
        for record in self.records():
            match record:
                case Schema():
                    schemas[record.id] = record.name
                case Channel():
                    channels[record.id] = record
                case Message():
                    channel = channels.get(record.channel_id)
                    if channel is None:
                        problem = f"a message belongs to channel {record.channel_id}, which the file does not describe"
                        raise RecordingError(self.path, f"the recording is damaged ({problem})", AGAIN)
                    encoding = encoding_of(channel, schemas.get(channel.schema_id, ""))
                    yield StoredMessage(record.publish_time, channel.topic, record.data, encoding)

    def records(self) -> Iterator[McapRecord]:
        """Yield every record of the file, also those inside its chunks, up to its end or to where it breaks off.

        Raises:
            RecordingError: as `metadata`.
        """
        with self._opened() as file:
            source = cast(BinaryIO, _Exact(self.path, file))
            reader = StreamReader(source, emit_chunks=True, validate_crcs=True, record_size_limit=LARGEST_CHUNK)
            chunks = _Chunks(self.path, os.fstat(file.fileno()).st_size)
            try:
                for record in reader.records:
                    yield from chunks.records(record) if isinstance(record, Chunk) else (record,)
            except EndOfFile:
                self.truncated = True
            except RecordingError:
                raise
            except DAMAGE as error:
                problem = f"{type(error).__name__}: {error}"
                raise RecordingError(self.path, f"the recording is damaged ({problem})", AGAIN) from None

    def _opened(self) -> BinaryIO:
        try:
            if self.path.exists() and not (self.path.is_file() or self.path.is_dir()):
                # reading a named pipe would never end
                raise RecordingError(self.path, "the path names a device or a pipe, not a file", REMEDY)
            file = self.path.open("rb")
        except OSError as error:
            raise RecordingError(self.path, f"the file cannot be read ({error.strerror or error})", REMEDY) from None
        if file.read(len(MCAP0_MAGIC)) != MCAP0_MAGIC:
            file.close()
            raise RecordingError(self.path, "the file is not an MCAP file", REMEDY)
        file.seek(0)
        return file


class _Exact:
    """A file of which `read` returns all bytes asked for or raises `EndOfFile`: the library misses short reads."""

    def __init__(self, path: Path, file: BinaryIO) -> None:
        self._path = path
        self._file = file
        self._remaining = os.fstat(file.fileno()).st_size

    def read(self, length: int) -> bytes:
        if length < 0:
            raise RecordingError(
                self._path, f"the recording is damaged (a record has the negative length {length})", AGAIN
            )
        if length > self._remaining:
            raise EndOfFile
        self._remaining -= length
        return self._file.read(length)


class _Chunks:
    """Decompresses the chunks of one pass over a file, and refuses those that grow beyond all measure."""

    def __init__(self, path: Path, file_bytes: int) -> None:
        self._path = path
        self._left = LARGEST_CHUNK + MOST_INFLATION * file_bytes

    def records(self, chunk: Chunk) -> list[McapRecord]:
        """Return the records in a chunk.

        Raises:
            RecordingError: it is too large once decompressed, of another size than it says, or compressed otherwise.
        """
        size = chunk.uncompressed_size
        self._left -= size
        if size > LARGEST_CHUNK or self._left < 0:
            most = min(LARGEST_CHUNK, self._left + size)
            raise RecordingError(
                self._path,
                f"the recording is damaged (a block of {len(chunk.data)} bytes would decompress to {size} bytes, more "
                f"than the {most} bytes that actum allows)",
                REMEDY,
            )
        data = self._decompressed(chunk)
        if len(data) != size:
            raise RecordingError(
                self._path,
                f"the recording is damaged (a block does not decompress to the {size} bytes that the block states)",
                AGAIN,
            )
        return breakup_chunk(replace(chunk, compression="", data=data), validate_crc=True)

    def _decompressed(self, chunk: Chunk) -> bytes:
        """Decompress a chunk, at most a byte more than it says that there is."""
        most = chunk.uncompressed_size + 1
        match chunk.compression:
            case "":
                return chunk.data
            case "zstd":
                with zstandard.ZstdDecompressor().stream_reader(chunk.data) as stream:
                    return stream.read(most)
            case "lz4":
                return bytes(lz4.frame.LZ4FrameDecompressor().decompress(chunk.data, max_length=most))
            case other:
                raise RecordingError(
                    self._path,
                    f"the recording is damaged or is compressed with {other!r}, which actum cannot read",
                    "compress the recording with zstd or lz4",
                )


def encoding_of(channel: Channel, schema: str) -> str:
    """Return the Zenoh encoding of a channel's messages: from our metadata, else from the schema's name."""
    return channel.metadata.get("encoding", f"application/msgpack;{schema}" if schema else "")
