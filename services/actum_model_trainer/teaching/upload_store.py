"""Files that come in pieces."""

from pathlib import Path

from actum.atomic_file import UNFINISHED, store_names
from actum.commands import Refusal

MOST_BYTES = 2_000_000_000
"""Largest file (bytes): half an hour of a phone's video."""


class UploadStore:
    """The files that were sent, in a folder. They do not outlive the service: they show faces."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for left in (file for file in folder.iterdir() if file.is_file()):
            left.unlink()

    def add(self, name: str, offset: int, data: bytes, last: bool) -> int:
        """Add a piece at the end of a file, or begin it anew at offset 0; return its size so far (bytes).

        Raises:
            Refusal: the piece does not follow the one before it, or the file gets too large.
            OSError: it cannot be written.
        """
        unfinished = self._folder / f".{name}{UNFINISHED}"
        there = unfinished.stat().st_size if unfinished.exists() else 0
        if offset not in (0, there):
            raise Refusal(f"{name} has {there} bytes so far: go on from there, or begin anew with offset 0")
        if offset + len(data) > MOST_BYTES:
            raise Refusal(f"{name} gets larger than {MOST_BYTES} bytes: cut the video, or send a smaller one")
        with unfinished.open("ab" if offset else "wb") as file:
            file.write(data)
        if last:
            unfinished.replace(self._folder / name)
            store_names(self._folder)
        return offset + len(data)

    def get(self, name: str) -> Path:
        """Return a finished file.

        Raises:
            Refusal: there is none of that name.
        """
        if not (self._folder / name).is_file():
            raise Refusal(
                f"there is no finished upload {name!r}: send it with 'upload', the last piece with last: true"
            )
        return self._folder / name
