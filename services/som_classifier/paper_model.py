"""The paper's recogniser: three layers, one after the other (Gharaee, Gärdenfors and Johnsson, 2017, section 2.1)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from actum.arrays import Array
from actum.skeletons import JOINTS
from actum.som import Som
from som_classifier.attention import PART_NAMES, Axes, Origin, PostureInput
from som_classifier.frames import Frame
from som_classifier.map_activity import NO_WINNER, MapActivity, map_activity, ordered_vector, soft_activity, trajectory
from som_classifier.map_continuation import MapContinuation
from som_classifier.model import Arrays, Encoder, Model, ModelMetadata, Recognition
from som_classifier.supervised import SupervisedLayer

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class PaperMetadata(ModelMetadata):
    """What a file of the paper's recogniser holds beside the weights; field names are keys of the stored JSON.

    Attributes:
        axes, origin, attention: the first map's input, see `PostureInput`.
        centre_contrast: of the first map's soft activity, in squared metres.
        points: the length of an ordered vector in points: the paper's N_max.
        contrast: of the second map's soft activity, in squared grid units of the first map.
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
        """The first map's input."""
        return PostureInput(self.axes, self.origin, self.attention)


@dataclass(frozen=True, eq=False)
class PaperModel(Model):
    """The paper's three layers, trained. `confidence` is a share of cosines, not a calibrated probability.

    Attributes:
        layer1: the map of postures, or of one part's.
        layer2: the map of ordered vectors.
        layer3: one neuron per label on the second map's activity.
        metadata: what is stored beside the weights.
        continuation: how a posture goes on; None where the model was not trained for that.
    """

    layer1: Som
    layer2: Som
    layer3: SupervisedLayer
    metadata: PaperMetadata
    continuation: MapContinuation | None = None

    def __post_init__(self) -> None:
        if problem := self._mismatch():
            raise ValueError(problem)

    @property
    def arrays(self) -> Arrays:
        """All weights by the names they are stored under, maps as component planes (rows, cols, dim)."""
        weights = {"layer1": self.layer1.planes, "layer2": self.layer2.planes, "layer3": self.layer3.weights}
        return weights if self.continuation is None else {**weights, **self.continuation.arrays}

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "PaperModel":
        """Build the model of a file's metadata (JSON) and arrays.

        Raises:
            ValueError, KeyError: fields or arrays are missing or do not fit together.
        """
        stored = PaperMetadata.model_validate_json(metadata)
        layer1, layer2 = Som.of_planes(arrays["layer1"]), Som.of_planes(arrays["layer2"])
        continuation = MapContinuation.restored(layer1, stored.centre_contrast, stored.posture, arrays)
        return cls(layer1, layer2, SupervisedLayer(arrays["layer3"]), stored, continuation)

    def encoder(self) -> Encoder:
        """Return a new encoder, for one agent."""
        return _FrameEncoder(self)

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Recognise the action of a segment's frames so far; the same whether it is complete or not.

        Raises:
            ValueError: there is no frame.
        """
        if not frames:
            raise ValueError("the segment contains no frame, so no action can be recognised: give at least one frame")
        part, attended = self.attended(frames)
        cosines = self.layer3.cosines(self._second_activity(trajectory(attended))).tolist()
        winner = int(np.argmax(cosines))
        positive = sum(max(cosine, 0.0) for cosine in cosines)
        share = max(cosines[winner], 0.0) / positive if positive > 0 else 0.0
        return Recognition(
            label=self.labels[winner],
            confidence=share * float((attended.winners != NO_WINNER).mean()),
            activations=dict(zip(self.labels, cosines, strict=True)),
            part=PART_NAMES[part],
        )

    def first_activity(self, joints: Array, upright: Array) -> MapActivity:
        """Return the first map's activity for one frame, for each part that attention may choose, (choices,).

        Args:
            joints: (15, 3), along the axes of the posture.
            upright: (15, 3), upright.
        """
        rows = self.metadata.posture.rows(joints, upright)
        return map_activity(self.layer1, rows, self.metadata.centre_contrast)

    def attended(self, frames: Sequence[Frame]) -> tuple[int, MapActivity]:
        """Return the part attended to over a segment, and the first map's activity for it at each frame, (n,)."""
        activities: list[MapActivity] = [frame.activity for frame in frames]
        winners = np.stack([activity.winners for activity in activities])
        centres = np.stack([activity.centres for activity in activities])
        motion = np.array([frame.motion for frame in frames])
        part, row = self.metadata.posture.attended(motion, (winners != NO_WINNER).any(axis=0))
        return part, MapActivity(winners, centres)[:, row]

    def trace(self, frames: Sequence[Frame]) -> Array:
        """Return the trajectory of the centre of activity over the first map, shape (changes, 2)."""
        return trajectory(self.attended(frames)[1])

    def action_unit(self, frames: Sequence[Frame]) -> int:
        """Return the second map's winner for a segment."""
        return self.layer2.bmu(ordered_vector(self.trace(frames), self.metadata.points))

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of the second map, by its name, (rows, cols)."""
        return {"actions": self._second_activity(self.trace(frames)).reshape(self.layer2.rows, self.layer2.cols)}

    def _second_activity(self, path: Array) -> Array:
        """Return the second map's soft activity for a trajectory (n, 2), shape (units,)."""
        excess2 = self.layer2.excess2(ordered_vector(path, self.metadata.points))
        activity: Array = soft_activity(excess2, self.metadata.contrast)
        return activity

    def _mismatch(self) -> str | None:
        """Return the first inconsistency between metadata and layers, None where there is none."""
        stored = self.metadata
        neurons = len(self.layer2.weights)
        if stored.joint_order != list(JOINTS):
            return "its joint order is not this version's"
        sizes = stored.posture.size, 2 * stored.points
        if (self.layer1.dim, self.layer2.dim) != sizes:
            return f"its maps take vectors of {self.layer1.dim} and {self.layer2.dim}, not of {sizes[0]} and {sizes[1]}"
        if len(set(stored.labels)) < len(stored.labels) or self.layer3.weights.shape != (len(stored.labels), neurons):
            return f"its third layer {self.layer3.weights.shape} does not fit {len(stored.labels)} labels"
        return None


class _FrameEncoder:
    """Computes the first map's activity for each frame by itself."""

    def __init__(self, model: PaperModel) -> None:
        self._model = model

    def encode(self, frame: Frame) -> MapActivity:
        """Return the first map's activity for a valid frame."""
        assert frame.joints is not None and frame.kinematics is not None
        return self._model.first_activity(frame.joints, frame.kinematics.posture)
