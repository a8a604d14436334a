"""Loads a model file, whichever recogniser it holds, or says what is wrong with it."""

import json
import zipfile
from pathlib import Path
from typing import IO

import numpy as np
from pydantic import ValidationError

from actum.som.storage import UNREADABLE, refuse_bomb
from som_classifier.model import Arrays, Model
from som_classifier.paper_model import PaperModel
from som_classifier.pyramid_model import PyramidModel

KINDS: dict[str, type[Model]] = {"paper": PaperModel, "pyramid": PyramidModel}


class ModelError(ValueError):
    """A file that no model can be loaded from; the text names the file, the problem and what to do."""

    def __init__(self, path: Path, problem: str) -> None:
        super().__init__(f"{path}: {problem}; train a model with 'actum train REC… -o MODEL'")


def load_model(path: Path) -> Model:
    """Load the model from a file that `Model.save` wrote.

    Raises:
        ModelError: the file is missing, foreign, damaged, or made for another joint order.
    """
    try:
        if path.exists() and not path.is_file():
            raise ModelError(path, "it is not a file")
        with path.open("rb") as stored:
            metadata, arrays = _parts(path, stored)
        kind = json.loads(metadata).get("kind")
        if kind not in KINDS:
            raise ModelError(path, f"it is of kind {kind!r}, which this version of actum does not know")
        return KINDS[kind].restored(metadata, arrays)
    except ModelError:
        raise
    except FileNotFoundError:
        raise ModelError(path, "the file does not exist") from None
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise ModelError(path, f"it is not a model of actum (metadata {field}: {first['msg']})") from None
    except (*UNREADABLE, AttributeError) as error:
        raise ModelError(path, f"it is not a model of actum, or it is damaged ({error})") from None


def _parts(path: Path, stored: IO[bytes]) -> tuple[str, Arrays]:
    """Return the metadata as JSON, and the arrays by name."""
    if not zipfile.is_zipfile(stored):  # NumPy's own error would advise to read it as a pickle
        raise ModelError(path, "it is not a model of actum, or it is damaged")
    refuse_bomb(stored)
    with np.load(stored, allow_pickle=False) as file:
        return str(file["metadata"]), {name: file[name] for name in file.files if name != "metadata"}
