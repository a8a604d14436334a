"""The default recogniser: maps of posture, velocity and arm, pooled over a segment, told apart, laid out on a map."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from actum.node import SECOND_NS
from actum.skeletons import JOINTS
from actum.som import Som
from som_classifier.codes import Code, FrameEncoder, left_handed, mean_log_error, most_moved_part, seen_share, trail_of
from som_classifier.layers import ARM_INPUTS, HEARD, Concepts, FirstMaps
from som_classifier.model import Arrays, Description, Model
from som_classifier.pyramid import Pyramid, Trail
from som_classifier.recognition import Recognition
from som_classifier.stages import Stages, familiarity_of
from som_classifier.streams import Frame
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import without_repeats

Floats = NDArray[Any]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class PyramidDescription(Description):
    """What a model of this kind is.

    Attributes:
        posture_contrast: of the posture map's activity, in squared metres.
        velocity_contrast: of the velocity map's activity.
        arm_contrast: of the activity of the map of arms.
        arm_shares: what the latter adds up to, for the acting arm and for the other one.
        mirrors: whether an action of the left arm is read in a mirror.
        levels: the pyramid's cells on each level.
        overlap: how far each reaches over its borders, in parts of its length.
        fractions: the share of an action that each stage of the discriminant axes has seen.
        log_duration_mean: mean of the logarithm of the training segments' durations (s).
        log_duration_sd: their standard deviation.
        concept_contrast: of the second map's activity, in squared scores.
        gains: what makes cosines logits, by stage.
        familiar: the familiarity below which an action may be none of those trained.
        usual_log_errors: for each action, to what mean log(d²) of its postures from the map of postures a stranger who
            does it may well come, d in metres over all joints of a standard body.
    """

    kind: Literal["pyramid"] = "pyramid"
    posture_contrast: Positive
    velocity_contrast: Positive
    arm_contrast: Positive
    arm_shares: Annotated[list[Positive], Field(min_length=2, max_length=2)]
    mirrors: bool
    levels: Annotated[list[Annotated[int, Field(ge=1)]], Field(min_length=1)]
    overlap: Annotated[float, Field(ge=0, le=1)]
    fractions: Annotated[list[Annotated[float, Field(gt=0, le=1)]], Field(min_length=1)]
    log_duration_mean: Finite
    log_duration_sd: Positive
    concept_contrast: Positive
    gains: list[Positive]
    familiar: Finite
    usual_log_errors: list[Finite]


@dataclass(frozen=True, eq=False)
class PyramidModel(Model):
    """The trained layers. `confidence` is a probability, calibrated on people left out of training.

    Attributes:
        first: the maps of posture, velocity and the acting arm.
        stages: the discriminant axes on their pooled activities.
        concepts: the map of actions.
        layer3: one neuron per label on its activity.
    """

    first: FirstMaps
    stages: Stages
    concepts: Concepts
    layer3: SupervisedLayer
    description: PyramidDescription

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
        return {
            "postures": self.first.postures.planes,
            "velocities": self.first.velocities.planes,
            "arms": self.first.arms.planes,
            "axes": self.stages.axes,
            "offsets": self.stages.offsets,
            "concepts": self.concepts.layout.planes,
            "concept_mean": self.concepts.mean,
            "layer3": self.layer3.weights,
        }

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "PyramidModel":
        """Put together what `metadata` and `arrays` gave.

        Raises:
            ValueError, KeyError: the parts are not there or do not fit together.
        """
        about = PyramidDescription.model_validate_json(metadata)
        layout = Som.of_planes(arrays["concepts"])
        postures, velocities, arms = (Som.of_planes(arrays[name]) for name in ("postures", "velocities", "arms"))
        contrasts = about.posture_contrast, about.velocity_contrast, about.arm_contrast
        durations = about.log_duration_mean, about.log_duration_sd
        return cls(
            FirstMaps(postures, velocities, arms, contrasts, (about.arm_shares[0], about.arm_shares[1])),
            Stages(arrays["axes"], arrays["offsets"], tuple(about.fractions), *durations),
            Concepts(layout, about.concept_contrast, arrays["concept_mean"]),
            SupervisedLayer(arrays["layer3"]),
            about,
        )

    @cached_property
    def pyramid(self) -> Pyramid:
        """How activities are pooled over a segment."""
        return Pyramid(tuple(self.description.levels), self.description.overlap)

    def encoder(self) -> FrameEncoder:
        """Begin to read an agent."""
        return FrameEncoder(self.first)

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Say which action a segment is.

        Raises:
            ValueError: there is no frame.
        """
        if not frames:
            raise ValueError("no frame to recognise an action from")
        codes: list[Code] = [frame.code for frame in frames]
        weights = self.stages.weights((frames[-1].stamp_ns - frames[0].stamp_ns) / SECOND_NS, complete)
        scores = self.scores(codes, weights)
        cosines = self.layer3.cosines(self.concepts.activity(scores))
        winner = int(cosines.argmax())
        gain = sum(weight * gain for weight, gain in zip(weights, self.description.gains, strict=True))
        familiarity = self.familiarity(codes, scores)
        return Recognition(
            label=self.labels[winner],
            confidence=_probability(cosines, winner, gain * seen_share(codes)),
            activations=dict(zip(self.labels, cosines.tolist(), strict=True)),
            part=most_moved_part(codes),
            familiarity=familiarity,
            unknown=complete and familiarity < self.description.familiar,
        )

    def trail(self, codes: Sequence[Code]) -> Trail:
        """Return a segment's running sums, of the actor as seen or in a mirror."""
        return trail_of(codes, self.reads_in_mirror(codes))

    def reads_in_mirror(self, codes: Sequence[Code]) -> bool:
        """Tell whether a segment is read as its mirror image, because the left arm acts."""
        return self.description.mirrors and left_handed(codes)

    def winners(self, frames: Sequence[Frame]) -> NDArray[np.intp]:
        """Return the posture map's winner at each frame, of the actor as seen or in a mirror, shape (n,)."""
        codes: list[Code] = [frame.code for frame in frames]
        side = int(self.reads_in_mirror(codes))
        return np.array([code.winners[side] for code in codes], dtype=np.intp)

    def trace(self, frames: Sequence[Frame]) -> NDArray[np.float64]:
        """Return row and column of the posture map's winners, repeats removed, shape (n, 2)."""
        coordinates: NDArray[np.float64] = self.first.postures.coordinates
        return coordinates[without_repeats(self.winners(frames))]

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the mean activity of the first maps, relative to the most active unit's, and that of actions."""
        codes: list[Code] = [frame.code for frame in frames]
        scores = self.scores(codes, self.stages.weights(0.0, complete=True))
        seen = self.trail(codes)
        sums = seen.gained([len(seen)]).reshape(len(HEARD), -1)[: len(self.first.maps)]
        heard = activity(self.concepts.layout.excess2(scores), self.concepts.contrast)
        layers = zip(
            ("postures", "velocities", "arms"), self.first.maps, sums / sums.max(axis=1, keepdims=True), strict=True
        )
        first = {name: own.reshape(som.rows, som.cols) for name, som, own in layers}
        return first | {"actions": heard.reshape(self.concepts.layout.rows, self.concepts.layout.cols)}

    def familiarity(self, codes: Sequence[Code], scores: NDArray[np.float32]) -> float:
        """Return how much a segment with these scores is like an action that was trained."""
        log_error = mean_log_error(codes, self.reads_in_mirror(codes))
        return familiarity_of(scores, log_error, self.description.usual_log_errors)

    def scores(self, codes: Sequence[Code], weights: Sequence[float]) -> NDArray[np.float32]:
        """Return the actions' scores on the discriminant axes of the stages that the weights name."""
        return self.stages.scores(self.pyramid.vector(self.trail(codes)), weights)

    def _mismatch(self) -> str | None:
        """Name the first thing about the layers that does not fit together."""
        about, first, layout = self.description, self.first, self.concepts.layout
        actions, stages, inputs = len(about.labels), len(about.fractions), self.pyramid.cells * first.units
        if about.joint_order != list(JOINTS):
            return "its joint order is not this version's"
        if len({som.dtype for som in first.maps}) > 1:
            return "its maps are not of the same precision"
        if len(set(about.labels)) < actions or len(about.gains) != stages or len(about.usual_log_errors) != actions:
            return "its labels or its stages do not fit together"
        loose = (self.stages.axes, self.stages.offsets, self.concepts.mean)
        if not all(array.dtype == np.float32 and np.isfinite(array).all() for array in loose):
            return "its axes, their offsets or its mean are not finite single-precision numbers"
        shapes = {
            "maps of the first layer": ({len(som.weights) for som in first.maps}, {len(first.postures.weights)}),
            "map of postures": (first.postures.weights.shape[1:], (3 * len(JOINTS),)),
            "map of velocities": (first.velocities.weights.shape[1:], (3 * len(JOINTS),)),
            "map of arms": (first.arms.weights.shape[1:], (ARM_INPUTS,)),
            "discriminant axes": (self.stages.axes.shape, (stages, inputs, actions)),
            "offsets of them": (self.stages.offsets.shape, (stages, actions)),
            "map of actions": (layout.weights.shape[1:], (actions,)),
            "its mean": (self.concepts.mean.shape, (len(layout.weights),)),
            "third layer": (self.layer3.weights.shape, (actions, len(layout.weights))),
        }
        wrong = (
            f"its {name} is of shape {has}, not {should}" for name, (has, should) in shapes.items() if has != should
        )
        return next(wrong, None)


def _probability(cosines: Floats, winner: int, gain: float) -> float:
    """Return the winner's share of the softmax of gain × cosines."""
    return float(1.0 / np.exp(gain * (cosines - cosines[winner])).sum())
