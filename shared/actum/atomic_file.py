"""Files that are replaced as a whole or not at all, however the process or the machine ends."""

import os
import re
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

UNFINISHED = ".part"
"""Ending of files that are still being written; one that a killed process has left may be deleted."""
LEFT = re.compile(rf"\..+\.[0-9a-f]{{8}}{re.escape(UNFINISHED)}", re.DOTALL)
"""The names of unfinished files."""
LONGEST_STEM = 40
"""Characters of a file's name in that of its unfinished one, whose name may not get too long for the file system."""


@contextmanager
def replaced(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to write; once the block ends, it stands on the disk in place of `path`.

    Where the block raises, `path` is as it was before.

    Raises:
        OSError: the file cannot be written.
    """
    unfinished = path.with_name(f".{path.name[:LONGEST_STEM]}.{secrets.token_hex(4)}{UNFINISHED}")
    try:
        with unfinished.open("xb") as file:
            yield file
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    store_names(path.parent)


def clear_unfinished(folder: Path) -> None:
    """Delete the unfinished files of `replaced` that a killed process has left in a folder, and no others.

    Raises:
        OSError: one cannot be deleted.
    """
    for path in folder.iterdir():
        if LEFT.fullmatch(path.name) and not path.is_dir():
            path.unlink(missing_ok=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file, or leave the one that is there as it is.

    Raises:
        OSError: the file cannot be written.
    """
    with replaced(path) as file:
        file.write(content)


def store_names(folder: Path) -> None:
    """Have the names of a folder's files stored: a rename is durable only after that, where the system can tell."""
    if not hasattr(os, "O_DIRECTORY"):
        return
    number = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(number)
    finally:
        os.close(number)
