"""The default recogniser: posture, velocity and arm maps, a temporal pyramid, linear discriminants, an action map."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from operator import mul
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum.node import SECOND_NS
from actum.som import Som
from som_classifier.first_layer import CHANNELS, INPUT_SIZES, MAP_INPUTS, Channel, FirstMaps
from som_classifier.frame_activity import (
    FrameActivity,
    FrameEncoder,
    known_joint_share,
    left_handed,
    mean_log_error,
    most_moved_part,
    segment_sums,
)
from som_classifier.frames import Frame
from som_classifier.kinematics import movement_m
from som_classifier.map_activity import soft_activity, without_repeats
from som_classifier.model import Arrays, Model, Recognition
from som_classifier.pyramid import PrefixSums, Pyramid
from som_classifier.pyramid_metadata import PyramidMetadata
from som_classifier.second_layer import ActionMap
from som_classifier.spotting.pyramid_spotter import PoolingOnce, PyramidSpotter
from som_classifier.spotting.spotted import Spotter, SpottingOptions
from som_classifier.spotting.spotting_model import CompletenessHeads, PyramidSpottingMetadata, SpottingModel
from som_classifier.stage_discriminants import StageDiscriminants, familiarity_of
from som_classifier.supervised import SupervisedLayer


@dataclass(frozen=True, eq=False)
class PyramidModel(Model):
    """The trained layers. `confidence` is a probability, calibrated on people left out of training.

    Attributes:
        first: the maps of posture, velocity and the acting arm.
        stages: the discriminants on the maps' pooled activities.
        action_map: the second layer, a map of the discriminants' scores.
        layer3: one neuron per action on the second layer's activity.
        heads: of the search for actions without marks; None where the model was not trained for that.
    """

    first: FirstMaps
    stages: StageDiscriminants
    action_map: ActionMap
    layer3: SupervisedLayer
    metadata: PyramidMetadata
    heads: CompletenessHeads | None = None

    def __post_init__(self) -> None:
        if problem := self.metadata.problem() or self._number_problem() or self._shape_problem():
            raise ValueError(problem)

    @property
    def arrays(self) -> Arrays:
        """All weights by the names they are stored under, maps as component planes (rows, cols, dim)."""
        weights: dict[str, NDArray[Any]] = {
            **{name: self.first.maps[name].planes for name in MAP_INPUTS},
            "axes": self.stages.axes,
            "offsets": self.stages.offsets,
            "concepts": self.action_map.som.planes,
            "concept_mean": self.action_map.mean,
            "layer3": self.layer3.weights,
        }
        if self.heads is not None:
            weights |= {"completeness_axes": self.heads.axes, "completeness_offsets": self.heads.offsets}
        return weights

    @classmethod
    def restored(cls, metadata: str, arrays: Arrays) -> "PyramidModel":
        """Build the model of a file's metadata (JSON) and arrays.

        Raises:
            ValueError, KeyError: fields or arrays are missing or do not fit together.
        """
        stored = PyramidMetadata.model_validate_json(metadata)
        action_som = Som.of_planes(arrays["concepts"])
        maps = {name: Som.of_planes(arrays[name]) for name in MAP_INPUTS}
        durations = stored.log_duration_mean, stored.log_duration_sd
        heads = None
        if stored.spotting is not None:
            heads = CompletenessHeads(arrays["completeness_axes"], arrays["completeness_offsets"])
        return cls(
            FirstMaps(maps, stored.contrasts, (stored.arm_shares[0], stored.arm_shares[1])),
            StageDiscriminants(arrays["axes"], arrays["offsets"], tuple(stored.fractions), *durations),
            ActionMap(action_som, stored.concept_contrast, arrays["concept_mean"]),
            SupervisedLayer(arrays["layer3"]),
            stored,
            heads,
        )

    @cached_property
    def pyramid(self) -> Pyramid:
        """How activities are pooled over a segment."""
        return Pyramid(tuple(self.metadata.levels), self.metadata.overlap)

    def encoder(self) -> FrameEncoder:
        """Return a new encoder, for one agent."""
        return FrameEncoder(self.first)

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Recognise the action of a segment.

        Raises:
            ValueError: there is no frame.
        """
        if not frames:
            raise ValueError("the segment contains no frame, so no action can be recognised")
        activities: list[FrameActivity] = [frame.activity for frame in frames]
        stages = self.stages.weights((frames[-1].stamp_ns - frames[0].stamp_ns) / SECOND_NS, complete)
        scores = self.scores(activities, stages)
        cosines = self.layer3.cosines(self.action_map.activity(scores))
        winner = int(cosines.argmax())
        inverse_temperature = sum(map(mul, stages, self.metadata.gains)) * known_joint_share(activities)
        familiarity = self.familiarity(activities, scores)
        recognition = Recognition(
            label=self.labels[winner],
            confidence=float(1.0 / np.exp(inverse_temperature * (cosines - cosines[winner])).sum()),
            activations=dict(zip(self.labels, cosines.tolist(), strict=True)),
            part=most_moved_part(activities),
            familiarity=familiarity,
            unknown=complete and familiarity < self.metadata.familiar,
        )
        return self._doubted_if_still(recognition, frames) if complete else recognition

    @property
    def spotting(self) -> PyramidSpottingMetadata | None:
        """What the model knows of its search for actions; None where the model was not trained for that."""
        return self.metadata.spotting

    def spotters(self, asked: Sequence[SpottingOptions]) -> list[Spotter]:
        """Return a search of one person's stream for each of these options, which pool each window once."""
        if self.heads is None or self.metadata.spotting is None:
            return []
        pool, learned = PoolingOnce(self.pooled), SpottingModel(self.heads, self.metadata.spotting)
        return [PyramidSpotter(pool, self.labels, learned, options) for options in asked]

    def pooled(self, frames: Sequence[Frame]) -> NDArray[np.float32]:
        """Return the pyramid vector of valid frames, each with the activity that its encoder gave, (inputs,)."""
        return self.pyramid.vector(self.prefix_sums([frame.activity for frame in frames]))

    def prefix_sums(self, activities: Sequence[FrameActivity]) -> PrefixSums:
        """Return a segment's prefix sums, of the actor as seen or mirrored."""
        return segment_sums(activities, self.reads_in_mirror(activities))

    def reads_in_mirror(self, activities: Sequence[FrameActivity]) -> bool:
        """Tell whether a segment is read as its mirror image, because the left arm acts."""
        return self.metadata.mirrors and left_handed(activities)

    def winners(self, frames: Sequence[Frame]) -> Indices:
        """Return the posture map's winner at each frame, of the actor as seen or mirrored, shape (n,)."""
        activities: list[FrameActivity] = [frame.activity for frame in frames]
        side = int(self.reads_in_mirror(activities))
        return np.array([activity.winners[side] for activity in activities], dtype=np.intp)

    def trace(self, frames: Sequence[Frame]) -> Array:
        """Return row and column of the posture map's winners, repeats removed, shape (n, 2)."""
        return self.first.postures.coordinates[without_repeats(self.winners(frames))]

    def maps(self, frames: Sequence[Frame]) -> Arrays:
        """Return the activity of each map over a segment, by name, (rows, cols) each.

        A map of the first layer has its mean activity over the frames, relative to that of its most active unit.
        """
        activities: list[FrameActivity] = [frame.activity for frame in frames]
        scores = self.scores(activities, self.stages.weights(0.0, complete=True))
        segment = self.prefix_sums(activities)
        sums = segment.since_start([len(segment)]).reshape(len(CHANNELS), -1)
        first = {}
        for name, som in self.first.maps.items():
            activity = sums[CHANNELS.index(Channel(name))].reshape(som.rows, som.cols)
            first[name] = activity / activity.max()
        action_som = self.action_map.som
        active = soft_activity(action_som.excess2(scores), self.action_map.contrast)
        return first | {"actions": active.reshape(action_som.rows, action_som.cols)}

    def familiarity(self, activities: Sequence[FrameActivity], scores: NDArray[np.float32]) -> float:
        """Return how similar a segment with these scores (actions,) is to an action that was trained."""
        log_error = mean_log_error(activities, self.reads_in_mirror(activities))
        return familiarity_of(scores, log_error, self.metadata.usual_log_errors)

    def scores(self, activities: Sequence[FrameActivity], stages: Sequence[float]) -> NDArray[np.float32]:
        """Return the actions' scores on the discriminants, weighted by stage, shape (actions,)."""
        return self.stages.scores(self.pyramid.vector(self.prefix_sums(activities)), stages)

    def _doubted_if_still(self, recognition: Recognition, frames: Sequence[Frame]) -> Recognition:
        """Return the answer as it is or, where a segment moves less than any action, as unknown and as much less sure.

        Scores alone do not show that: every action begins and ends at rest, so that rest scores like a part of one.
        """
        postures = np.array([frame.kinematics.posture for frame in frames if frame.kinematics is not None])
        moved_m = movement_m(np.array([frame.stamp_ns for frame in frames]), postures)
        if moved_m >= self.metadata.least_movement_m:
            return recognition
        share = moved_m / self.metadata.least_movement_m
        familiarity = min(recognition.familiarity or 0.0, self.metadata.familiar) - (1 - share)
        return replace(recognition, confidence=share * recognition.confidence, familiarity=familiarity, unknown=True)

    def _number_problem(self) -> str | None:
        """Return the first array whose numbers are not of the kind they have to be, None where there is none."""
        if len({som.dtype for som in self.first.maps.values()}) > 1:
            return "its maps are not of the same precision"
        outside_maps = [self.stages.axes, self.stages.offsets, self.action_map.mean]
        outside_maps += [] if self.heads is None else [self.heads.axes, self.heads.offsets]
        if not all(array.dtype == np.float32 and np.isfinite(array).all() for array in outside_maps):
            return "its axes, their offsets or its mean are not finite single-precision numbers"
        return None

    def _shape_problem(self) -> str | None:
        """Return the first inconsistency of a shape with the metadata or other arrays, None where there is none."""
        first, units = self.first, len(self.action_map.som.weights)
        actions, stages = len(self.metadata.labels), len(self.metadata.fractions)
        shapes = {
            "maps of the first layer": (
                {len(som.weights) for som in first.maps.values()},
                {len(first.postures.weights)},
            ),
            **{f"map of {name}": (first.maps[name].weights.shape[1:], (INPUT_SIZES[name],)) for name in MAP_INPUTS},
            "discriminant axes": (self.stages.axes.shape, (stages, self.pyramid.cells * first.units, actions)),
            "offsets of them": (self.stages.offsets.shape, (stages, actions)),
            "map of actions": (self.action_map.som.weights.shape[1:], (actions,)),
            "its mean": (self.action_map.mean.shape, (units,)),
            "third layer": (self.layer3.weights.shape, (actions, units)),
        }
        if self.heads is not None:
            shapes["completeness heads"] = (self.heads.axes.shape, (self.pyramid.cells * first.units, actions))
            shapes["offsets of these"] = (self.heads.offsets.shape, (actions,))
        wrong = (
            f"its {name} is of shape {has}, not {should}" for name, (has, should) in shapes.items() if has != should
        )
        return next(wrong, None)
