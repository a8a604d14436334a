"""The default recogniser: posture, velocity and arm maps, a temporal pyramid, linear discriminants, an action map."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from operator import mul
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices, stacked
from actum.node import SECOND_NS
from actum.som import Som
from som_classifier.body_movement import BodyMovement, Evidence, movements
from som_classifier.convolutions import COORDINATES, FILTERS, Convolutions, SecondOpinion, resampled
from som_classifier.first_layer import CHANNELS, MAP_INPUTS, Channel, FirstMaps
from som_classifier.frame_activity import (
    FrameActivity,
    FrameEncoder,
    known_joint_share,
    left_handed,
    mean_log_error,
    most_moved_part,
    pooled_windows,
    segment_sums,
)
from som_classifier.frames import Frame
from som_classifier.handedness import mirrored
from som_classifier.map_activity import soft_activity, without_repeats
from som_classifier.model import Arrays, Model, Recognition
from som_classifier.pyramid import PrefixSums, Pyramid
from som_classifier.pyramid_metadata import PyramidMetadata
from som_classifier.regressed_continuation import INPUTS, RegressedContinuation
from som_classifier.second_layer import ActionMap
from som_classifier.spotting.pyramid_spotter import PoolingOnce, PyramidSpotter
from som_classifier.spotting.spotted import Spotter, SpottingOptions
from som_classifier.spotting.spotting_model import CompletenessHeads, PyramidSpottingMetadata, SpottingModel
from som_classifier.stage_discriminants import StageDiscriminants
from som_classifier.supervised import SupervisedLayer
from som_classifier.verifier import Verifier

UPPER = ("concepts", "layer3")
"""The arrays of the upper layers: a map, which checks itself, and neurons, whose precision is their own."""


@dataclass(frozen=True, eq=False)
class PyramidModel(Model):
    """The trained layers. `confidence` is a probability, calibrated on people left out of training.

    Attributes:
        first: the maps of posture, velocity and the acting arm.
        stages: the discriminants on the maps' pooled activities.
        opinion: the second opinion on complete segments.
        verifier: tells true instances of an action from other movement.
        body: how much people move in each action.
        action_map: the second layer, a map of the discriminants' scores.
        layer3: one neuron per action on the second layer's activity.
        heads: of the search for actions without marks; None where the model was not trained for that.
        kept: what the layers above the maps were trained on, for training alone.
        continuation: how a posture goes on; None where the model was not trained for that.
    """

    first: FirstMaps
    stages: StageDiscriminants
    opinion: SecondOpinion
    verifier: Verifier
    body: BodyMovement
    action_map: ActionMap
    layer3: SupervisedLayer
    metadata: PyramidMetadata
    heads: CompletenessHeads | None = None
    kept: Arrays = field(default_factory=dict)
    continuation: RegressedContinuation | None = None

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
            "convolved": self.opinion.convolutions.coordinates,
            "convolution_biases": self.opinion.convolutions.biases,
            "opinion_axes": self.opinion.axes,
            "opinion_offsets": self.opinion.offsets,
            "verifier_axes": self.verifier.pooled_axes,
            "verifier_convolution_axes": self.verifier.convolution_axes,
            "verifier_offsets": self.verifier.offsets,
            "concepts": self.action_map.som.planes,
            "concept_mean": self.action_map.mean,
            "layer3": self.layer3.weights,
        }
        if self.heads is not None:
            weights |= {"completeness_axes": self.heads.axes, "completeness_offsets": self.heads.offsets}
        return weights if self.continuation is None else {**weights, **self.continuation.arrays}

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
        convolutions = Convolutions(arrays["convolved"], arrays["convolution_biases"])
        verifying = arrays["verifier_axes"], arrays["verifier_convolution_axes"], arrays["verifier_offsets"]
        least = stored.least_likeness, stored.least_found_likeness
        return cls(
            FirstMaps(maps, stored.contrasts, (stored.arm_shares[0], stored.arm_shares[1])),
            StageDiscriminants(arrays["axes"], arrays["offsets"], tuple(stored.fractions), *durations),
            SecondOpinion(convolutions, arrays["opinion_axes"], arrays["opinion_offsets"], stored.opinion_weight),
            Verifier(*verifying, stored.usual_log_errors, stored.verification[0], stored.verification[1], *least),
            BodyMovement(stored.usual_movements, stored.most_movement_above, stored.least_movement_m),
            ActionMap(action_som, stored.concept_contrast, arrays["concept_mean"]),
            SupervisedLayer(arrays["layer3"]),
            stored,
            heads,
            continuation=RegressedContinuation.restored(arrays),
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
            raise ValueError("the segment contains no frame, so no action can be recognised: give at least one frame")
        activities: list[FrameActivity] = [frame.activity for frame in frames]
        stages = self.stages.weights((frames[-1].stamp_ns - frames[0].stamp_ns) / SECOND_NS, complete)
        evidence = self.evidence(frames) if complete else None
        scores = self.complete_scores(evidence) if evidence else self.scores(activities, stages)
        cosines = self.layer3.cosines(self.action_map.activity(scores))
        winner = int(cosines.argmax())
        inverse_temperature = sum(map(mul, stages, self.metadata.gains)) * known_joint_share(activities)
        likeness = None if evidence is None else self.likeness(winner, evidence, activities)
        recognition = Recognition(
            label=self.labels[winner],
            confidence=float(1.0 / np.exp(inverse_temperature * (cosines - cosines[winner])).sum()),
            activations=dict(zip(self.labels, cosines.tolist(), strict=True)),
            part=most_moved_part(activities),
            familiarity=None if likeness is None else self.verifier.probability(likeness),
            unknown=likeness is not None and likeness < self.verifier.least_likeness,
            doubtful=likeness is not None and likeness < self.verifier.least_found_likeness,
        )
        return recognition if evidence is None else self.body.doubted(recognition, winner, evidence)

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

    def pooled(self, frames: Sequence[Frame], firsts: Sequence[int]) -> NDArray[np.float32]:
        """Return the pyramid vectors of windows that begin at some of these frames and end with the last, (n, inputs).

        Args:
            frames: valid, each with the activity that its encoder gave.
            firsts: the index of each window's first frame.
        """
        return pooled_windows(self.pyramid, [frame.activity for frame in frames], firsts, self.metadata.mirrors)

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
        scores = self.complete_scores(self.evidence(frames))
        segment = self.prefix_sums(activities)
        sums = segment.since_start([len(segment)]).reshape(len(CHANNELS), -1)
        first = {}
        for name, som in self.first.maps.items():
            activity = sums[CHANNELS.index(Channel(name))].reshape(som.rows, som.cols)
            first[name] = activity / activity.max()
        action_som = self.action_map.som
        active = soft_activity(action_som.excess2(scores), self.action_map.contrast)
        return first | {"actions": active.reshape(action_som.rows, action_som.cols)}

    def likeness(self, action: int, evidence: Evidence, activities: Sequence[FrameActivity]) -> float:
        """Return how like an action (its index) a complete segment is."""
        log_error = mean_log_error(activities, self.reads_in_mirror(activities))
        return self.verifier.likeness(action, evidence.pooled, evidence.features, log_error)

    def action_unit(self, frames: Sequence[Frame]) -> int:
        """Return the action map's winner for a complete segment."""
        return self.action_map.som.bmu(self.complete_scores(self.evidence(frames)))

    def complete_scores(self, evidence: Evidence) -> NDArray[np.float32]:
        """Return the actions' scores for a complete segment, shape (actions,)."""
        whole = self.stages.weights(0.0, complete=True)
        return self.opinion.blended(self.stages.scores(evidence.pooled, whole), evidence.features)

    def scores(self, activities: list[FrameActivity], stages: Sequence[float]) -> NDArray[np.float32]:
        """Return the actions' scores on the discriminants, weighted by stage, shape (actions,)."""
        return self.stages.scores(self._pooled(activities), stages)

    def _pooled(self, activities: list[FrameActivity]) -> NDArray[np.float32]:
        vector: NDArray[np.float32] = pooled_windows(self.pyramid, activities, [0], self.metadata.mirrors)[0]
        return vector

    def evidence(self, frames: Sequence[Frame]) -> Evidence:
        """Return what a complete segment is judged by, of the actor as seen or mirrored."""
        activities: list[FrameActivity] = [frame.activity for frame in frames]
        stamps_ns = np.array([frame.stamp_ns for frame in frames])
        of_frames = [frame.kinematics.posture for frame in frames if frame.kinematics is not None]
        postures = stacked(list(map(np.ascontiguousarray, of_frames)), *of_frames[0].shape)
        as_read = mirrored(postures) if self.reads_in_mirror(activities) else postures
        features = self.opinion.convolutions.features(resampled(stamps_ns, as_read))
        return Evidence(self._pooled(activities), features, *movements(stamps_ns, postures))

    def _number_problem(self) -> str | None:
        """Return the first array whose numbers are not of the kind they have to be, None where there is none."""
        if len({som.dtype for som in self.first.maps.values()}) > 1:
            return "its maps are not of the same precision"
        outside_maps = [array for name, array in self.arrays.items() if name not in MAP_INPUTS and name not in UPPER]
        if not all(array.dtype == np.float32 and np.isfinite(array).all() for array in outside_maps):
            return "its axes, their offsets or its mean are not finite single-precision numbers"
        return None

    def _shape_problem(self) -> str | None:
        """Return the first inconsistency of a shape with the metadata or other arrays, None where there is none."""
        first, units, biases = self.first, len(self.action_map.som.weights), self.opinion.convolutions.biases
        actions, stages = len(self.metadata.labels), len(self.metadata.fractions)
        shapes = {
            "maps of the first layer": (
                {len(som.weights) for som in first.maps.values()},
                {len(first.postures.weights)},
            ),
            **{
                f"map of {name}": (first.maps[name].weights.shape[1:], (inputs.size,))
                for name, inputs in MAP_INPUTS.items()
            },
            "discriminant axes": (self.stages.axes.shape, (stages, self.pyramid.cells * first.units, actions)),
            "offsets of them": (self.stages.offsets.shape, (stages, actions)),
            "convolved coordinates": (self.opinion.convolutions.coordinates.shape, (FILTERS, COORDINATES)),
            "biases of convolutions": (biases.shape, (FILTERS, biases.size // FILTERS)),
            "axes of the second opinion": (self.opinion.axes.shape, (biases.size, actions)),
            "offsets of the second opinion": (self.opinion.offsets.shape, (actions,)),
            "axes of the verifier": (self.verifier.pooled_axes.shape, (self.pyramid.cells * first.units, actions)),
            "convolution axes of the verifier": (self.verifier.convolution_axes.shape, (biases.size, actions)),
            "offsets of the verifier": (self.verifier.offsets.shape, (actions,)),
            "map of actions": (self.action_map.som.weights.shape[1:], (actions,)),
            "its mean": (self.action_map.mean.shape, (units,)),
            "third layer": (self.layer3.weights.shape, (actions, units)),
        }
        if self.heads is not None:
            shapes["completeness heads"] = (self.heads.axes.shape, (self.pyramid.cells * first.units, actions))
            shapes["offsets of these"] = (self.heads.offsets.shape, (actions,))
        if self.continuation is not None:
            shapes["axes of the continuation"] = (self.continuation.axes.shape[:1], (INPUTS + first.units,))
        wrong = (
            f"its {name} is of shape {has}, not {should}" for name, (has, should) in shapes.items() if has != should
        )
        return next(wrong, None)
