"""Sets on the disk: a folder each, with a recording for each take; whatever is changed is changed at once or not."""

import json
import os
import re
from collections.abc import Callable
from contextlib import suppress
from datetime import UTC, datetime
from itertools import count
from pathlib import Path
from unicodedata import normalize

from actum.atomic_file import clear_unfinished, give_name, store_names, write_whole
from actum.commands import Refusal
from actum.recorder import Recorder, is_being_written
from actum_examples.take import CREATED, KIND, Take
from model_trainer.stored_set import DESCRIPTION, SUFFIX, SetReader, StoredSet

Clock = Callable[[], int]
"""Returns the time of the machine's clock, ns since 1970."""
MAKING = ".making"
"""The folder of takes that are being recorded."""
LEAVING = ".leaving-"
"""Beginning of the name of a folder that is being deleted."""
LEFT = re.compile(rf"{re.escape(LEAVING)}[0-9]+")
"""The names of such folders."""
TAKE = re.compile(r"take-([0-9]{4,9})")
"""The names of takes that are made here."""
DEVICES = frozenset({"con", "prn", "aux", "nul", *(f"{kind}{n}" for kind in ("com", "lpt") for n in range(1, 10))})
"""Names that Windows keeps for devices, with any ending: a set of that name could not be copied there."""


class SetStore:
    """The sets in a folder; what a killed process has left unfinished there is removed first."""

    def __init__(self, folder: Path, now_ns: Clock) -> None:
        self._folder = folder
        self._now_ns = now_ns
        self._reader = SetReader()
        folder.mkdir(parents=True, exist_ok=True)
        for take in (folder / MAKING).glob("*"):
            with suppress(OSError):  # none of ours
                if not is_being_written(take):  # by another trainer, of another sensor, in the same folder
                    take.unlink()
        with suppress(OSError):  # it is not there, or not empty
            (folder / MAKING).rmdir()
        for path in sorted(folder.iterdir()):
            with suppress(OSError):  # somebody else's folder, or one that cannot be read
                if LEFT.fullmatch(path.name):
                    _clear(path)
                elif path.is_dir():
                    clear_unfinished(path)
        self._modified = self._times()

    def look(self) -> bool:
        """Look whether anybody, also another program, has changed the sets since the look before, and return that."""
        before, self._modified = self._modified, self._times()
        return before != self._modified

    def _times(self) -> dict[str, int]:
        """Return when each set's folder was modified (ns): files are replaced whole."""
        times = dict[str, int]()
        with suppress(OSError):  # the folder has vanished; so has a set's, if its time cannot be read
            for path in self._folder.iterdir():
                if not path.name.startswith("."):
                    times[path.name] = path.stat().st_mtime_ns
        return times

    def names(self) -> list[str]:
        """List the sets by name.

        Raises:
            OSError: the folder cannot be read.
        """
        return sorted(self._folders())

    def _folders(self) -> dict[str, Path]:
        """Return the sets' folders by their names in composed Unicode (NFC): some systems write ü as two characters."""
        folders = (path for path in self._folder.iterdir() if not path.name.startswith("."))
        return {normalize("NFC", path.name): path for path in folders if os.path.lexists(path / DESCRIPTION)}

    def get(self, name: str) -> StoredSet:
        """Read a set.

        Raises:
            Refusal: there is none of that name.
            OSError: its folder cannot be read.
        """
        return self._reader.set(name, self.folder(name))

    def folder(self, name: str) -> Path:
        """Return a set's folder.

        Raises:
            Refusal: there is none of that name.
        """
        folders = self._folders()
        if name not in folders:
            existing = ", ".join(sorted(folders)) or "none yet"
            raise Refusal(f"there is no set {name!r}: use an existing set ({existing}), or create this set")
        return folders[name]

    def create(self, name: str) -> None:
        """Make an empty set.

        Raises:
            Refusal: there is one of that name, or Windows has no folder of that name.
        """
        self._refuse_unusable(name)
        folder = self._folder / name
        folder.mkdir(exist_ok=True)
        write_whole(folder / DESCRIPTION, json.dumps({"created": date_of(self._now_ns())}).encode())
        store_names(self._folder)

    def rename(self, name: str, new_name: str) -> None:
        """Give a set another name.

        Raises:
            Refusal: there is none of that name, one of the new name, or Windows has no folder of that name.
        """
        folder = self.folder(name)
        self._refuse_unusable(new_name, renamed=name)
        folder.rename(self._folder / new_name)
        store_names(self._folder)

    def delete(self, name: str) -> None:
        """Delete a set with all its takes; files of other kinds in its folder stay there.

        Raises:
            Refusal: there is none of that name.
        """
        folder = self.folder(name)
        leaving = self._folder / f"{LEAVING}{self._now_ns()}"
        folder.rename(leaving)
        store_names(self._folder)
        with suppress(OSError):  # what stays of it goes with the next start
            _clear(leaving)
            if os.path.lexists(leaving) and not os.path.lexists(folder):
                leaving.rename(folder)

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
        newest = max((take_number(path.stem) for path in folder.iterdir()), default=0)
        for target in (folder / f"take-{number:04}{SUFFIX}" for number in count(newest + 1)):
            with suppress(FileExistsError):
                give_name(path, target)
                break
        return self._reader.take(target)

    def _refuse_unusable(self, name: str, renamed: str | None = None) -> None:
        if name.partition(".")[0].rstrip().casefold() in DEVICES:
            raise Refusal(f"{name!r} is reserved for a device on Windows: choose another name")
        for existing in self.names():
            if existing.casefold() == name.casefold() and existing != renamed:
                raise Refusal(f"there is already a set {existing!r}: choose another name")


def take_number(stem: str) -> int:
    """Return the number of a take that was made here, by which the newest is the highest; 0 for any other recording."""
    made_here = TAKE.fullmatch(stem)
    return int(made_here[1]) if made_here else 0


def date_of(time_ns: int) -> str:
    """Write a time (ns since 1970) as ISO 8601 in UTC, to the second."""
    return datetime.fromtimestamp(time_ns // 1_000_000_000, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def _clear(folder: Path) -> None:
    """Delete what makes a folder a set, and the folder where nothing else is in it; of a link, only the link.

    Raises:
        OSError: something cannot be deleted.
    """
    if folder.is_symlink():
        folder.unlink()
        return
    clear_unfinished(folder)
    for path in (folder / DESCRIPTION, *(each for each in folder.iterdir() if each.name.endswith(SUFFIX))):
        if path.is_dir() and not path.is_symlink():
            with suppress(OSError):  # something is in it
                path.rmdir()
        else:
            path.unlink(missing_ok=True)
    if not any(folder.iterdir()):
        folder.rmdir()
