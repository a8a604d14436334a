"""The last answers of a service in a small file, so that a process started in its place gives no others.

The file is records one after the other: magic, length and checksum, then a body in msgpack. The first record says when
the journal was begun. A record is written before its answer is put, and stored on the disk with the next report: a
killed process loses no answer that anybody has seen, a power cut those of the last two seconds. A full file is set
aside, in place of the one before: nothing is read or written anew while a service runs.
"""

import errno
import os
import struct
import threading
import time
import zlib
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import msgpack

from actum.atomic_file import PRIVATE_FOLDER, store_names
from actum.codec import UNPACK_ERRORS, Frame

MAGIC = b"act\x01"
"""The first bytes of a record: by them reading goes on behind a damaged one."""
HEAD = struct.Struct("<4sII")
"""What stands before a body: magic, the body's length (bytes), its CRC-32."""
KEPT_S = 600.0
"""How old an answer that is read may be (s): older marks are asked for by nobody."""
FULL_BYTES = 8_000_000
"""A file of this size is set aside: some hundred answers with maps, many thousands without."""


@dataclass(frozen=True)
class WrittenAnswer:
    """An encoded answer, and when it was given: the machine's clock, ns since 1970."""

    given_ns: int
    frame: Frame

    @property
    def age_s(self) -> float:
        """How long ago it was given (s); where the clock was set back, how far that is ahead."""
        return abs(time.time_ns() - self.given_ns) / 1e9


class Journal:
    """The answers of one service, read when it starts and added to while it runs; thread-safe.

    What is damaged is left out: the end that a killed process has not written, a record whose checksum is wrong. A file
    that cannot be written is opened anew for the next answer.

    Attributes:
        is_new: whether there was no file that can be read, so that nobody knows what was answered before.
        answers: what was read, the oldest first.
        unread: why a file cannot be read; None where all that there are can be.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._set_aside = path, path.with_name(f"{path.name}.before")
        self.unread: OSError | None = None
        contents = [content for file in (self._set_aside, path) if (content := self._content(file)) is not None]
        found = [body for content in contents for body in _records(content)]
        self.is_new = not contents
        self._begun_ns = next((body for body in found if isinstance(body, int)), time.time_ns())
        self.answers = [body for body in found if isinstance(body, WrittenAnswer) and body.age_s <= KEPT_S]
        self._lock = threading.RLock()
        self._file: BinaryIO | None = None
        self._is_stored = True
        with suppress(OSError):  # the first answer, or the first report, says so
            self._opened()

    @property
    def age_s(self) -> float:
        """How long ago the journal was begun (s): all answers since then stand in it, as far as they are kept."""
        return max(time.time_ns() - self._begun_ns, 0) / 1e9

    def add(self, frame: Frame) -> None:
        """Write down an answer that is about to be put.

        Raises:
            OSError: it cannot be written, or the full file cannot be set aside; the next answer tries again.
        """
        with self._lock:
            file = self._opened()
            self._write(file, _record(WrittenAnswer(time.time_ns(), frame)))
            if file.tell() > FULL_BYTES:
                self.close()
                self._path.replace(self._set_aside)

    def store(self) -> None:
        """Have stored on the disk what was written; answers do not wait for it, for a disk may take its time.

        Raises:
            OSError: that failed, or the file is gone with all that stood in it; then another one is begun.
        """
        with self._lock:
            file = self._opened()
            if not self._is_in_place(file):
                self.close()
                self._begun_ns = time.time_ns()
                self._opened()
                lost = "the file was deleted, so the service's earlier answers are lost; the service made a new file"
                raise FileNotFoundError(errno.ENOENT, lost, self._path)
            if self._is_stored:
                return
            self._is_stored = True
            written = os.dup(file.fileno())
        try:
            os.fsync(written)
        finally:
            os.close(written)
        store_names(self._path.parent)

    def close(self) -> None:
        """Have stored what was written, and close the file.

        Raises:
            OSError: it cannot be stored; it is closed all the same.
        """
        with self._lock:
            file, self._file = self._file, None
            if file is not None:
                try:
                    os.fsync(file.fileno())
                finally:
                    file.close()

    def _content(self, file: Path) -> bytes | None:
        """Read a file; None where there is none, or it cannot be read."""
        try:
            return file.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            self.unread = error
            return None

    def _opened(self) -> BinaryIO:
        """Return the file, opened to add to it; a new one says first since when all answers are known."""
        if self._file is None:
            self._path.parent.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)  # what people did is theirs
            self._file = self._path.open("ab", buffering=0)
            if self._file.tell() == 0:
                self._write(self._file, _record(self._begun_ns))
        return self._file

    def _write(self, file: BinaryIO, record: bytes) -> None:
        """Write a record; where that fails nothing of it is left, and the file is closed."""
        self._is_stored, before, left = False, file.tell(), memoryview(record)
        try:
            while left:
                left = left[file.write(left) :]
        except OSError:
            with suppress(OSError):
                file.truncate(before)
            with suppress(OSError):
                self.close()
            raise

    def _is_in_place(self, file: BinaryIO) -> bool:
        """Tell whether the open file still stands in its folder."""
        try:
            return os.path.samestat(os.fstat(file.fileno()), self._path.stat())
        except (FileNotFoundError, NotADirectoryError):
            return False


def _record(content: WrittenAnswer | int) -> bytes:
    """Pack an answer, or the time at which the journal was begun."""
    if isinstance(content, WrittenAnswer):
        frame = content.frame
        body = msgpack.packb([content.given_ns, frame.key, frame.payload, frame.encoding, frame.attachment])
    else:
        body = msgpack.packb([content])
    return HEAD.pack(MAGIC, len(body), zlib.crc32(body)) + bytes(body)


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
        match msgpack.unpackb(body):
            case [int(begun_ns)]:
                return begun_ns, begin + length
            case [int(given_ns), str(key), bytes(payload), str(encoding), bytes(attachment)]:
                return WrittenAnswer(given_ns, Frame(key, payload, encoding, attachment)), begin + length
    except UNPACK_ERRORS:
        pass
    return None
