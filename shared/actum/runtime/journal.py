"""The last answers of a service in a small file, so that a process started in its place gives no others.

The file is records one after the other: magic, length and checksum, then a body in msgpack. The first record says when
the journal was begun. A record is written before its answer is put: an answer that anybody has seen stands here.
"""

import struct
import time
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import msgpack

from actum.atomic_file import write_whole
from actum.codec import UNPACK_ERRORS, Frame

MAGIC = b"act\x01"
"""The first bytes of a record: by them reading goes on behind a damaged one."""
HEAD = struct.Struct("<4sII")
"""What stands before a body: magic, the body's length (bytes), its CRC-32."""
KEPT_S = 600.0
"""How old an answer may be to be kept when the file is written anew (s): older marks are asked for by nobody."""
MOST_BYTES = 8_000_000
"""Most bytes kept then, the newest: some hundred answers with maps, many thousands without."""
ROOM_BYTES = 8_000_000
"""The file is written anew once it has grown by this much."""


@dataclass(frozen=True)
class WrittenAnswer:
    """An encoded answer, and when it was given: the machine's clock, ns since 1970."""

    given_ns: int
    frame: Frame


class Journal:
    """The answers of one service, read when it starts and added to while it runs; not thread-safe.

    What is damaged is left out: the end that a killed process has not written, a record whose checksum is wrong.

    Attributes:
        is_new: whether there was no file, so that nobody knows what was answered before.
        answers: what was read, the oldest first.

    Raises:
        OSError: the file cannot be read or written.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        path.parent.mkdir(parents=True, exist_ok=True)
        self.is_new = not path.exists()
        found = [] if self.is_new else list(_records(path.read_bytes()))
        self._begun_ns = next((body for body in found if isinstance(body, int)), time.time_ns())
        self.answers = _kept(body for body in found if isinstance(body, WrittenAnswer))
        self._file = self._rewritten(self.answers)

    @property
    def age_s(self) -> float:
        """How long ago the journal was begun (s): all answers since then stand in it, as far as they are kept."""
        return max(time.time_ns() - self._begun_ns, 0) / 1e9

    def add(self, frame: Frame) -> None:
        """Write down an answer that is about to be put.

        Raises:
            OSError: it cannot be written.
        """
        self._file.write(_record(WrittenAnswer(time.time_ns(), frame)))
        if self._file.tell() > self._full_bytes:
            self._file.close()
            self._file = self._rewritten(_kept(_answers(self._path.read_bytes())))

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def _rewritten(self, answers: list[WrittenAnswer]) -> BinaryIO:
        """Write the file anew with these answers, and open it to add others."""
        write_whole(self._path, b"".join([_record(self._begun_ns), *map(_record, answers)]))
        file = self._path.open("ab", buffering=0)
        self._full_bytes = file.tell() + ROOM_BYTES
        return file


def _kept(answers: Iterator[WrittenAnswer]) -> list[WrittenAnswer]:
    """Return those that are young enough, the newest that have room, in their order."""
    now_ns = time.time_ns()
    kept: list[WrittenAnswer] = []
    size = 0
    for answer in reversed(list(answers)):
        size += len(answer.frame.payload)
        if size > MOST_BYTES:
            break
        if abs(now_ns - answer.given_ns) <= KEPT_S * 1e9:
            kept.append(answer)
    return kept[::-1]


def _record(content: WrittenAnswer | int) -> bytes:
    """Pack an answer, or the time at which the journal was begun."""
    if isinstance(content, WrittenAnswer):
        frame = content.frame
        body = msgpack.packb([content.given_ns, frame.key, frame.payload, frame.encoding, frame.attachment])
    else:
        body = msgpack.packb([content])
    return HEAD.pack(MAGIC, len(body), zlib.crc32(body)) + bytes(body)


def _answers(content: bytes) -> Iterator[WrittenAnswer]:
    return (body for body in _records(content) if isinstance(body, WrittenAnswer))


def _records(content: bytes) -> Iterator[WrittenAnswer | int]:
    """Yield what the sound records of a file hold; after a damaged one go on at the next magic."""
    at = content.find(MAGIC)
    while at >= 0:
        record = _read(content, at)
        if record is None:
            at = content.find(MAGIC, at + 1)
            continue
        yield record[0]
        at = content.find(MAGIC, record[1])


def _read(content: bytes, at: int) -> tuple[WrittenAnswer | int, int] | None:
    """Return what the record at an offset holds, and the offset behind it; None where it is damaged."""
    begin = at + HEAD.size
    if begin > len(content):
        return None
    _, length, checksum = HEAD.unpack_from(content, at)
    body = content[begin : begin + length]
    if len(body) < length or zlib.crc32(body) != checksum:
        return None
    try:
        given_ns, *frame = msgpack.unpackb(body)
        return (WrittenAnswer(given_ns, Frame(*frame)) if frame else given_ns), begin + length
    except UNPACK_ERRORS:
        return None
