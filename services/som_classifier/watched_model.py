"""A model file that may appear, change or be damaged while the classifier runs, loaded whenever it changes."""

from pathlib import Path

from actum.node import Counters
from actum.states import State
from som_classifier.model import Model
from som_classifier.model_loading import ModelError, load_model


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
        return model

    def _refuse(self, counters: Counters, why: str) -> None:
        counters.reject("bad_model", why)
        counters.state = (State.MODEL_NOT_RENEWED if self._loaded else State.NO_MODEL).because(why)
