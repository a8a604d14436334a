"""The paper's recogniser: three layers, one after the other (Gharaee, Gärdenfors and Johnsson, 2017, section 2.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from actum.skeletons import JOINTS
from actum.som import Som
from som_classifier.attention import PART_NAMES, Axes, Origin, PostureInput
from som_classifier.model import Arrays, Description, Encoder, Model
from som_classifier.recognition import Recognition
from som_classifier.streams import Frame
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import UNSEEN, Activities, activities, ordered_vector, way

Array = NDArray[np.float64]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class PaperDescription(Description):
    """What a model of this kind is.

    Attributes:
        axes, origin, attention: what the first map is shown.
        centre_contrast: of the first map's activity, in squared metres.
        points: the length of an ordered vector in points: the paper's N_max.
        contrast: of the second map's activity, in squared grid units of the first map.
    """

    kind: Literal["paper"] = "paper"
    axes: Axes
    origin: Origin
    attention: str
    centre_contrast: Positive
    points: Annotated[int, Field(ge=2)]
    contrast: Positive

    @model_validator(mode="after")
    def _of_its_kind(self) -> Self:
        _ = self.posture
        return self

    @cached_property
    def posture(self) -> PostureInput:
        """What the first map is shown."""
        return PostureInput(self.axes, self.origin, self.attention)


@dataclass(frozen=True, eq=False)
class PaperModel(Model):
    """The paper's three layers, trained. `confidence` is a share of cosines, not a calibrated probability.

    Attributes:
        layer1: the map of postures, or of one part's.
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
        return _Looking(self)

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Say which action a segment's frames so far are; the same whether it is complete or not.

        Raises:
            ValueError: there is no frame.
        """
        if not frames:
            raise ValueError("no frame to recognise an action from")
        part, seen = self.attended(frames)
        cosines = self.layer3.cosines(self._heard(way(seen))).tolist()
        winner = int(np.argmax(cosines))
        return Recognition(
            label=self.labels[winner],
            confidence=_share(cosines, winner) * float((seen.winners != UNSEEN).mean()),
            activations=dict(zip(self.labels, cosines, strict=True)),
            part=PART_NAMES[part],
        )

    def look(self, joints: Array, upright: Array) -> Activities:
        """Return where one frame's inputs make the first map active, of all that attention chooses among.

        Args:
            joints: (15, 3), along the axes of the posture.
            upright: (15, 3), upright.
        """
        rows = self.description.posture.rows(joints, upright)
        return activities(self.layer1, rows, self.description.centre_contrast)

    def attended(self, frames: Sequence[Frame]) -> tuple[int, Activities]:
        """Return the part attended to, and the first map's activities at each frame of a segment, (n,)."""
        codes: list[Activities] = [frame.code for frame in frames]
        seen = Activities(np.stack([code.winners for code in codes]), np.stack([code.centres for code in codes]))
        motion = np.array([frame.motion for frame in frames])
        part, row = self.description.posture.attended(motion, (seen.winners != UNSEEN).any(axis=0))
        return part, seen[:, row]

    def trace(self, frames: Sequence[Frame]) -> Array:
        """Return the way of the activity's centre over the first map, shape (stays, 2)."""
        return way(self.attended(frames)[1])

    def place(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner."""
        return self.layer2.bmu(ordered_vector(self.trace(frames), self.description.points))

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of the second map."""
        return {"actions": self._heard(self.trace(frames)).reshape(self.layer2.rows, self.layer2.cols)}

    def _heard(self, path: Array) -> Array:
        excess2 = self.layer2.excess2(ordered_vector(path, self.description.points))
        heard: Array = activity(excess2, self.description.contrast)
        return heard

    def _mismatch(self) -> str | None:
        """Name the first thing about the layers that does not fit together."""
        about = self.description
        neurons = len(self.layer2.weights)
        if about.joint_order != list(JOINTS):
            return "its joint order is not this version's"
        sizes = about.posture.size, 2 * about.points
        if (self.layer1.dim, self.layer2.dim) != sizes:
            return f"its maps take vectors of {self.layer1.dim} and {self.layer2.dim}, not of {sizes[0]} and {sizes[1]}"
        if len(set(about.labels)) < len(about.labels) or self.layer3.weights.shape != (len(about.labels), neurons):
            return f"its third layer {self.layer3.weights.shape} does not fit {len(about.labels)} labels"
        return None


class _Looking:
    """Each frame's activities."""

    def __init__(self, model: PaperModel) -> None:
        self._model = model

    def encode(self, frame: Frame) -> Activities:
        assert frame.joints is not None and frame.movement is not None
        return self._model.look(frame.joints, frame.movement.posture)


def _share(cosines: list[float], winner: int) -> float:
    """Return the winner's share of the positive cosines, 0 where none is positive."""
    positive = sum(max(cosine, 0.0) for cosine in cosines)
    return max(cosines[winner], 0.0) / positive if positive > 0 else 0.0
