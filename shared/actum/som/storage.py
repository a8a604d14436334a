"""Files of maps and of trainings under way: npz without pickle, so that reading one runs no code."""

import math
import os
import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

MAP_FORMAT = "actum.som/1"
TRAINING_FORMAT = "actum.som.training/1"

UNREADABLE = (
    OSError, ValueError, TypeError, EOFError, KeyError, RuntimeError, MemoryError, OverflowError, SyntaxError,
    tokenize.TokenError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What NumPy and zipfile are known to raise on files of another kind, truncated or altered."""

MOST_INFLATION = 20
"""How many times its size the arrays of a file may take: npz files of ours are not compressed, those of others a few
times smaller. Files made to fill memory grow a thousand times."""
NPY: Any = np.lib.format
"""NumPy's file format, which has types in some of its versions only."""
HEADERS = {(1, 0): NPY.read_array_header_1_0, (2, 0): NPY.read_array_header_2_0}
"""NumPy's readers of an array's header, by the version of its format; later ones are for named columns."""
LEAST_BYTES = 16_000_000
"""What they may take (bytes) however small the file is."""


class SomError(ValueError):
    """A file that no map or training can be read from; the text names the file and the problem.

    >>> from actum.som import Som
    >>> try:
    ...     Som.load("nowhere.npz")
    ... except SomError as error:
    ...     print(error)
    nowhere.npz: the file does not exist
    """

    def __init__(self, path: Path, problem: str) -> None:
        super().__init__(f"{path}: {problem}")


def write(path: Path, file_format: str, arrays: Mapping[str, NDArray[Any]]) -> None:
    """Write the arrays to a temporary file and rename it in one step, so that no partial file is ever read.

    Raises:
        OSError: the file cannot be written.
    """
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        with unfinished.open("wb") as file:
            np.savez(file, allow_pickle=False, format=np.array(file_format), **arrays)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def refuse_bomb(stored: IO[bytes]) -> None:
    """Refuse an npz file whose arrays take far more memory than the file, and rewind any other.

    Raises:
        ValueError, OSError, zipfile.BadZipFile: it is such a file, or is damaged.
    """
    with zipfile.ZipFile(stored) as archive:
        size = sum(max(member.file_size, _array_bytes(archive, member)) for member in archive.infolist())
    most = LEAST_BYTES + MOST_INFLATION * stored.seek(0, os.SEEK_END)
    if size > most:
        raise ValueError(f"its arrays would take {size} bytes of memory; at most {most} are allowed")
    stored.seek(0)


def _array_bytes(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> int:
    """Return how many bytes NumPy would allocate for an array, as its header says."""
    with archive.open(member) as array:
        read_header = HEADERS.get(NPY.read_magic(array))
        if read_header is None:
            raise ValueError(f"{member.filename} is not an array that NumPy wrote")
        shape, _, dtype = read_header(array)
    return int(math.prod(shape) * dtype.itemsize)


@contextmanager
def reading(path: Path, file_format: str) -> Iterator[Mapping[str, NDArray[Any]]]:
    """Return a context with the arrays of a file; errors of reading or using them in the `with` block are `SomError`s.

    Raises:
        SomError: the file is missing, foreign or damaged.
    """
    try:
        with path.open("rb") as stored:
            if not zipfile.is_zipfile(stored):
                raise SomError(path, "it is not an npz file")
            refuse_bomb(stored)
            with np.load(stored, allow_pickle=False) as file:
                if str(file["format"]) != file_format:
                    raise SomError(
                        path, f"the file has the format {str(file['format'])!r}, but {file_format!r} is needed here"
                    )
                yield file
    except SomError:
        raise
    except FileNotFoundError:
        raise SomError(path, "the file does not exist") from None
    except UNREADABLE as error:
        raise SomError(path, f"it is not of format {file_format!r}, or it is damaged ({error})") from None
