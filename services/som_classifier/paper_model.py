"""The paper's recogniser: three layers, one after the other (Gharaee, Gärdenfors and Johnsson, 2017, section 2.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from actum.skeletons import JOINTS, PARTS
from actum.som import Som
from som_classifier.attention import PART_NAMES, UNSEEN, attended, winners
from som_classifier.model import Arrays, Description, Encoder, Model
from som_classifier.recognition import Recognition
from som_classifier.streams import Frame
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import ordered_vector, without_repeats

Array = NDArray[np.float64]


class PaperDescription(Description):
    """What a model of this kind is.

    Attributes:
        points: the length of an ordered vector in points: the paper's N_max.
        contrast: of the second map's activity, in squared grid units of the first map.
        part: the body part attended to, or None for the one that moves most.
    """

    kind: Literal["paper"] = "paper"
    points: Annotated[int, Field(ge=2)]
    contrast: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    part: str | None


@dataclass(frozen=True, eq=False)
class PaperModel(Model):
    """The paper's three layers, trained. `confidence` is a share of cosines, not a calibrated probability.

    Attributes:
        layer1: the map of postures, on one part's joints.
        layer2: the map of ordered vectors.
        layer3: one neuron per label on the second map's activity.
    """

    layer1: Som
    layer2: Som
    layer3: SupervisedLayer
    description: PaperDescription

    def __post_init__(self) -> None:
        if problem := self._mismatch():
            raise ValueError(problem)

    @property
    def about(self) -> Description:
        """What it is."""
        return self.description

    @property
    def arrays(self) -> Arrays:
        """All its weights, maps as component planes."""
        return {"layer1": self.layer1.planes, "layer2": self.layer2.planes, "layer3": self.layer3.weights}

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "PaperModel":
        """Put together what `metadata` and `arrays` gave.

        Raises:
            ValueError, KeyError: the parts are not there or do not fit together.
        """
        description = PaperDescription.model_validate_json(metadata)
        layer3 = SupervisedLayer(arrays["layer3"])
        return cls(Som.of_planes(arrays["layer1"]), Som.of_planes(arrays["layer2"]), layer3, description)

    def encoder(self) -> Encoder:
        """Begin to read an agent."""
        return _Winners(self)

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Say which action a segment's frames so far are; the same whether it is complete or not.

        Raises:
            ValueError: there is no frame.
        """
        if not frames:
            raise ValueError("no frame to recognise an action from")
        return self.classify(*_cells_and_motion(frames))

    def trace(self, frames: Sequence[Frame]) -> Array:
        """Return the way of the part attended to over the first map, repeats removed, shape (n, 2)."""
        return self.way(*_cells_and_motion(frames))

    def cells(self, joints: Array) -> NDArray[np.intp]:
        """Return the first map's winner for each of the five parts, shape (5,), for one frame's joints (15, 3)."""
        return winners(self.layer1, joints)

    def classify(self, cells: NDArray[np.intp], motion: Array) -> Recognition:
        """Recognise from winners and motion.

        Args:
            cells: (n, 5), from `cells`, valid frames only, n > 0.
            motion: (n, 5), metres since the frame before.

        Raises:
            ValueError: there is no frame.
        """
        if not len(cells):
            raise ValueError("no frame to recognise an action from")
        part = self._part(cells, motion)
        excess2 = self.layer2.excess2(ordered_vector(self._way(cells[:, part]), self.description.points))
        cosines = self.layer3.cosines(activity(excess2, self.description.contrast)).tolist()
        winner = int(np.argmax(cosines))
        return Recognition(
            label=self.labels[winner],
            confidence=_share(cosines, winner) * float((cells[:, part] != UNSEEN).mean()),
            activations=dict(zip(self.labels, cosines, strict=True)),
            part=PART_NAMES[part],
        )

    def way(self, cells: NDArray[np.intp], motion: Array) -> Array:
        """Return the trace of what `classify` takes, shape (n, 2)."""
        return self._way(cells[:, self._part(cells, motion)])

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of the second map."""
        excess2 = self.layer2.excess2(ordered_vector(self.trace(frames), self.description.points))
        return {"actions": activity(excess2, self.description.contrast).reshape(self.layer2.rows, self.layer2.cols)}

    def _part(self, cells: NDArray[np.intp], motion: Array) -> int:
        return attended(motion, self.description.part, (cells != UNSEEN).any(axis=0))

    def _way(self, seen: NDArray[np.intp]) -> Array:
        coordinates: Array = self.layer1.coordinates[without_repeats(seen[seen != UNSEEN])]
        return coordinates

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


class _Winners:
    """Each frame's best matching units."""

    def __init__(self, model: PaperModel) -> None:
        self._model = model

    def encode(self, frame: Frame) -> Any:
        assert frame.joints is not None
        return self._model.cells(frame.joints)


def _cells_and_motion(frames: Sequence[Frame]) -> tuple[NDArray[np.intp], Array]:
    return np.array([frame.code for frame in frames]), np.array([frame.motion for frame in frames])


def _share(cosines: list[float], winner: int) -> float:
    """Return the winner's share of the positive cosines, 0 where none is positive."""
    positive = sum(max(cosine, 0.0) for cosine in cosines)
    return max(cosines[winner], 0.0) / positive if positive > 0 else 0.0
