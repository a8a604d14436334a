"""Loads a model file, whichever recogniser it holds, whenever it changes, or says what is wrong with it."""

import json
import math
import os
import re
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import IO, Any
from weakref import WeakValueDictionary

import numpy as np
from pydantic import ValidationError

from actum import __version__
from actum.node import Counters
from actum.states import State
from som_classifier.model import KEPT, Arrays, Model
from som_classifier.paper_model import PaperModel
from som_classifier.pyramid_model import PyramidModel

KINDS: dict[str, type[Model]] = {"paper": PaperModel, "pyramid": PyramidModel}

UNREADABLE = (
    OSError, ValueError, TypeError, EOFError, KeyError, RuntimeError, MemoryError, OverflowError, SyntaxError,
    tokenize.TokenError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What NumPy and zipfile are known to raise on files of another kind, truncated or altered."""

MOST_INFLATION = 20
"""How many times its size the arrays of a file may take: npz files of ours are not compressed, those of others a few
times smaller. Files made to fill memory grow a thousand times."""
LEAST_BYTES = 16_000_000
"""What they may take (bytes) however small the file is."""
NPY: Any = np.lib.format
"""NumPy's file format, which has types in some of its versions only."""
HEADERS = {(1, 0): NPY.read_array_header_1_0, (2, 0): NPY.read_array_header_2_0}
"""NumPy's readers of an array's header, by the version of its format; later ones are for named columns."""
VERSION = re.compile(r"[0-9][0-9A-Za-z.+-]{0,40}")
"""What the version in a file may look like if a message is to name it."""


TRAIN = "train a model with 'actum train REC… -o MODEL'"
"""What to do where there is no usable model file."""


class ModelError(ValueError):
    """A file that no model can be loaded from; the text names the file, the problem and what to do."""

    def __init__(self, path: Path, problem: str, remedy: str) -> None:
        super().__init__(f"{path}: {problem}; {remedy}")


def load_model(path: Path) -> Model:
    """Load the model from a file that `Model.save` wrote.

    Raises:
        ModelError: the file is missing, foreign or damaged, or another version of actum made it and this one cannot use
            it.
    """
    try:
        if path.exists() and not path.is_file():
            raise ModelError(
                path, "the path names a folder or a device, not a model file", f"give a model file, or {TRAIN}"
            )
        with path.open("rb") as stored:
            metadata, arrays = _parts(path, stored)
        return _restored(path, metadata, arrays)
    except ModelError:
        raise
    except FileNotFoundError:
        raise ModelError(path, "the model file does not exist", f"correct the file's name, or {TRAIN}") from None
    except (*UNREADABLE, AttributeError) as error:
        raise ModelError(path, f"the file is not a model of actum, or is damaged ({_problem(error)})", TRAIN) from None


def _restored(path: Path, metadata: str, arrays: Arrays) -> Model:
    """Build the model of a file's parts; an error of a model that another version made names that version."""
    about = json.loads(metadata)
    kind, made_by = about.get("kind"), str(about.get("actum_version"))
    if kind not in KINDS:
        raise ModelError(
            path, f"this version of actum does not support models of kind {kind!r}", f"update actum, or {TRAIN}"
        )
    try:
        return KINDS[kind].restored(metadata, arrays)
    except UNREADABLE as error:
        if made_by == __version__ or not VERSION.fullmatch(made_by):
            raise
        raise ModelError(
            path,
            f"actum {made_by} made the model, and actum {__version__} cannot use this model ({_problem(error)})",
            "train a new model from the same recordings with 'actum train REC… -o MODEL'",
        ) from None


def _problem(error: Exception) -> str:
    """Return what is wrong, of metadata only the first field that is."""
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors(include_input=False, include_url=False)[0]
    return f"metadata {'.'.join(str(part) for part in first['loc'])}: {first['msg']}"


def _parts(path: Path, stored: IO[bytes]) -> tuple[str, Arrays]:
    """Return the metadata as JSON, and the arrays by name."""
    if not zipfile.is_zipfile(stored):  # NumPy's own error would advise to read it as a pickle
        raise ModelError(path, "the file is not a model of actum, or is damaged", TRAIN)
    _refuse_bomb(stored)
    with np.load(stored, allow_pickle=False) as file:
        names = [name for name in file.files if name != "metadata" and not name.startswith(KEPT)]
        return str(file["metadata"]), {name: file[name] for name in names}


def kept_in(path: Path) -> Arrays:
    """Return what a model file keeps for training alone, see `Model.kept`.

    Raises:
        ModelError: the file is missing, foreign or damaged.
    """
    try:
        with path.open("rb") as stored:
            _refuse_bomb(stored)
            with np.load(stored, allow_pickle=False) as file:
                return {name: file[name] for name in file.files if name.startswith(KEPT)}
    except UNREADABLE as error:
        raise ModelError(path, f"the file is not a model of actum, or is damaged ({_problem(error)})", TRAIN) from None


def _refuse_bomb(stored: IO[bytes]) -> None:
    """Refuse an npz file whose arrays take far more memory than the file, and rewind any other.

    Raises:
        ValueError, OSError, zipfile.BadZipFile: it is such a file, or is damaged.
    """
    with zipfile.ZipFile(stored) as archive:
        size = sum(max(member.file_size, _array_bytes(archive, member)) for member in archive.infolist())
    most = LEAST_BYTES + MOST_INFLATION * stored.seek(0, os.SEEK_END)
    if size > most:
        raise ValueError(
            f"the file's arrays would take {size} bytes of memory, more than the {most} bytes that actum allows; use a "
            "file that 'actum train' wrote"
        )
    stored.seek(0)


def _array_bytes(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> int:
    """Return how many bytes NumPy would allocate for an array, as its header says."""
    with archive.open(member) as array:
        read_header = HEADERS.get(NPY.read_magic(array))
        if read_header is None:
            raise ValueError(
                f"the file's entry {member.filename} is not a NumPy array; use a file that 'actum train' wrote"
            )
        shape, _, dtype = read_header(array)
    return int(math.prod(shape) * dtype.itemsize)


_IN_USE: WeakValueDictionary[str, Model] = WeakValueDictionary()
"""The models in use by their ids: nodes of several sensors that read one file share its arrays."""


class WatchedModel:
    """Loads the file whenever it has changed, may be read since, or is back where it could not be looked at."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._loaded_version: tuple[int, int, int] | None = None
        self._loaded = False

    def poll(self, counters: Counters) -> Model | None:
        """Return the model if the file is new or changed and can be loaded, else None.

        A file that cannot be loaded is counted as `bad_model`; the state says so, and also that there is no file yet.
        """
        try:
            stat = self._path.stat()
        except FileNotFoundError:
            if not self._loaded:
                counters.state = State.NO_MODEL.because(f"there is no {self._path} yet")
            return None
        except OSError as error:
            self._loaded_version = None
            self._refuse(counters, str(error))
            return None
        version = (stat.st_mtime_ns, stat.st_ctime_ns, stat.st_size)
        if version == self._loaded_version:
            return None
        self._loaded_version = version
        try:
            model = load_model(self._path)
        except ModelError as error:
            self._refuse(counters, str(error))
            return None
        self._loaded = True
        return _IN_USE.setdefault(model.id, model)

    def _refuse(self, counters: Counters, why: str) -> None:
        counters.reject("bad_model", why)
        counters.state = (State.MODEL_NOT_RENEWED if self._loaded else State.NO_MODEL).because(why)
