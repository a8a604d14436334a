"""Files that come in pieces."""

import shutil
from pathlib import Path

from actum.atomic_file import UNFINISHED, store_names
from actum.commands import Refusal
from actum.run_folder import CLAIM, RunFolder

MOST_BYTES = 2_000_000_000
"""Largest file (bytes): half an hour of a phone's video."""
MOST_TOTAL_BYTES = 6_000_000_000
"""Most bytes of all files together: three of the largest."""
MOST_FILES = 1000
"""Most files, finished or not."""
SENT = ".sent"
"""The folder within the store's that holds what was sent: no file outside of it is touched."""


class UploadStore:
    """The files that were sent to one trainer, in a folder of their own. They do not outlive it: they show faces."""

    def __init__(self, folder: Path) -> None:
        sent = folder / SENT
        sent.mkdir(parents=True, exist_ok=True)
        self._run = RunFolder("", sent)  # another trainer may serve in the same folder
        self._folder = self._run.path

    def add(self, name: str, offset: int, data: bytes, last: bool) -> int:
        """Add a piece at the end of a file, or begin it anew at offset 0; return its size so far (bytes).

        Raises:
            Refusal: the piece does not follow the one before it, or the file, or all together, get too large.
            OSError: it cannot be written.
        """
        self._folder.mkdir(parents=True, exist_ok=True)
        unfinished = self._folder / f".{name}{UNFINISHED}"
        sizes = {file.name: file.stat().st_size for file in self._folder.iterdir() if file.name != CLAIM}
        arrived = sizes.pop(unfinished.name, 0)
        if offset not in (0, arrived):
            raise Refusal(
                f"this piece of {name} has the offset {offset}, but {arrived} bytes of the file have arrived: continue "
                f"at offset {arrived}, or start again at offset 0"
            )
        size = offset + len(data)
        if size > MOST_BYTES:
            raise Refusal(f"{name} is larger than {MOST_BYTES} bytes: send a shorter video")
        total, files = sum(sizes.values()) + size, len(sizes.keys() | {name})
        if total > MOST_TOTAL_BYTES or files > MOST_FILES:
            raise Refusal(
                f"{name} cannot be stored, because {files} files with {total} bytes would then wait for their import, "
                f"and at most {MOST_FILES} files with {MOST_TOTAL_BYTES} bytes are allowed to wait. Import some of the "
                "waiting files first, or restart the service, which deletes all waiting files"
            )
        with unfinished.open("ab" if offset else "wb") as file:
            file.write(data)
        if last:
            unfinished.replace(self._folder / name)
            store_names(self._folder)
        return size

    def refuse_missing(self, name: str) -> None:
        """Refuse a file that was not sent whole.

        Raises:
            Refusal: there is no finished one of that name.
        """
        if not (self._folder / name).is_file():
            raise Refusal(
                f"the file {name!r} was not uploaded completely: send all its pieces with the command 'upload', "
                "and set the field `last` to true in the final piece"
            )

    def move(self, name: str, folder: Path) -> Path:
        """Move a finished file into a folder, where no later one of that name replaces it; return its path there.

        Raises:
            OSError: it cannot be moved.
        """
        return Path(shutil.move(self._folder / name, folder / name))

    def put_back(self, file: Path) -> None:
        """Return a file that was moved, unless one of its name was sent meanwhile.

        Raises:
            OSError: it cannot be moved.
        """
        if not (self._folder / file.name).exists():
            shutil.move(file, self._folder / file.name)
