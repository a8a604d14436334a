"""Which model a system starts with: the named one, the one that was put into use last, or the one that ships."""

import filecmp
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from actum.atomic_file import PRIVATE_FOLDER
from actum.run_folder import RunFolder
from actum.settings import SettingsError
from actum_command.misspelt import nearest
from actum_command.service_settings import Given
from actum_command.simulated_model import SIMULATED_MODEL
from model_trainer.original_model import OriginalModel
from model_trainer.settings import MODEL
from model_trainer.settings import Settings as TrainerSettings
from som_classifier.settings import Settings as ClassifierSettings

NO_MODEL = (
    "no model yet, so every action is answered with 'no model'. Teach one on the page; or record each action "
    "(actum record wave.mcap --label wave --times 5), train (actum train *.mcap -o model.npz) and start again with "
    "--model model.npz"
)
"""What to do where there is no model and none is named."""
REMINDER_S = 30.0
"""Interval (s) at which a named model that is missing is named again: the services' first lines hide the first."""
RUN = "run-"
"""How the names of the folders of runs begin."""


@dataclass(frozen=True)
class ModelInUse:
    """The model of a system.

    Attributes:
        file: the one that the classifier reads and the trainer replaces.
        original: the one that it is a copy of, which is only read; None where there is none.
    """

    file: Path
    original: Path | None = None


def taught_model(given: Given) -> Path:
    """Return the file of the model that was put into use last: in the trainer's folder, as that is set."""
    folder = given.get("trainer_data")
    return Path(folder[-1] if isinstance(folder, list) else TrainerSettings().trainer_data) / MODEL


@contextmanager
def model_in_use(named: Path | None, source: str, given: Given) -> Iterator[ModelInUse]:
    """Yield the model to start with; a named one, and the one that ships, as a copy in the trainer's folder.

    Without a name, the simulated scene starts with the model that ships until another one has been put into use.

    Raises:
        SettingsError: the trainer's folder cannot be used.
    """
    taught, original = taught_model(given), named or ClassifierSettings().model
    ships = taught.exists() and filecmp.cmp(taught, SIMULATED_MODEL, shallow=False)
    if original is None and source == "simulator" and (ships or not taught.exists()):
        original = SIMULATED_MODEL
    if original is None and not ships:
        yield ModelInUse(taught)
        return
    try:
        taught.parent.mkdir(PRIVATE_FOLDER, parents=True, exist_ok=True)
        folder = RunFolder(RUN, taught.parent)  # two systems at a time share no model
    except OSError as error:
        raise SettingsError(
            f"the folder {taught.parent} cannot be used ({error}): set ACTUM_TRAINER_DATA to another folder"
        ) from None
    try:
        model = ModelInUse(folder.path / MODEL, original)
        if original is not None:
            OriginalModel(original, model.file).copy_changed()
        yield model
    finally:
        folder.delete()


def lack_of_file(model: ModelInUse) -> str | None:
    """Return that the named model's file is missing, and which one beside it may be meant; None where it is there."""
    original = model.original
    if original is None or original.exists():
        return None
    beside = [path.name for path in original.parent.glob("*.npz")]
    meant = "".join(f"; is {original.with_name(name)} meant?" for name in nearest(original.name, beside))
    return f"there is no {original}: until it is there, every action is answered with 'no model'{meant}"


class Reminder:
    """Names a missing model again and again, and says once that it has come."""

    def __init__(self, model: ModelInUse, now_s: float) -> None:
        self._model, self._due_s = model, now_s + REMINDER_S
        self._missing = lack_of_file(model) is not None

    def lines(self, now_s: float) -> list[str]:
        """Return the line that is due now, where one is."""
        if not self._missing:
            return []
        lack = lack_of_file(self._model)
        if lack is None:
            self._missing = False
            return [f"{self._model.original} is there now and is used"]
        if now_s < self._due_s:
            return []
        self._due_s = now_s + REMINDER_S
        return [lack]
