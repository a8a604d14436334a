"""Sets on the disk: a folder each, with a recording for each take; whatever is changed is changed at once or not."""

import json
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import count
from pathlib import Path

from actum.atomic_file import UNFINISHED, give_name, store_names, write_whole
from actum.commands import Refusal
from actum.recorder import Recorder, is_being_written
from actum.recording import RecordingError
from actum_model_trainer.teaching.take_files import CREATED, KIND, Example, Take, read_take

Clock = Callable[[], int]
"""Returns the time of the machine's clock, ns since 1970."""
DESCRIPTION = "set.json"
"""The file that makes a folder a set."""
MAKING = ".making"
"""The folder of takes that are being recorded."""
LEAVING = ".leaving-"
"""Beginning of the name of a folder that is being deleted."""
SUFFIX = ".mcap"
"""Ending of takes."""


@dataclass(frozen=True)
class StoredSet:
    """A set: its name, when it was made (ISO 8601), its takes, and of each file that cannot be read why."""

    name: str
    created: str
    takes: tuple[Take, ...]
    unreadable: tuple[str, ...]

    @property
    def examples(self) -> list[Example]:
        """All examples, take by take in order of time."""
        return [example for take in self.takes for example in take.examples]


class SetStore:
    """The sets in a folder; what a killed process has left unfinished there is removed first."""

    def __init__(self, folder: Path, now_ns: Clock) -> None:
        self._folder = folder
        self._now_ns = now_ns
        self._read: dict[Path, tuple[tuple[int, int], Take]] = {}
        folder.mkdir(parents=True, exist_ok=True)
        for left in folder.glob(f"{LEAVING}*"):
            shutil.rmtree(left, ignore_errors=True)
        for take in (folder / MAKING).glob("*"):
            if not is_being_written(take):  # by another trainer, of another sensor, in the same folder
                take.unlink()
        with suppress(OSError):  # it is not there, or not empty
            (folder / MAKING).rmdir()
        for unfinished in folder.glob(f"*/.*{UNFINISHED}"):
            unfinished.unlink(missing_ok=True)

    def names(self) -> list[str]:
        """List the sets by name."""
        return sorted(path.parent.name for path in self._folder.glob(f"*/{DESCRIPTION}"))

    def get(self, name: str) -> StoredSet:
        """Read a set.

        Raises:
            Refusal: there is none of that name.
        """
        takes, unreadable = [], []
        for path in sorted(self.folder(name).glob(f"*{SUFFIX}")):
            try:
                takes.append(self._take(path))
            except RecordingError as error:
                unreadable.append(str(error))
        return StoredSet(name, self._created(name), tuple(takes), tuple(unreadable))

    def folder(self, name: str) -> Path:
        """Return a set's folder.

        Raises:
            Refusal: there is none of that name.
        """
        if name not in self.names():
            there = ", ".join(self.names()) or "none yet"
            raise Refusal(f"there is no set {name!r}: name one of those there are ({there}) or create it")
        return self._folder / name

    def create(self, name: str) -> None:
        """Make an empty set.

        Raises:
            Refusal: there is one of that name.
        """
        self._refuse_taken(name)
        folder = self._folder / name
        folder.mkdir(exist_ok=True)
        write_whole(folder / DESCRIPTION, json.dumps({"created": date_of(self._now_ns())}).encode())
        store_names(self._folder)

    def rename(self, name: str, new_name: str) -> None:
        """Give a set another name.

        Raises:
            Refusal: there is none of that name, or one of the new name.
        """
        folder = self.folder(name)
        self._refuse_taken(new_name)
        folder.rename(self._folder / new_name)
        store_names(self._folder)

    def delete(self, name: str) -> None:
        """Delete a set with all its takes.

        Raises:
            Refusal: there is none of that name.
        """
        leaving = self._folder / f"{LEAVING}{self._now_ns()}"
        self.folder(name).rename(leaving)
        store_names(self._folder)
        shutil.rmtree(leaving, ignore_errors=True)

    def recorder(self, person: str, kind: str) -> Recorder:
        """Return what writes a take that is in no set yet.

        Raises:
            OSError: it cannot be written.
        """
        fields = {KIND: kind, CREATED: date_of(self._now_ns())}
        path = self._folder / MAKING / f"{self._now_ns()}{SUFFIX}"
        return Recorder(path, person=person, source="model_trainer", **fields)

    def add(self, name: str, path: Path) -> Take:
        """Move a finished take into a set.

        Raises:
            Refusal: there is no set of that name.
        """
        folder = self.folder(name)
        for target in (folder / f"take-{number:04}{SUFFIX}" for number in count(1)):
            with suppress(FileExistsError):
                give_name(path, target)
                break
        return self._take(target)

    def _created(self, name: str) -> str:
        path = self._folder / name / DESCRIPTION
        try:
            return str(json.loads(path.read_bytes())["created"])
        except (ValueError, KeyError, TypeError):
            return date_of(path.stat().st_mtime_ns)

    def _refuse_taken(self, name: str) -> None:
        if name.casefold() in (
            path.name.casefold() for path in self._folder.iterdir() if (path / DESCRIPTION).exists()
        ):
            raise Refusal(f"there is a set {name!r} already: choose another name, or delete or rename that one")

    def _take(self, path: Path) -> Take:
        """Read a take, or return what was read of it before where the file is still the same."""
        stat = path.stat()
        version = stat.st_mtime_ns, stat.st_size
        known = self._read.get(path)
        if known is None or known[0] != version:
            known = self._read[path] = version, read_take(path)
        return known[1]


def date_of(time_ns: int) -> str:
    """Write a time (ns since 1970) as ISO 8601 in UTC, to the second."""
    return datetime.fromtimestamp(time_ns // 1_000_000_000, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
