"""Training of the layers above the first maps: discriminants, second opinion, verifier, action map, neurons."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from actum.arrays import Floats, Indices
from actum.node import SECOND_NS
from actum_model_trainer.augmentation import Variant, augmentation_for, variants
from actum_model_trainer.background import negatives_of
from actum_model_trainer.confidence import body_movement, expected_log_errors, inverse_temperatures
from actum_model_trainer.convolution_training import Convolved, blended
from actum_model_trainer.discriminants import FittedStage, fit_discriminants, folds_of
from actum_model_trainer.pooling import PooledVectors, Pooling
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import actions_of, provenance
from actum_model_trainer.samples import LabelledStream, SegmentSample
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.upper_layers import UpperLayers, train_upper
from actum_model_trainer.verifier_training import Shown, trained_verifier
from som_classifier.convolutions import SecondOpinion
from som_classifier.first_layer import FirstMaps
from som_classifier.presets import ConvolutionPreset, PyramidPreset
from som_classifier.pyramid import Pyramid
from som_classifier.pyramid_metadata import PyramidMetadata
from som_classifier.pyramid_model import PyramidModel
from som_classifier.stage_discriminants import StageDiscriminants
from som_classifier.verifier import Verifier

Strange = tuple[Sequence[SegmentSample], Sequence[Sequence[Variant]]]
"""Windows of movement that nobody taught, and each as the classifier reads it, its only variant."""
MIN_DURATION_S = 1 / 30  # one frame at 30 Hz: all stamps of a sample may be equal
MIN_LOG_DURATION_SD = 0.1  # of ln(duration / s): people's tempos differ by 10 % even where the training's do not


@dataclass(frozen=True, eq=False)
class Taught:
    """The samples of a training, and what is drawn of them.

    Attributes:
        samples: as measured.
        labels: the actions, sorted.
        targets: (n,), the action of each sample, as its number among the labels.
        mirrors: whether an action of the left arm is read as its mirror image.
        augmented: the variants of each sample, the one as measured first.
        rng: as it is after the variants were drawn.
    """

    samples: Sequence[SegmentSample]
    labels: Sequence[str]
    targets: Indices
    mirrors: bool
    augmented: Sequence[Sequence[Variant]]
    rng: np.random.Generator

    @classmethod
    def of(cls, samples: Sequence[SegmentSample], mirrors: bool, preset: PyramidPreset, seed: int) -> "Taught":
        """Draw the variants.

        Raises:
            TrainingError: fewer than two actions among the samples.
        """
        labels, rng = actions_of(samples), np.random.default_rng(seed)
        augmentation = augmentation_for([sample.person for sample in samples], preset)
        augmented = [list(variants(sample, augmentation, mirrors, rng)) for sample in samples]
        targets = np.array([labels.index(sample.label) for sample in samples])
        return cls(samples, labels, targets, mirrors, augmented, rng)

    @property
    def measured(self) -> list[Floats]:
        """The postures of each sample as measured."""
        return [of_sample[0].postures for of_sample in self.augmented]

    @property
    def shown(self) -> Shown:
        """What the samples show of how people differ."""
        of_people = len({(each.person, each.label) for each in self.samples})
        people = len({sample.person for sample in self.samples})
        return Shown(people, one_sample_each=of_people == len(self.samples))


def train_above(
    first: FirstMaps,
    taught: Taught,
    background: Sequence[LabelledStream],
    preset: PyramidPreset,
    seed: int,
    progress: Progress,
) -> PyramidModel:
    """Train all layers but the first maps.

    Raises:
        TrainingError: all samples move alike.
    """
    samples, folds = taught.samples, folds_of(taught.samples)
    pooling = Pooling(first, Pyramid(preset.levels, preset.overlap), taught.mirrors)
    pooled = pooling.vectors(samples, taught.augmented, preset.stages)
    fitted = _fitted_stages(pooled, taught.targets, folds, preset.shrinkage, progress)
    stages = _stage_discriminants(fitted, samples, preset)
    strange = _background(background, samples, preset, taught.mirrors, seed)
    convolved = _convolved(taught.augmented, pooled[-1], strange, preset, seed)
    opinion, fitted[-1] = _with_opinion(fitted[-1], convolved, folds[pooled[-1].sample_indices], preset.convolutions)
    upper = train_upper(fitted[-1], len(taught.labels), preset, taught.rng, progress)
    log_errors = expected_log_errors(first, taught.measured, taught.targets, preset.prior)
    of_strange = pooling.of_background(*strange)
    verifier = trained_verifier(fitted[-1], pooled[-1], of_strange, convolved, folds, log_errors, taught.shown, preset)
    body = body_movement(samples, taught.targets, preset.prior, taught.shown.people)
    metadata = (
        provenance(samples, preset, seed)
        | {"mirrors": taught.mirrors, "held_out": _cross_validated_counts(fitted[-1], taught.labels)}
        | {"usual_movements": body.usual, "most_movement_above": body.most_above, "least_movement_m": body.least_m}
        | _verifier_parameters(verifier)
        | _layer_parameters(first, stages, opinion, upper, preset)
        | {"gains": _gains(fitted, upper, samples, preset)}
    )
    described = PyramidMetadata.model_validate(metadata)
    return PyramidModel(first, stages, opinion, verifier, body, upper.action_map, upper.layer3, described)


def _background(
    streams: Sequence[LabelledStream], samples: Sequence[SegmentSample], preset: PyramidPreset, mirrors: bool, seed: int
) -> Strange:
    """Draw the background's windows, each read as the classifier reads it."""
    rng = np.random.default_rng(seed)
    durations_s = np.array([_duration_s(sample) for sample in samples])
    windows = negatives_of(streams, durations_s, preset.background, rng)
    return windows, [[next(variants(window, preset, mirrors, rng))] for window in windows]


