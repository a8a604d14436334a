"""The interface of every trained recogniser: metadata, arrays, and answers."""

import hashlib
import json
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from actum.atomic_file import replaced
from actum.messages import MOST_ACTIONS, Name
from actum.skeletons import JOINTS
from som_classifier.continuation import Continuation
from som_classifier.frames import Frame
from som_classifier.spotting.spotted import Spotter, SpottingMetadata, SpottingOptions

Arrays = Mapping[str, NDArray[Any]]
KEPT = "kept_"
"""How the names of arrays begin that a model file keeps for training alone."""
NOTHING_KEPT: Arrays = MappingProxyType({})
MOST_SAMPLES = 1_000_000
"""Most samples that a file may count in one place of its confusion matrix, each of which is listed."""


@dataclass(frozen=True)
class Recognition:
    """The action recognised in a segment's frames so far.

    Attributes:
        label: the action whose neuron is most active.
        confidence: in the label, within [0, 1]; each kind of model defines it.
        activations: every neuron's cosine by action.
        part: the body part that moves most.
        familiarity: the probability that the segment is a true instance of the label; None where the model cannot tell.
        unknown: whether the action may be none of those trained.
        doubtful: whether it is so unlike its action that it is not published where nobody marked it.
    """

    label: str
    confidence: float
    activations: dict[str, float]
    part: str
    familiarity: float | None = None
    unknown: bool = False
    doubtful: bool = False

    def where_found(self, precision: float) -> "Recognition":
        """Return the answer to a segment that nobody marked.

        Marks are put where an action is done. Of what a search finds, an action is done in this share only, whatever
        the rest looks like.
        """
        return self if self.familiarity is None else replace(self, familiarity=precision * self.familiarity)


class ModelMetadata(BaseModel):
    """What a model file holds beside the weights; field names are keys of the stored JSON.

    Attributes:
        format: of the file.
        kind: which of the recognisers it is.
        labels: the actions it tells apart.
        joint_order: the joints that its inputs consist of.
        preset: name of the set of training parameters.
        parameters: their values.
        seed: of every random number drawn in training.
        persons: the people whose samples it was trained on.
        samples: the number of training samples.
        data_digest: SHA-256 over the training samples.
        actum_version: the version of actum that trained it.
        held_out: confusion counts of cross-validation, by action done and by action answered; each sample is scored
            by discriminants fitted without its person, or without its fold where nobody else did the action. Empty
            where nothing was held out.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    format: Literal["actum.model/1"] = "actum.model/1"
    kind: str
    labels: Annotated[list[Name], Field(min_length=1, max_length=MOST_ACTIONS)]
    joint_order: list[str] = list(JOINTS)
    preset: str
    parameters: dict[str, Any]
    seed: int
    persons: list[str]
    samples: int
    data_digest: str
    actum_version: str
    held_out: dict[str, dict[str, Annotated[int, Field(ge=0, le=MOST_SAMPLES)]]] = {}

    @property
    def held_out_answers(self) -> list[tuple[str, str]]:
        """`held_out` as one pair of action done and action answered for each sample."""
        return [
            (done, answered)
            for done, answers in self.held_out.items()
            for answered, n in answers.items()
            for _ in range(n)
        ]


class Encoder(Protocol):
    """Computes the activity of a model's first layer, for one agent's frames in order, from any of them on.

    What a segment is called must not depend on where the encoder began.
    """

    def encode(self, frame: Frame) -> Any:
        """Return the first layer's activity for a valid frame, to be kept as `Frame.activity`."""
        ...


class Model(ABC):
    """A trained recogniser. One without maps or without a search inherits the methods that return none.

    Attributes:
        metadata: what the file holds beside the weights.
        kept: what the file keeps of the training, so that actions can be added; no part of the model's id. A model
            that was loaded to classify has none.
        continuation: how a posture goes on; None where the model was not trained for that.
        min_frames: the fewest valid frames for which it gives an answer.
    """

    metadata: ModelMetadata
    kept: Arrays = NOTHING_KEPT
    continuation: Continuation | None = None
    min_frames: ClassVar[int] = 3

    @property
    @abstractmethod
    def arrays(self) -> Arrays:
        """All weights by the names they are stored under, in a fixed order."""

    @classmethod
    @abstractmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "Model":
        """Build the model of a file's metadata (JSON) and arrays.

        Raises:
            ValueError, KeyError: fields or arrays are missing or do not fit together.
        """

    @abstractmethod
    def encoder(self) -> Encoder:
        """Return a new encoder, for one agent."""

    @abstractmethod
    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Recognise the action of a segment.

        Args:
            frames: its valid frames in order, each with the activity that its encoder gave.
            complete: whether the segment has ended; else more frames will come.

        Raises:
            ValueError: there is no frame.
        """

    def trace(self, frames: Sequence[Frame]) -> NDArray[np.float64]:
        """Return the trajectory over the first map: row and column of winners or centres of activity, shape (n, 2)."""
        return np.zeros((0, 2))

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of each map over a whole segment, by name, each (rows, cols) within [0, 1]."""
        return {}

    @property
    def spotting(self) -> SpottingMetadata | None:
        """What the model knows of its search for actions; None where the model was not trained for that."""
        return None

    def spotters(self, asked: Sequence[SpottingOptions]) -> list[Spotter]:
        """Return a search of one person's stream for each of these options; none where `spotting` is None.

        The searches are given the same frames, and may share what they compute of a frame.
        """
        return []

    def spotter(self, options: SpottingOptions) -> Spotter | None:
        """Return a search for actions in one person's stream; None where the model was not trained for that."""
        return next(iter(self.spotters([options])), None)

    @property
    def background_s(self) -> float | None:
        """How long (s) people did none of the actions in the training data; None without a search."""
        return None if self.spotting is None else self.spotting.background_s

    @property
    def labels(self) -> list[str]:
        """The actions it tells apart."""
        return self.metadata.labels

    @cached_property
    def id(self) -> str:
        """The first 12 hex digits of a SHA-256 over metadata and weights."""
        digest = hashlib.sha256(self._metadata_json().encode())
        for name, array in self.arrays.items():
            digest.update(f"{name} {array.shape} {array.dtype.str}".encode())
            digest.update(array.tobytes())
        return digest.hexdigest()[:12]

    def save(self, path: Path) -> None:
        """Write the file (npz, no pickle) under a temporary name and rename it in one step.

        Raises:
            OSError: the file cannot be written.
        """
        contents: dict[str, NDArray[Any]] = {"metadata": np.array(self._metadata_json()), **self.arrays, **self.kept}
        with replaced(path) as file:
            np.savez(file, allow_pickle=False, **contents)

    def _metadata_json(self) -> str:
        return json.dumps(self.metadata.model_dump(), sort_keys=True)
