"""What every trained recogniser is, whatever it is made of: a description, arrays, and answers."""

import hashlib
import json
import os
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from actum.skeletons import JOINTS
from som_classifier.recognition import Recognition
from som_classifier.streams import Frame

Arrays = Mapping[str, NDArray[Any]]


class Description(BaseModel):
    """What a model is, beside its weights.

    Attributes:
        kind: which of the recognisers it is.
        data_digest: SHA-256 over the training samples.
        held_out: of samples scored without their person, or without themselves where that was the only one: by action
            done how many were taken for which. Empty where the kind of recogniser holds nothing out.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    format: Literal["actum.model/1"] = "actum.model/1"
    kind: str
    labels: Annotated[list[str], Field(min_length=1)]
    joint_order: list[str] = list(JOINTS)
    preset: str
    parameters: dict[str, Any]
    seed: int
    persons: list[str]
    samples: int
    data_digest: str
    actum_version: str
    held_out: dict[str, dict[str, int]] = {}

    @property
    def held_out_answers(self) -> list[tuple[str, str]]:
        """The same as one pair of action done and action answered for each sample."""
        return [
            (done, answered)
            for done, answers in self.held_out.items()
            for answered, n in answers.items()
            for _ in range(n)
        ]


class Encoder(Protocol):
    """Reads one agent's frames in their order, for one model."""

    def encode(self, frame: Frame) -> Any:
        """Return what the model will need of a valid frame."""
        ...


class Model(ABC):
    """A trained recogniser."""

    min_frames: ClassVar[int] = 3

    @property
    @abstractmethod
    def about(self) -> Description:
        """What it is."""

    @property
    @abstractmethod
    def arrays(self) -> Arrays:
        """All its weights, by name, in a fixed order."""

    @classmethod
    @abstractmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "Model":
        """Put together what `metadata` and `arrays` gave.

        Raises:
            ValueError, KeyError: the parts are not there or do not fit together.
        """

    @abstractmethod
    def encoder(self) -> Encoder:
        """Begin to read an agent."""

    @abstractmethod
    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Say which action a segment is.

        Args:
            frames: its valid frames in order, each with the code its encoder gave.
            complete: whether the segment has ended; else more frames will come.

        Raises:
            ValueError: there is no frame.
        """

    @abstractmethod
    def trace(self, frames: Sequence[Frame]) -> NDArray[np.float64]:
        """Return the way over the first map, row and column of winners or of centres of activity, shape (n, 2)."""

    @abstractmethod
    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of each map over a whole segment, by name, each (rows, cols) within [0, 1]."""

    @property
    def labels(self) -> list[str]:
        """The actions it tells apart."""
        return self.about.labels

    @property
    def metadata(self) -> dict[str, Any]:
        """The description as plain values."""
        return self.about.model_dump()

    @cached_property
    def id(self) -> str:
        """The first 12 hex digits of a SHA-256 over description and weights."""
        digest = hashlib.sha256(self._description().encode())
        for name, array in self.arrays.items():
            digest.update(f"{name} {array.shape} {array.dtype.str}".encode())
            digest.update(array.tobytes())
        return digest.hexdigest()[:12]

    def save(self, path: Path) -> None:
        """Write the file (npz, no pickle) beside its place and move it there in one step."""
        contents: dict[str, NDArray[Any]] = {"metadata": np.array(self._description()), **self.arrays}
        unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
        try:
            with unfinished.open("wb") as file:
                np.savez(file, allow_pickle=False, **contents)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)

    def _description(self) -> str:
        return json.dumps(self.metadata, sort_keys=True)
