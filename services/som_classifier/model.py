"""A trained recogniser: three layers, what they were trained with, and its file."""

import hashlib
import json
import os
import zipfile
import zlib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from actum.skeletons import JOINTS, PARTS
from actum.som import Som
from som_classifier.attention import PART_NAMES, attended, part_inputs
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import ordered_vector, without_repeats

Array = NDArray[np.float64]

LAYERS = ("layer1", "layer2", "layer3")
UNREADABLE = (
    OSError, ValueError, TypeError, EOFError, KeyError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip
"""What NumPy and zipfile are known to raise on files that are not theirs or were cut or altered."""


class ModelError(ValueError):
    """A file that is no sound model of ours."""

    def __init__(self, path: Path, problem: str) -> None:
        super().__init__(f"{path}: {problem}; train a model with: actum train REC… -o MODEL")


class Description(BaseModel):
    """What a model is, beside its weights.

    Attributes:
        points: the length of an ordered vector in points: the paper's N_max.
        contrast: of the second map's activity, in squared grid units of the first map.
        part: the body part attended to, or None for the one that moves most.
        data_digest: SHA-256 over the training samples.
    """

    model_config = ConfigDict(frozen=True, extra="ignore", strict=True)

    format: Literal["actum.model/1"] = "actum.model/1"
    labels: Annotated[list[str], Field(min_length=1)]
    points: Annotated[int, Field(ge=2)]
    contrast: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    part: str | None
    joint_order: list[str] = list(JOINTS)
    preset: str
    parameters: dict[str, Any]
    seed: int
    persons: list[str]
    samples: int
    data_digest: str
    actum_version: str


@dataclass(frozen=True)
class Recognition:
    """What a segment's frames so far are taken to be.

    Attributes:
        label: the action whose neuron answers most.
        confidence: that neuron's share of all positive cosines, within [0, 1]; not a calibrated probability.
        activations: every neuron's cosine by action.
        part: the body part attended to.
        trace: (n, 2), row and column of the first map's winners, repeats removed.
    """

    label: str
    confidence: float
    activations: dict[str, float]
    part: str
    trace: Array


@dataclass(frozen=True, eq=False)
class Model:
    """The paper's three layers, trained.

    Attributes:
        layer1: the map of postures, on one part's joints.
        layer2: the map of ordered vectors.
        layer3: one neuron per label on the second map's activity.
    """

    layer1: Som
    layer2: Som
    layer3: SupervisedLayer
    description: Description

    min_frames: ClassVar[int] = 3

    def __post_init__(self) -> None:
        if problem := self._mismatch():
            raise ValueError(problem)

    @property
    def labels(self) -> list[str]:
        """The actions it tells apart."""
        return self.description.labels

    @property
    def metadata(self) -> dict[str, Any]:
        """The description as plain values."""
        return self.description.model_dump()

    @cached_property
    def id(self) -> str:
        """The first 12 hex digits of a SHA-256 over description and weights."""
        digest = hashlib.sha256(self._description_json().encode())
        for name, array in self._arrays().items():
            digest.update(f"{name} {array.shape} {array.dtype.str}".encode())
            digest.update(array.tobytes())
        return digest.hexdigest()[:12]

    def cells(self, joints: Array) -> NDArray[np.intp]:
        """Return the first map's winner for each of the five parts, shape (5,), for one frame's joints (15, 3).

        One matrix product of always the same shape, so that live and replayed frames agree to the bit.
        """
        return self.layer1.bmus(part_inputs(joints))

    def recognise(self, cells: NDArray[np.intp], motion: Array) -> Recognition:
        """Say which action a segment's frames so far are.

        Args:
            cells: (n, 5), from `cells`, valid frames only, n > 0.
            motion: (n, 5), metres since the frame before.

        Raises:
            ValueError: there is no frame.
        """
        if not len(cells):
            raise ValueError("no frame to recognise an action from")
        part = attended(motion, self.description.part)
        trace = self.layer1.coordinates[without_repeats(cells[:, part])]
        excess2 = self.layer2.excess2(ordered_vector(trace, self.description.points))
        cosines = self.layer3.cosines(activity(excess2, self.description.contrast)).tolist()
        winner = int(np.argmax(cosines))
        return Recognition(
            label=self.labels[winner],
            confidence=_share(cosines, winner),
            activations=dict(zip(self.labels, cosines, strict=True)),
            part=PART_NAMES[part],
            trace=trace,
        )

    def save(self, path: Path) -> None:
        """Write the file (npz, no pickle) beside its place and move it there in one step."""
        contents: dict[str, NDArray[Any]] = {"metadata": np.array(self._description_json()), **self._arrays()}
        unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
        try:
            with unfinished.open("wb") as file:
                np.savez(file, allow_pickle=False, **contents)
            unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)

    @classmethod
    def load(cls, path: Path) -> "Model":
        """Read a file that `save` wrote.

        Raises:
            ModelError: the file is missing, foreign, damaged, or made for another joint order.
        """
        try:
            with path.open("rb") as stored, np.load(stored, allow_pickle=False) as file:
                text = str(file["metadata"])
                layer1, layer2, layer3 = (file[name] for name in LAYERS)
            description = Description.model_validate_json(text)
            return cls(_map(layer1), _map(layer2), SupervisedLayer(layer3), description)
        except FileNotFoundError:
            raise ModelError(path, "there is no such file") from None
        except ValidationError as error:
            first = error.errors(include_input=False, include_url=False)[0]
            field = ".".join(str(part) for part in first["loc"])
            raise ModelError(path, f"no actum model: metadata {field}: {first['msg']}") from None
        except UNREADABLE as error:
            raise ModelError(path, f"no actum model, or a damaged one ({error})") from None

    def _arrays(self) -> dict[str, Array]:
        return {
            "layer1": self.layer1.weights.reshape(self.layer1.rows, self.layer1.cols, -1),
            "layer2": self.layer2.weights.reshape(self.layer2.rows, self.layer2.cols, -1),
            "layer3": self.layer3.weights,
        }

    def _description_json(self) -> str:
        return json.dumps(self.metadata, sort_keys=True)

    def _mismatch(self) -> str | None:
        """Name the first thing about the layers that does not fit together."""
        about = self.description
        neurons = len(self.layer2.weights)
        if about.joint_order != list(JOINTS):
            return "its joint order is not this version's"
        if about.part is not None and about.part not in PARTS:
            return f"it attends to {about.part!r}, which is no body part"
        if self.layer1.dim != 9 or self.layer2.dim != 2 * about.points:
            return f"its maps take vectors of {self.layer1.dim} and {self.layer2.dim}, not of 9 and {2 * about.points}"
        if len(set(about.labels)) < len(about.labels) or self.layer3.weights.shape != (len(about.labels), neurons):
            return f"its third layer {self.layer3.weights.shape} does not fit {len(about.labels)} labels"
        return None


def _share(cosines: list[float], winner: int) -> float:
    """Return the winner's share of the positive cosines, 0 where none is positive."""
    positive = sum(max(cosine, 0.0) for cosine in cosines)
    return max(cosines[winner], 0.0) / positive if positive > 0 else 0.0


def _map(weights: Array) -> Som:
    rows, cols, _dim = weights.shape
    return Som(rows, cols, weights.reshape(rows * cols, -1))
