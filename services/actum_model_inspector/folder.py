"""The list of the files that a run has written to a folder, so that the next run removes those and nothing else."""

import hashlib
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

LIST = "written-by-actum-inspect.sha256"
"""Name of the list: one line per file, as `sha256sum` writes and checks them."""
PAGE = "index.html"
"""Name of the page that shows the pictures."""
_LINE = re.compile(r"([0-9a-f]{64})  ([^/\\\\]+)")


def note(file: Path) -> None:
    """Add a file that has just been written to the list in its folder.

    Raises:
        OSError: the list cannot be written.
    """
    with (file.parent / LIST).open("a", encoding="utf-8") as listed:
        listed.write(f"{_digest(file)}  {file.name}\n")


def clear(folder: Path, wanted: Iterable[str]) -> None:
    """Remove the files on a folder's list that have not changed since they were written, and the list.

    Raises:
        OSError: one cannot be removed, or another file has one of the wanted names; nothing is removed then.
    """
    ours = set(_unchanged(folder))
    for file in (folder / name for name in wanted):
        if os.path.lexists(file) and file not in ours:
            raise FileExistsError(
                f"{file} was not written by 'actum inspect', or was changed since: move this file away, or give "
                "another folder"
            )
    for file in ours:
        file.unlink(missing_ok=True)
    (folder / LIST).unlink(missing_ok=True)


def _unchanged(folder: Path) -> Iterator[Path]:
    """Yield the files on a folder's list that have not changed since they were written."""
    if not (folder / LIST).is_file():
        return
    lines = (folder / LIST).read_text(encoding="utf-8", errors="replace").splitlines()
    for digest, name in (match.groups() for match in map(_LINE.fullmatch, lines) if match is not None):
        file = folder / name
        if file.is_file() and _digest(file) == digest:
            yield file


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
