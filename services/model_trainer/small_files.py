"""Reads and copies files of the trainer's folder; anybody may have put something else in their place."""

import shutil
from pathlib import Path

from actum.atomic_file import replaced

LARGEST_BYTES = 10_000_000
"""Largest such file (bytes): the result of a cross-validation of thousands of examples."""


def small_file(path: Path) -> bytes:
    """Return the content of a file.

    Raises:
        OSError: it is not there, is no file (reading a named pipe would never end), or cannot be read.
        ValueError: it is too large to be one of ours.
    """
    if path.exists() and not path.is_file():
        raise OSError(f"{path} is not a regular file: move {path} to another folder")
    with path.open("rb") as file:
        content = file.read(LARGEST_BYTES + 1)
    if len(content) > LARGEST_BYTES:
        raise ValueError(f"{path} is larger than {LARGEST_BYTES} bytes, the largest size allowed: remove this file")
    return content


def copy(source: Path, target: Path) -> None:
    """Copy a file in place of another one, as a whole or not at all.

    Raises:
        OSError: the one cannot be read, or the other not be written.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    with source.open("rb") as read, replaced(target) as written:
        shutil.copyfileobj(read, written)
