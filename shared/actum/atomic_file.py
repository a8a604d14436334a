"""Files that are written as a whole or not at all, however the process or the machine ends; and who writes one."""

import errno
import os
import re
import secrets
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

if sys.platform != "win32":
    import fcntl

UNFINISHED = ".part"
"""Ending of files that are still being written. A recording that a killed process has left is readable up to there."""
LEFT = re.compile(rf"\..+\.[0-9a-f]{{8}}{re.escape(UNFINISHED)}", re.DOTALL)
"""The names of unfinished files."""
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
    with _temporary(path, mode) as file:
        yield file
        _stored(file).replace(path)
    store_names(path.parent)


@contextmanager
def created(path: Path) -> Iterator[BinaryIO]:
    """Yield a file to write; once the block ends, it stands on the disk under a name that nobody had.

    Raises:
        FileExistsError: somebody has the name, or takes it meanwhile.
        OSError: the file cannot be written.
    """
    with _temporary(path) as file:
        yield file
        give_name(_stored(file), path)


@contextmanager
def _temporary(path: Path, mode: int | None = None) -> Iterator[BinaryIO]:
    """Yield a file beside another one; it is gone after the block unless it has got another name."""
    unfinished = path.with_name(f".{path.name[:LONGEST_STEM]}.{secrets.token_hex(4)}{UNFINISHED}")
    try:
        with open(unfinished, "xb", opener=lambda name, flags: os.open(name, flags, mode or USUAL_MODE)) as file:
            if mode is not None and hasattr(os, "fchmod"):
                os.fchmod(file.fileno(), mode)  # the umask may have taken away what the mode grants
            yield file
    finally:
        unfinished.unlink(missing_ok=True)


def _stored(file: BinaryIO) -> Path:
    """Have a file stored on the disk and close it; return its path."""
    file.flush()
    os.fsync(file.fileno())
    file.close()
    return Path(file.name)


def give_name(unfinished: Path, path: Path) -> None:
    """Give a finished file a name that no file has.

    Raises:
        FileExistsError: one has it.
        OSError: the name cannot be given.
    """
    try:
        path.hardlink_to(unfinished)
    except FileExistsError:
        raise
    except OSError:  # a file system without hard links
        if os.path.lexists(path):
            raise FileExistsError(errno.EEXIST, os.strerror(errno.EEXIST), str(path)) from None
        unfinished.rename(path)
    unfinished.unlink(missing_ok=True)
    store_names(path.parent)


def claim(file: BinaryIO) -> bool:
    """Claim an open file until it is closed or the process ends, however it ends; return False where another has it.

    Where the file system or the operating system has no such locks, every file can be claimed.
    """
    if sys.platform == "win32":  # there no other process can rename or remove an open file
        return True
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def clear_unfinished(folder: Path) -> None:
    """Delete the unfinished files of `replaced` that a killed process has left in a folder, and no others.

    Raises:
        OSError: one cannot be deleted.
    """
    for path in folder.iterdir():
        if LEFT.fullmatch(path.name) and not path.is_dir():
            path.unlink(missing_ok=True)


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
