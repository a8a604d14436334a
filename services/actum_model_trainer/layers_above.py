"""Training of the layers above the first maps: discriminants, second opinion, verifier, action map, neurons."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from actum.arrays import Array
from actum_model_trainer.basis import Basis, Floats32
from actum_model_trainer.confidence import body_movement, inverse_temperatures
from actum_model_trainer.convolution_training import Convolved, blended
from actum_model_trainer.discriminants import Discriminants, FittedStage, fit_discriminants, fit_without_and_with
from actum_model_trainer.gathering import Taught, gathered
from actum_model_trainer.kept import kept_arrays
from actum_model_trainer.pooling import PooledVectors
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import provenance
from actum_model_trainer.samples import LabelledStream
from actum_model_trainer.side_by_side import side_by_side
from actum_model_trainer.training_data import TrainingData
from actum_model_trainer.upper_layers import UpperLayers, train_upper
from actum_model_trainer.verifier_training import trained_verifier
from som_classifier.convolutions import SecondOpinion
from som_classifier.first_layer import FirstMaps
from som_classifier.presets import ConvolutionPreset, PyramidPreset
from som_classifier.pyramid_metadata import CONTRASTS, PyramidMetadata
from som_classifier.pyramid_model import PyramidModel
from som_classifier.stage_discriminants import StageDiscriminants
from som_classifier.verifier import Verifier

MIN_LOG_DURATION_SD = 0.1  # of ln(duration / s): people's tempos differ by 10 % even where the training's do not


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
    data = gathered(first, taught, background, preset, seed, progress)
    origin = provenance(taught.samples, preset, seed) | {"mirrors": taught.mirrors}
    return replace(fitted_model(first, data, origin, preset, taught.rng, progress), kept=kept_arrays(data))


def fitted_model(
    first: FirstMaps,
    data: TrainingData,
    origin: dict[str, Any],
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> PyramidModel:
    """Fit all layers above the first maps.

    Args:
        first: the trained maps.
        data: to fit the layers to.
        origin: the metadata that describe the samples, and whether the left arm is mirrored.
        preset: with hyperparameters and priors.
        rng: draws what the upper layers are shown.
        progress: of the fitting.

    Raises:
        TrainingError: all samples move alike.
    """
    measures, targets, people = data.measures, data.targets, data.measures.everybody
    *of_stages, of_opinion, by_maps, by_convolutions = _discriminants(data, preset, progress)
    samples = [stage.sample_indices for stage in data.stages]
    fitted = [FittedStage(own, of, targets[of]) for own, of in zip(of_stages, samples, strict=True)]
    stages = _stage_discriminants(fitted, measures.log_durations, preset)
    opinion, fitted[-1] = _with_opinion(fitted[-1], of_opinion, data.convolved, preset.convolutions)
    upper = train_upper(fitted[-1], len(data.labels), preset, rng, progress)
    verifier = trained_verifier(fitted[-1], by_maps, by_convolutions, data, preset)
    moved = measures.log_movements, measures.movements_m
    body = body_movement(*moved, targets, measures.people, preset.prior, people)
    inferred = bool(measures.depth_inferred.any())
    metadata = (
        origin
        | {"held_out": _cross_validated_counts(fitted[-1], data.labels)}
        | {"usual_movements": body.usual, "most_movement_above": body.most_above, "least_movement_m": body.least_m}
        | _verifier_parameters(verifier)
        | _layer_parameters(first, stages, opinion, upper, preset)
        | {"gains": inverse_temperatures(fitted, upper, preset.prior, people, inferred)}
    )
    described = PyramidMetadata.model_validate(metadata)
    return PyramidModel(first, stages, opinion, verifier, body, upper.action_map, upper.layer3, described)


def _discriminants(data: TrainingData, preset: PyramidPreset, progress: Progress) -> list[Discriminants]:
    """Fit the discriminants of each stage, the second opinion's, and the verifier's on the maps and on convolutions."""
    indicators, (*earlier, last), convolved = np.eye(len(data.labels)), data.stages, data.convolved
    on_maps, on_convolutions = (
        (preset.shrinkage, data.pooled_basis),
        (preset.convolutions.shrinkage, data.convolved_basis),
    )

    def fitted(rows: tuple[PooledVectors, Floats32 | None, float, Basis | None]) -> list[Discriminants]:
        pooled, background, shrinkage, basis = rows
        samples = pooled.sample_indices
        of_rows = pooled.vectors, indicators[data.targets[samples]], data.folds[samples], shrinkage
        found = [fit_discriminants(*of_rows)] if background is None else fit_without_and_with(*of_rows, background)
        return [each.through(basis) for each in found]

    *of_earlier, (of_last, by_maps), (of_opinion, by_convolutions) = side_by_side(
        fitted,
        [
            *((stage, None, *on_maps) for stage in earlier),
            (last, data.background, *on_maps),
            (last._replace(vectors=convolved.taught), convolved.background, *on_convolutions),
        ],
        "discriminant axes",
        progress,
    )
    return [*(of_stage for (of_stage,) in of_earlier), of_last, of_opinion, by_maps, by_convolutions]


def _with_opinion(
    fitted: FittedStage, own: Discriminants, convolved: Convolved, preset: ConvolutionPreset
) -> tuple[SecondOpinion, FittedStage]:
    """Return the second opinion, and the last stage with scores in which it counts."""
    opinion = SecondOpinion(convolved.convolutions, convolved.axes(own), own.offsets, preset.opinion_weight)
    return opinion, replace(fitted, discriminants=blended(fitted.discriminants, own, preset.opinion_weight))


def _stage_discriminants(
    fitted: Sequence[FittedStage], log_durations: Array, preset: PyramidPreset
) -> StageDiscriminants:
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
        **{field: first.contrasts[name] for name, field in CONTRASTS.items()},
        "arm_shares": list(first.arm_shares),
        "levels": list(preset.levels),
        "overlap": preset.overlap,
        "fractions": list(stages.fractions),
        "log_duration_mean": stages.log_duration_mean,
        "log_duration_sd": stages.log_duration_sd,
        "opinion_weight": opinion.weight,
        "concept_contrast": upper.action_map.contrast,
    }


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
