"""The model file that a user names for use: it is only read, and its content is copied to the model in use."""

from pathlib import Path

from pydantic import BaseModel, ConfigDict

from actum.atomic_file import write_whole
from actum.codec import encodable
from actum.states import State
from model_trainer.small_files import copy, small_file
from som_classifier.model_loading import ModelError, load_model

RECORD = ".original.json"
"""What the name of the record beside the model in use ends with, in place of `.npz`."""


class Copied(BaseModel):
    """Which state of which file was copied last, and the id of the model in it."""

    model_config = ConfigDict(strict=True, frozen=True)

    file: str
    modified_ns: int
    size: int
    model: str


class OriginalModel:
    """A file whose model is put into use when it is there first, and whenever it changes.

    The record beside the model in use keeps a process that starts anew from copying the same state of the file again,
    over a model that was put into use since.
    """

    def __init__(self, file: Path, in_use: Path) -> None:
        self._file, self._in_use = file.absolute(), in_use
        self._name = encodable(str(self._file))
        self._record = in_use.with_suffix(RECORD)
        self._copied = _read(self._record)
        self._refused: tuple[int, int] | None = None
        self._problem = ""

    def source_of(self, model_id: str | None) -> str | None:
        """Return the file's path where a model was copied from its newest state, else None."""
        copied = self._copied
        return self._name if copied is not None and (copied.file, copied.model) == (self._name, model_id) else None

    def state(self, has_model: bool) -> str:
        """Describe how far the file is used, where a model is in use or none is."""
        if self._problem and (not has_model or self._refused is not None):
            return (State.MODEL_NOT_RENEWED if has_model else State.NO_MODEL).because(self._problem)
        return State.RUNNING

    def copy_changed(self) -> str | None:
        """Copy the file to the model in use where it has changed since it was copied last.

        Returns why its new state cannot be used, once for each state, else None.

        Raises:
            OSError: the file cannot be looked at, or the copy not be written.
        """
        try:
            stat = self._file.stat()
        except FileNotFoundError:
            self._problem, self._refused = f"there is no {self._name} yet", None
            return None
        state = stat.st_mtime_ns, stat.st_size
        if state == self._refused:
            return None
        self._problem, self._refused = "", None
        try:
            if not self._holds(state):
                model = load_model(self._file)
                copy(self._file, self._in_use)
                self._copied = Copied(file=self._name, modified_ns=state[0], size=state[1], model=model.id)
                write_whole(self._record, self._copied.model_dump_json().encode())
        except ModelError as error:
            self._problem, self._refused = encodable(str(error)), state
            return self._problem
        return None

    def _holds(self, state: tuple[int, int]) -> bool:
        """Return whether the copy that is there was made of this state of the file."""
        copied = self._copied
        if copied is None or not self._in_use.exists():
            return False
        return (copied.file, copied.modified_ns, copied.size) == (self._name, *state)


def _read(record: Path) -> Copied | None:
    try:
        return Copied.model_validate_json(small_file(record))
    except (OSError, ValueError):
        return None
