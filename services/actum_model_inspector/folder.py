"""The list of the files that a run has written to a folder, so that the next run removes those and nothing else."""

import hashlib
import re
from pathlib import Path

LIST = "written-by-actum-inspect.sha256"
"""Name of the list: one line per file, as `sha256sum` writes and checks them."""
_LINE = re.compile(r"([0-9a-f]{64})  ([^/\\\\]+)")


def note(file: Path) -> None:
    """Add a file that has just been written to the list in its folder.

    Raises:
        OSError: the list cannot be written.
    """
    with (file.parent / LIST).open("a", encoding="utf-8") as listed:
        listed.write(f"{_digest(file)}  {file.name}\n")


def clear(folder: Path) -> None:
    """Remove the files on a folder's list that have not changed since they were written, and the list.

    Raises:
        OSError: one cannot be removed.
    """
    if not (folder / LIST).is_file():
        return
    lines = (folder / LIST).read_text(encoding="utf-8", errors="replace").splitlines()
    for digest, name in (match.groups() for match in map(_LINE.fullmatch, lines) if match is not None):
        file = folder / name
        if file.is_file() and _digest(file) == digest:
            file.unlink()
    (folder / LIST).unlink()


def _digest(file: Path) -> str:
    with file.open("rb") as content:
        return hashlib.file_digest(content, "sha256").hexdigest()
