"""The default recogniser, trained layer after layer: first maps, discriminant axes, map of actions, neurons."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.som import Som
from model_trainer.augmentation import View, views
from model_trainer.description import labels_of, provenance
from model_trainer.discriminants import discriminant_axes, folds_of
from model_trainer.hands import keep_to_one_hand
from model_trainer.progress import Progress
from model_trainer.samples import SegmentSample
from model_trainer.upper_layers import Scored, UpperLayers, held_out_gains, train_upper
from som_classifier.layers import FirstMaps, arm_inputs, frame_inputs
from som_classifier.presets import PyramidPreset
from som_classifier.pyramid import Instant, Pyramid, Trail, quantised
from som_classifier.pyramid_model import PyramidDescription, PyramidModel
from som_classifier.stages import Stages, familiarity_of

Floats = NDArray[Any]
Indices = NDArray[np.intp]

MOST_INPUTS = 20_000
MOST_VECTORS = 3_000
SHORTEST_FRAMES = 3
SHORTEST_S = 1 / 30
SMALLEST_LOG_SD = 0.1
_UM_PER_M = 1e6


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
    folds = folds_of(samples)
    vectors = _Pooling(first, Pyramid(preset.levels, preset.overlap), samples, shown, mirrors)
    fitted = []
    for done, fractions in enumerate(preset.stages):
        progress("discriminant axes", done, len(preset.stages))
        fitted.append(_fitted(vectors, fractions, targets, folds, preset.shrinkage))
    progress("discriminant axes", len(preset.stages), len(preset.stages))
    upper = train_upper(fitted[-1], len(labels), preset, rng, progress)
    gains = held_out_gains(fitted, len(labels), preset, rng, progress)
    return _assembled(
        samples, first, fitted, upper, gains, provenance(samples, preset, seed) | {"mirrors": mirrors}, preset
    )


def _varied(preset: PyramidPreset, samples: Sequence[SegmentSample]) -> PyramidPreset:
    """Return the preset with as many and as different other people as those learnt from call for."""
    only_one = len({sample.person for sample in samples}) == 1
    return replace(preset, others=preset.others_of_one) if only_one else preset


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
    return FirstMaps(posture_map, velocity_map, arm_map, (posture, velocity, arm), preset.arm_share)


def _first_map(inputs: Floats, preset: PyramidPreset, report: Callable[[int, int], None]) -> tuple[Som, float]:
    """Return a map of the inputs and the contrast of its activity."""
    som = Som.linear(*preset.units, inputs).train_batch(inputs, preset.unit_epochs, preset.unit_radius, report)
    return som, preset.relative_contrast * typical_distance2(som, inputs)


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


def typical_distance2(som: Som, vectors: Floats) -> float:
    """Return the median squared distance of the rows to their winners."""
    differences = vectors - som.weights[som.bmus(vectors)]
    known = ~np.isnan(differences)
    distances2 = np.square(np.where(known, differences, 0)).sum(axis=1) * som.dim / known.sum(axis=1)
    return float(np.median(distances2)) or 1e-6


class _Pooling:
    """Every view's pooled vector at any share of its action."""

    def __init__(
        self,
        first: FirstMaps,
        pyramid: Pyramid,
        samples: Sequence[SegmentSample],
        shown: Sequence[Sequence[View]],
        mirrors: bool,
    ) -> None:
        self._first, self._pyramid, self._samples, self._shown = first, pyramid, samples, shown
        self._left_handed = [[mirrors and hand == "left" for hand in sample.acting_hands] for sample in samples]

    def vectors(self, fractions: Sequence[float]) -> tuple[NDArray[np.float32], Indices]:
        """Return one row per view and fraction, evenly thinned to no more than needed, and whose sample each row is."""
        each = len(self._shown[0]) * len(fractions)
        step = min(-(-len(self._samples) * each // MOST_VECTORS), each)
        rows, owners = [], []
        for owner, (sample, shown) in enumerate(zip(self._samples, self._shown, strict=True)):
            for fraction, view in list(product(fractions, shown))[owner % step :: step]:
                rows.append(self._pyramid.vector(self._trail(owner, view, _frames(len(sample.stamps_ns), fraction))))
                owners.append(owner)
        return np.stack(rows), np.array(owners)

    def _trail(self, owner: int, view: View, frames: int) -> Trail:
        """Return the first frames of a view as they would be read live, when it is not known which arm will act."""
        as_whole = self._left_handed[owner][frames - 1] == self._left_handed[owner][-1]
        begun = (view if as_whole else view.mirrored).until(frames)
        activities = self._first.activities(begun.postures, begun.velocities)
        steps_um = np.rint(self._samples[owner].motion[:frames].sum(axis=1) * _UM_PER_M).astype(np.int64)
        sums = np.zeros((frames + 1, activities.shape[1]), np.uint32)
        np.cumsum(quantised(activities), axis=0, out=sums[1:])
        travelled_um = [0, *np.cumsum(steps_um).tolist()]
        return Trail([Instant([own], so_far_um) for own, so_far_um in zip(sums, travelled_um, strict=True)])


def _frames(frames: int, fraction: float) -> int:
    return min(frames, max(SHORTEST_FRAMES, round(fraction * frames)))


def _fitted(
    pooling: _Pooling, fractions: Sequence[float], targets: Indices, folds: Indices, shrinkage: float
) -> Scored:
    vectors, owners = pooling.vectors(fractions)
    wanted = np.eye(targets.max() + 1)[targets[owners]]
    axes = discriminant_axes(vectors, wanted, folds[owners], shrinkage)
    return Scored(axes, owners, targets[owners], folds[owners])


def _assembled(
    samples: Sequence[SegmentSample],
    first: FirstMaps,
    fitted: Sequence[Scored],
    upper: UpperLayers,
    gains: list[float],
    origin: dict[str, Any],
    preset: PyramidPreset,
) -> PyramidModel:
    durations = np.log([max(np.ptp(sample.stamps_ns) / SECOND_NS, SHORTEST_S) for sample in samples])
    stages = Stages(
        np.stack([stage.axes.axes for stage in fitted]),
        np.stack([stage.axes.offsets for stage in fitted]),
        tuple(float(np.mean(fractions)) for fractions in preset.stages),
        float(durations.mean()),
        float(max(durations.std(), SMALLEST_LOG_SD)),
    )
    about = origin | {
        "posture_contrast": first.contrasts[0],
        "velocity_contrast": first.contrasts[1],
        "arm_contrast": first.contrasts[2],
        "arm_share": first.arm_share,
        "levels": list(preset.levels),
        "overlap": preset.overlap,
        "fractions": list(stages.fractions),
        "log_duration_mean": stages.log_duration_mean,
        "log_duration_sd": stages.log_duration_sd,
        "concept_contrast": upper.concepts.contrast,
        "gains": gains,
        "familiar": _familiar(samples, fitted[-1].axes.held_out, preset),
    }
    return PyramidModel(first, stages, upper.concepts, upper.layer3, PyramidDescription.model_validate(about))


def _familiar(samples: Sequence[SegmentSample], held_out: Floats, preset: PyramidPreset) -> float | None:
    """Return the familiarity that most samples of people left out of training exceed.

    From one person alone it cannot be told how other people differ, and nothing is to be taken for unknown.
    """
    if len({sample.person for sample in samples}) == 1:
        return None
    return float(np.quantile([familiarity_of(row) for row in held_out], 1 - preset.known_share))
