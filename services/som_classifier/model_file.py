"""A model file that may appear, change or be damaged while the classifier runs."""

from pathlib import Path

from actum.node import Tally
from som_classifier.model import Model
from som_classifier.storage import ModelError, load_model


class ModelFile:
    """Loads the file whenever it has changed."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._seen: tuple[int, int] | None = None

    def poll(self, tally: Tally) -> Model | None:
        """Return the model if the file is new or changed and sound; count `bad_model` where it is not."""
        try:
            stat = self._path.stat()
        except FileNotFoundError:
            return None
        except OSError as error:
            tally.reject("bad_model", str(error))
            return None
        version = (stat.st_mtime_ns, stat.st_size)
        if version == self._seen:
            return None
        self._seen = version
        try:
            return load_model(self._path)
        except ModelError as error:
            tally.reject("bad_model", str(error))
            return None
