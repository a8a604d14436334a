"""The paper's recogniser, trained layer after layer (paper, sections 2.1 and 3)."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from actum.som import Som
from model_trainer.description import labels_of, provenance
from model_trainer.progress import Progress
from model_trainer.samples import SegmentSample
from som_classifier.attention import UNSEEN, attended, part_inputs, winners
from som_classifier.paper_model import PaperDescription, PaperModel
from som_classifier.presets import MapPlan, PaperPreset
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import ordered_vector, without_repeats

Array = NDArray[np.float64]
NEIGHBOUR_CHUNK = 64


def train(samples: Sequence[SegmentSample], preset: PaperPreset, seed: int, progress: Progress) -> PaperModel:
    """Train the three layers, one after the other; the same samples, preset and seed make the same model.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    labels = labels_of(samples)
    rng = np.random.default_rng(seed)
    parts = [_attended(sample, preset.part) for sample in samples]
    inputs = np.concatenate([_part_vectors(sample, part) for sample, part in zip(samples, parts, strict=True)])
    layer1 = _trained_map(preset.layer1, inputs, rng, progress, "layer 1")
    traces = [_trace(layer1, sample, part) for sample, part in zip(samples, parts, strict=True)]
    points = max(2, *map(len, traces))
    vectors = np.stack([ordered_vector(trace, points) for trace in traces])
    layer2 = _trained_map(preset.layer2, vectors, rng, progress, "layer 2")
    contrast = preset.relative_contrast * typical_distance2(vectors)
    activities = np.stack([activity(layer2.excess2(vector), contrast) for vector in vectors])
    targets = np.array([labels.index(sample.label) for sample in samples])
    layer3 = SupervisedLayer.random(len(labels), activities.shape[1], rng).train(
        activities, targets, preset.beta, preset.epochs, rng, partial(progress, "layer 3")
    )
    about = provenance(samples, preset, seed) | {"points": points, "contrast": contrast, "part": preset.part}
    return PaperModel(layer1, layer2, layer3, PaperDescription.model_validate(about))


def typical_distance2(vectors: Array) -> float:
    """Return the median squared distance of each row (n, dim) to its nearest other row; 1 where that is 0.

    The rows are grid coordinates, so 1 is the smallest distance there is between two neurons.
    """
    nearest = [_nearest_distance2(vectors, start) for start in range(0, len(vectors), NEIGHBOUR_CHUNK)]
    return float(np.median(np.concatenate(nearest))) or 1.0


def _nearest_distance2(vectors: Array, start: int) -> Array:
    chunk = vectors[start : start + NEIGHBOUR_CHUNK]
    distances2 = np.square(chunk[:, None] - vectors).sum(axis=2)
    distances2[np.arange(len(chunk)), np.arange(start, start + len(chunk))] = np.inf
    nearest: Array = distances2.min(axis=1)
    return nearest


def _attended(sample: SegmentSample, fixed: str | None) -> int:
    there = [np.isfinite(part_inputs(joints)).any(axis=1) for joints in sample.joints]
    return attended(sample.motion, fixed, np.any(there, axis=0))


def _part_vectors(sample: SegmentSample, part: int) -> Array:
    """Return a part's input in each frame that has some of it, shape (n, 9)."""
    inputs = np.stack([part_inputs(joints)[part] for joints in sample.joints])
    known: Array = inputs[~np.isnan(inputs).all(axis=1)]
    return known


def _trace(layer1: Som, sample: SegmentSample, part: int) -> Array:
    """Walk the first map frame by frame, through the same product as the recogniser."""
    walked = np.array([winners(layer1, joints)[part] for joints in sample.joints])
    return layer1.coordinates[without_repeats(walked[walked != UNSEEN])]


def _trained_map(plan: MapPlan, vectors: Array, rng: np.random.Generator, progress: Progress, stage: str) -> Som:
    untrained = Som.random(plan.rows, plan.cols, vectors.shape[1], rng)
    return untrained.train(vectors, plan.steps, plan.schedule, rng, partial(progress, stage))
