"""Reads sets: what their files say, and the takes in them."""

from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pydantic import BaseModel

from actum.codec import encodable
from actum.mcap_file import AGAIN
from actum.recording import Recording, RecordingError
from actum_examples.take import Take, read_take
from model_trainer.small_files import small_file

MOST_SEGMENTS = 2000
"""Most segments of a take, some hours of actions: a change of one looks at all others, while the service waits."""
DESCRIPTION = "set.json"
"""The file that makes a folder a set."""
SUFFIX = ".mcap"
"""Ending of takes."""


class Description(BaseModel):
    """What stands in a set's file."""

    created: str


@dataclass(frozen=True)
class StoredSet:
    """A set: its name, when it was made (ISO 8601; empty where that cannot be read), its takes, and of each file that
    cannot be read, or not to its end, why."""

    name: str
    created: str
    takes: tuple[Take, ...]
    unreadable: tuple[str, ...]


class SetReader:
    """Reads sets from their folders; a take only where its file is not the one that was read before."""

    def __init__(self) -> None:
        self._read: dict[Path, tuple[tuple[int, int], Take]] = {}

    def set(self, name: str, folder: Path) -> StoredSet:
        """Read the set of that name.

        Raises:
            OSError: its folder cannot be read.
        """
        takes, unreadable = [], []
        try:
            created = _created(folder / DESCRIPTION)
        except (OSError, ValueError) as error:
            created = ""
            problem = (
                error.strerror or str(error)
                if isinstance(error, OSError)
                else "the file is not a JSON object with a date in the field `created`"
            )
            unreadable.append(
                f"{folder / DESCRIPTION}: {problem}; move this file to another folder, and create the set again"
            )
        for path in sorted(each for each in folder.iterdir() if each.name.endswith(SUFFIX)):
            try:
                takes.append(self.take(path))
                if takes[-1].recording.truncated:
                    unreadable.append(f"{path}: the recording breaks off, and its examples may be lost; {AGAIN}")
            except (OSError, RecordingError) as error:
                unreadable.append(str(error))
        return StoredSet(encodable(name), created, tuple(takes), tuple(map(encodable, unreadable)))

    def take(self, path: Path) -> Take:
        """Read a take, or return what was read of it before where the file is still the same.

        Raises:
            OSError, RecordingError: it cannot be read, or holds too many segments.
        """
        if path.exists() and not path.is_file():
            raise RecordingError(
                path,
                "the path names a folder or a device, not a recording file",
                "move this folder or device out of the folder of the set",
            )
        stat = path.stat()
        version = stat.st_mtime_ns, stat.st_size
        known = self._read.get(path)
        if known is not None and known[0] == version:
            return known[1]
        take = read_take(Recording(path))
        if (count := len(take.segments)) > MOST_SEGMENTS:
            raise RecordingError(
                path,
                f"the recording has {count} actions with a start and an end; at most {MOST_SEGMENTS} are allowed",
                "delete some of these actions with 'actum label delete', or record the actions in several shorter "
                "recordings",
            )
        self._read[path] = version, take
        return take


def _created(path: Path) -> str:
    """Return when a set was made.

    Raises:
        OSError, ValueError: its description cannot be read, or is of another form.
    """
    created = Description.model_validate_json(small_file(path)).created
    datetime.fromisoformat(created)
    return created
