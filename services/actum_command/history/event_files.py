"""Files of events, one after another: finished by size and age, whole or readable however the process ends."""

import re
from collections.abc import Iterator
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER
from actum.mcap_file import McapFile
from actum.messages import Message
from actum.node import SECOND_NS
from actum.recorder import StoredRecorder
from actum.recording import RecordingError
from actum.rewriting import finish
from actum_command.history.settings import Settings

SUFFIX = ".mcap"
"""Ending of finished files; before it is finished a file ends in `.mcap.part`."""
STORED_NS = SECOND_NS
"""Longest time (ns) until what was written stands on the disk: a power cut loses no more."""
MEGABYTE = 1_000_000
"""In bytes."""
HOUR_NS = 3600 * SECOND_NS
"""In nanoseconds."""


class EventFiles:
    """The files of one sensor in a folder, `events-<sensor>-<number>-<time>.mcap`: their names are in their order.

    The number decides, for clocks are set back. A file begins with the first message, so that there is no empty one.

    Attributes:
        finished: number of files that were finished.
        deleted: number of files that made room.
    """

    def __init__(self, folder: Path, sensor: str, settings: Settings) -> None:
        self.finished = self.deleted = 0
        self._folder, self._sensor, self._settings = folder, sensor, settings
        self._name = re.compile(rf"events-{sensor}-(?P<number>\d+)-\w+\.mcap(?P<unfinished>\.part)?")
        self._open: StoredRecorder | None = None
        self._began_ns = self._stored_ns = 0

    def write(self, message: Message, received_ns: int, now_ns: int) -> None:
        """Store a message that has a stamp.

        Args:
            message: the message.
            received_ns: the time of day at which it came (ns).
            now_ns: the newest tick (ns).

        Raises:
            OSError: it cannot be written; the next message begins another file.
        """
        try:
            recorder = self._open or self._begun(received_ns, now_ns)
            recorder.write(message, received_ns)
        except OSError:
            self._abandon()
            raise
        if recorder.size_bytes >= self._settings.history_file_mb * MEGABYTE:
            self.finish()

    def tick(self, now_ns: int) -> None:
        """Have stored what was written, and finish a file that is old enough, by a tick (ns).

        Raises:
            OSError: the disk does not take it.
        """
        if self._open is None:
            return
        if now_ns - self._began_ns >= self._settings.history_file_hours * HOUR_NS:
            self.finish()
        elif now_ns - self._stored_ns >= STORED_NS:
            self._stored_ns = now_ns
            try:
                self._open.store()
            except OSError:
                self._abandon()
                raise

    def finish(self) -> None:
        """Finish the open file if there is one, and delete the oldest beyond what is kept.

        Raises:
            OSError: it cannot be finished; it is readable under its unfinished name.
        """
        recorder, self._open = self._open, None
        if recorder is not None:
            recorder.close()
            self.finished += 1
            self._make_room()

    def recover(self) -> Iterator[str]:
        """Finish what a killed process has left; yield what is wrong with files that cannot be finished.

        Raises:
            OSError: the folder cannot be read or written.
        """
        self._folder.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
        for part in self._files(finished=False):
            file = part.with_suffix("")
            try:
                if finish(file):
                    self.finished += 1
                else:
                    file.unlink()
            except (RecordingError, FileExistsError) as error:
                yield str(error)

    def newest(self) -> Iterator[tuple[str, bytes]]:
        """Yield key and payload of each message in the newest two finished files, without what cannot be read."""
        for file in self._files(finished=True)[-2:]:
            with suppress(RecordingError):
                yield from ((stored.key, stored.payload) for stored in McapFile(file).stored())

    def _abandon(self) -> None:
        """Leave the open file unfinished: the next message begins another one, and the next start finishes this."""
        recorder, self._open = self._open, None
        if recorder is not None:
            recorder.abandon()

    def _begun(self, received_ns: int, now_ns: int) -> StoredRecorder:
        """Begin the next file."""
        number = 1 + max(map(self._number, [*self._files(finished=True), *self._files(finished=False)]), default=0)
        time = datetime.fromtimestamp(received_ns // SECOND_NS, UTC).strftime("%Y%m%dT%H%M%SZ")
        file = self._folder / f"events-{self._sensor}-{number:06d}-{time}{SUFFIX}"
        self._open = StoredRecorder(file, person="", source=self._sensor)
        self._began_ns = self._stored_ns = now_ns
        return self._open

    def _files(self, finished: bool) -> list[Path]:
        """List this sensor's finished or unfinished files, the oldest first."""
        matches = [(file, self._name.fullmatch(file.name)) for file in self._folder.glob("events-*")]
        chosen = [file for file, match in matches if match and finished == (match["unfinished"] is None)]
        return sorted(chosen, key=self._number)

    def _number(self, file: Path) -> int:
        match = self._name.fullmatch(file.name)
        return int(match["number"]) if match else 0

    def _make_room(self) -> None:
        """Delete the oldest finished files beyond what is kept, but never the newest."""
        sizes = {file: file.stat().st_size for file in self._files(finished=True)}
        for oldest in [*sizes][:-1]:
            too_many = len(sizes) > (self._settings.history_keep_files or len(sizes))
            too_large = sum(sizes.values()) > (self._settings.history_keep_mb or float("inf")) * MEGABYTE
            if not (too_many or too_large):
                return
            oldest.unlink()
            del sizes[oldest]
            self.deleted += 1