def _convolved(
    augmented: Sequence[Sequence[Variant]], pooled: PooledVectors, strange: Strange, preset: PyramidPreset, seed: int
) -> Convolved:
    """Convolve the same variants that are pooled, and the background."""
    rows = zip(pooled.sample_indices.tolist(), pooled.variant_indices.tolist(), strict=True)
    taught = [augmented[sample][variant].postures for sample, variant in rows]
    beside = [variant.postures for (variant,) in strange[1]]
    return Convolved.of(taught, beside, preset.convolutions.biases, np.random.default_rng(seed))


def _fitted_stages(
    pooled: Sequence[PooledVectors], targets: Indices, folds: Indices, shrinkage: float, progress: Progress
) -> list[FittedStage]:
    """Fit the discriminants of each stage; targets and folds (n,) are those of the samples."""
    indicators = np.eye(targets.max() + 1)

    def fitted(of_stage: PooledVectors) -> FittedStage:
        vectors, sample_indices, _ = of_stage
        vector_targets = targets[sample_indices]
        discriminants = fit_discriminants(vectors, indicators[vector_targets], folds[sample_indices], shrinkage)
        return FittedStage(discriminants, sample_indices, vector_targets)

    return side_by_side(fitted, pooled, "discriminant axes", progress)


def _with_opinion(
    fitted: FittedStage, convolved: Convolved, folds: Indices, preset: ConvolutionPreset
) -> tuple[SecondOpinion, FittedStage]:
    """Return the second opinion, and the last stage with scores in which it counts; folds (n,) are of the vectors."""
    indicators = np.eye(fitted.targets.max() + 1)[fitted.targets]
    own = fit_discriminants(convolved.taught, indicators, folds, preset.shrinkage)
    opinion = SecondOpinion(convolved.convolutions, convolved.axes(own), own.offsets, preset.opinion_weight)
    return opinion, replace(fitted, discriminants=blended(fitted.discriminants, own, preset.opinion_weight))


def _stage_discriminants(
    fitted: Sequence[FittedStage], samples: Sequence[SegmentSample], preset: PyramidPreset
) -> StageDiscriminants:
    log_durations = np.log([_duration_s(sample) for sample in samples])
    return StageDiscriminants(
        np.stack([stage.discriminants.axes for stage in fitted]),
        np.stack([stage.discriminants.offsets for stage in fitted]),
        tuple(float(np.mean(fractions)) for fractions in preset.stages),
        float(log_durations.mean()),
        float(max(log_durations.std(), MIN_LOG_DURATION_SD)),
    )


def _verifier_parameters(verifier: Verifier) -> dict[str, Any]:
    return {
        "usual_log_errors": verifier.usual_log_errors,
        "verification": [verifier.slope, verifier.intercept],
        "least_likeness": verifier.least_likeness,
        "least_found_likeness": verifier.least_found_likeness,
    }


def _layer_parameters(
    first: FirstMaps, stages: StageDiscriminants, opinion: SecondOpinion, upper: UpperLayers, preset: PyramidPreset
) -> dict[str, Any]:
    """Return the metadata that the layers need beside their weights."""
    return {
        "posture_contrast": first.contrasts["postures"],
        "velocity_contrast": first.contrasts["velocities"],
        "arm_contrast": first.contrasts["arms"],
        "arm_shares": list(first.arm_shares),
        "levels": list(preset.levels),
        "overlap": preset.overlap,
        "fractions": list(stages.fractions),
        "log_duration_mean": stages.log_duration_mean,
        "log_duration_sd": stages.log_duration_sd,
        "opinion_weight": opinion.weight,
        "concept_contrast": upper.action_map.contrast,
    }


def _gains(
    fitted: Sequence[FittedStage], upper: UpperLayers, samples: Sequence[SegmentSample], preset: PyramidPreset
) -> list[float]:
    people = len({sample.person for sample in samples})
    depth_inferred = any(sample.depth_inferred for sample in samples)
    return inverse_temperatures(fitted, upper, preset.prior, people, depth_inferred)


def _cross_validated_counts(stage: FittedStage, labels: Sequence[str]) -> dict[str, dict[str, int]]:
    """Count the samples by action done (outer) and action of the largest cross-validated score (inner).

    Only the first vector of each sample counts, that of the sample as measured.
    """
    first = np.unique(stage.sample_indices, return_index=True)[1]
    answers = stage.discriminants.cross_validated_scores[first].argmax(axis=1)
    counts: dict[str, dict[str, int]] = {}
    for done, answered in zip(stage.targets[first], answers, strict=True):
        of_done = counts.setdefault(labels[done], {})
        of_done[labels[answered]] = of_done.get(labels[answered], 0) + 1
    return counts


def _duration_s(sample: SegmentSample) -> float:
    """Return how long a sample lasts, at least one frame."""
    return max(float(np.ptp(sample.stamps_ns)) / SECOND_NS, MIN_DURATION_S)
