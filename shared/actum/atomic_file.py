"""Files that are replaced as a whole or not at all, however the process or the machine ends."""

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

UNFINISHED = ".part"
"""Ending of files that are still being written; one that a killed process has left may be deleted."""
PRIVATE_FOLDER = 0o700
"""The mode of a new folder that holds secrets, or what people look like and do: nobody but its owner enters it."""
USUAL_MODE = 0o666
"""What a file's mode is without the umask."""
LONGEST_STEM = 40
"""Characters of a file's name in that of its unfinished one, whose name may not get too long for the file system."""


@contextmanager
def replaced(path: Path, mode: int | None = None) -> Iterator[BinaryIO]:
    """Yield a file to write; once the block ends, it stands on the disk in place of `path`.

    Where the block raises, `path` is as it was before. With `mode` nobody whom it keeps out can read the file at any
    moment, whatever the umask and the file before; without, the umask decides.

    Raises:
        OSError: the file cannot be written.
    """
    unfinished = path.with_name(f".{path.name[:LONGEST_STEM]}.{secrets.token_hex(4)}{UNFINISHED}")
    try:
        with open(unfinished, "xb", opener=lambda name, flags: os.open(name, flags, mode or USUAL_MODE)) as file:
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(file.fileno(), mode)  # the umask may have taken away what the mode grants
            yield file
            file.flush()
            os.fsync(file.fileno())
        unfinished.replace(path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    store_names(path.parent)


def write_whole(path: Path, content: bytes, mode: int | None = None) -> None:
    """Write a file, with a mode as `replaced`, or leave the one that is there as it is.

    Raises:
        OSError: the file cannot be written.
    """
    with replaced(path, mode) as file:
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
