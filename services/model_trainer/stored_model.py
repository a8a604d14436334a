"""What is listed of a model, and the file beside it that says so."""

import re
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, FiniteFloat

from model_trainer.small_files import small_file

ID = re.compile("[0-9a-f]{12}")
"""The form of a model's id, after which its file is named."""


class About(BaseModel):
    """What stands beside a model's file.

    Attributes:
        created: when its training began, or when it came from elsewhere (ISO 8601).
        set: the set that it was trained on; empty where that is not known.
        labels: its actions.
        people: whose examples it was trained on.
        samples: the number of examples.
        scores: its known scores, by name.
    """

    model_config = ConfigDict(strict=True)

    created: str
    set: str
    labels: list[str]
    people: list[str]
    samples: int
    scores: dict[str, FiniteFloat]


class StoredModel(About):
    """What is listed of a model in a file."""

    path: Path = Field(exclude=True)

    @property
    def id(self) -> str:
        """Its name: a digest of all it holds."""
        return self.path.stem


def described(path: Path) -> StoredModel | None:
    """Read what stands beside a model; None where nothing does that can be read."""
    if ID.fullmatch(path.stem) is None:
        return None
    try:
        return stored(path, About.model_validate_json(small_file(path.with_suffix(".json"))))
    except (OSError, ValueError):
        return None


def stored(path: Path, about: About) -> StoredModel:
    """Return what is listed of the model in a file."""
    return StoredModel(path=path, **about.model_dump())
