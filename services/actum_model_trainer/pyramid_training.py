"""The default recogniser, trained layer after layer: first maps, discriminant axes, map of actions, neurons."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.som import Som
from actum_model_trainer.augmentation import View, views
from actum_model_trainer.confidence import calibrated_gains, familiar, usual_log_errors
from actum_model_trainer.description import labels_of, provenance
from actum_model_trainer.discriminants import discriminant_axes, folds_of
from actum_model_trainer.hands import keep_to_one_hand
from actum_model_trainer.pooling import Pooling
from actum_model_trainer.progress import Progress
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.typical import typical_error2
from actum_model_trainer.upper_layers import Scored, UpperLayers, train_upper
from som_classifier.first_layer import FirstMaps, arm_inputs, frame_inputs
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid import Pyramid
from som_classifier.pyramid_model import PyramidMetadata, PyramidModel
from som_classifier.stage_discriminants import StageDiscriminants

Floats = NDArray[Any]
Indices = NDArray[np.intp]

MOST_INPUTS = 20_000
SHORTEST_S = 1 / 30
SMALLEST_LOG_SD = 0.1


def train(samples: Sequence[SegmentSample], preset: PyramidPreset, seed: int, progress: Progress) -> PyramidModel:
    """Train all layers; the same samples, preset and seed make the same model.

    Raises:
        TrainingError: fewer than two actions among the samples, or all samples move alike.
    """
    labels = labels_of(samples)
    rng = np.random.default_rng(seed)
    mirrors = keep_to_one_hand(samples)
    shown = [list(views(sample, _varied(preset, samples), mirrors, rng)) for sample in samples]
    first = _first_maps([view for own in shown for view in own], preset, rng, progress)
    targets = np.array([labels.index(sample.label) for sample in samples])
    pooling = Pooling(first, Pyramid(preset.levels, preset.overlap), mirrors)
    fitted = []
    for done, (vectors, owners) in enumerate(pooling.vectors(samples, shown, preset.stages)):
        progress("discriminant axes", done, len(preset.stages))
        fitted.append(_fitted(vectors, owners, targets, folds_of(samples), preset.shrinkage))
    progress("discriminant axes", len(preset.stages), len(preset.stages))
    upper = train_upper(fitted[-1], len(labels), preset, rng, progress)
    usual = usual_log_errors(first, [own[0].postures for own in shown], targets, preset.prior)
    origin = provenance(samples, preset, seed) | {"mirrors": mirrors, "usual_log_errors": usual}
    return _assembled(samples, first, fitted, upper, origin, preset)


def _varied(preset: PyramidPreset, samples: Sequence[SegmentSample]) -> PyramidPreset:
    """Return the preset with as many and as different other people as those learnt from call for."""
    few = len({sample.person for sample in samples}) <= preset.few_people
    return replace(preset, others=preset.others_of_few) if few else preset


def _first_maps(
    shown: Sequence[View], preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> FirstMaps:
    postures = np.concatenate([view.postures for view in shown])
    velocities = np.concatenate([view.velocities for view in shown])
    trained = (
        _first_map(_some(inputs, rng), preset, partial(progress, stage))
        for inputs, stage in (
            (postures, "map of postures"),
            (velocities, "map of velocities"),
            (arm_inputs(frame_inputs(postures, velocities)), "map of arms"),
        )
    )
    (posture_map, posture), (velocity_map, velocity), (arm_map, arm) = trained
    return FirstMaps(posture_map, velocity_map, arm_map, (posture, velocity, arm), preset.arm_shares)


def _first_map(inputs: Floats, preset: PyramidPreset, report: Callable[[int, int], None]) -> tuple[Som, float]:
    """Return a map of the inputs and the contrast of its activity."""
    som = Som.linear(*preset.units, inputs).train_batch(inputs, preset.unit_epochs, preset.unit_radius, report)
    return som, preset.relative_contrast * typical_error2(som, inputs)


def _some(vectors: Floats, rng: np.random.Generator) -> NDArray[np.float32]:
    """Return no more rows than a map needs, each flat and in single precision, none of them wholly missing.

    What is missing in every row is 0, the same for all units, so that it tells none from another.
    """
    flat = vectors.reshape(len(vectors), -1).astype(np.float32)
    flat = flat[~np.isnan(flat).all(axis=1)]
    if not len(flat):
        return np.zeros((1, vectors[0].size), np.float32)
    flat = np.where(np.isnan(flat).all(axis=0), np.float32(0), flat)
    return flat if len(flat) <= MOST_INPUTS else flat[rng.choice(len(flat), MOST_INPUTS, replace=False)]


def _fitted(
    vectors: NDArray[np.float32], owners: Indices, targets: Indices, folds: Indices, shrinkage: float
) -> Scored:
    wanted = np.eye(targets.max() + 1)[targets[owners]]
    axes = discriminant_axes(vectors, wanted, folds[owners], shrinkage)
    return Scored(axes, owners, targets[owners], folds[owners])


def _assembled(
    samples: Sequence[SegmentSample],
    first: FirstMaps,
    fitted: Sequence[Scored],
    upper: UpperLayers,
    origin: dict[str, Any],
    preset: PyramidPreset,
) -> PyramidModel:
    durations = np.log([max(np.ptp(sample.stamps_ns) / SECOND_NS, SHORTEST_S) for sample in samples])
    stages = StageDiscriminants(
        np.stack([stage.axes.axes for stage in fitted]),
        np.stack([stage.axes.offsets for stage in fitted]),
        tuple(float(np.mean(fractions)) for fractions in preset.stages),
        float(durations.mean()),
        float(max(durations.std(), SMALLEST_LOG_SD)),
    )
    prior, people = preset.prior, len({sample.person for sample in samples})
    about = origin | {
        "posture_contrast": first.contrasts[0],
        "velocity_contrast": first.contrasts[1],
        "arm_contrast": first.contrasts[2],
        "arm_shares": list(first.arm_shares),
        "levels": list(preset.levels),
        "overlap": preset.overlap,
        "fractions": list(stages.fractions),
        "log_duration_mean": stages.log_duration_mean,
        "log_duration_sd": stages.log_duration_sd,
        "concept_contrast": upper.action_map.contrast,
        "gains": calibrated_gains(fitted, upper, prior, people, any(sample.depth_inferred for sample in samples)),
        "familiar": familiar(fitted[-1].axes.held_out, samples, preset),
        "held_out": _held_out(fitted[-1], origin["labels"]),
    }
    return PyramidModel(first, stages, upper.action_map, upper.layer3, PyramidMetadata.model_validate(about))


def _held_out(stage: Scored, labels: Sequence[str]) -> dict[str, dict[str, int]]:
    """Count, of each sample's first view, the action done (outer) and the one of the largest held-out score (inner)."""
    first = np.unique(stage.owners, return_index=True)[1]
    counts: dict[str, dict[str, int]] = {}
    for done, answered in zip(stage.targets[first], stage.axes.held_out[first].argmax(axis=1), strict=True):
        of_done = counts.setdefault(labels[done], {})
        of_done[labels[answered]] = of_done.get(labels[answered], 0) + 1
    return counts
