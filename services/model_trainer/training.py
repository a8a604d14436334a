"""Training samples become a model, layer after layer (paper, sections 2.1 and 3)."""

import hashlib
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial

import numpy as np
from numpy.typing import NDArray

import actum
from actum.som import Som
from model_trainer.progress import Progress, silent
from model_trainer.samples import SegmentSample
from som_classifier.attention import attended, part_inputs
from som_classifier.model import Description, Model
from som_classifier.presets import MapPlan, Preset
from som_classifier.supervised import SupervisedLayer, activity
from som_classifier.trace import ordered_vector, without_repeats

Array = NDArray[np.float64]
NEIGHBOUR_CHUNK = 64


class TrainingError(ValueError):
    """The samples cannot make a model."""


def train(samples: Sequence[SegmentSample], preset: Preset, seed: int = 0, progress: Progress = silent) -> Model:
    """Train the three layers, one after the other; the same samples, preset and seed make the same model.

    Raises:
        TrainingError: fewer than two actions among the samples.
    """
    labels = sorted({sample.label for sample in samples})
    if len(labels) < 2:
        raise TrainingError(f"samples of at least two actions are needed; these are of {labels or 'none'}")
    rng = np.random.default_rng(seed)
    inputs = [_attended_inputs(sample, preset.part) for sample in samples]
    layer1 = _trained_map(preset.layer1, np.concatenate([x[:, part] for x, part in inputs]), rng, progress, "layer 1")
    traces = [_trace(layer1, *attended_inputs) for attended_inputs in inputs]
    points = max(2, *map(len, traces))
    vectors = np.stack([ordered_vector(trace, points) for trace in traces])
    layer2 = _trained_map(preset.layer2, vectors, rng, progress, "layer 2")
    contrast = preset.relative_contrast * typical_distance2(vectors)
    activities = np.stack([activity(layer2.excess2(vector), contrast) for vector in vectors])
    targets = np.array([labels.index(sample.label) for sample in samples])
    layer3 = SupervisedLayer.random(len(labels), activities.shape[1], rng).train(
        activities, targets, preset.beta, preset.epochs, rng, partial(progress, "layer 3")
    )
    return Model(layer1, layer2, layer3, _description(samples, labels, points, contrast, preset, seed))


def typical_distance2(vectors: Array) -> float:
    """Return the median squared distance of each row to its nearest other row; 1 where that is 0.

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


def _attended_inputs(sample: SegmentSample, fixed: str | None) -> tuple[Array, int]:
    """Return every part's input in each frame, shape (n, 5, 9), and the part attended to."""
    return np.stack([part_inputs(joints) for joints in sample.joints]), attended(sample.motion, fixed)


def _trace(layer1: Som, inputs: Array, part: int) -> Array:
    """Walk the first map frame by frame, through the same product as the recogniser."""
    winners = np.array([layer1.bmus(frame)[part] for frame in inputs])
    return layer1.coordinates[without_repeats(winners)]


def _trained_map(plan: MapPlan, vectors: Array, rng: np.random.Generator, progress: Progress, stage: str) -> Som:
    untrained = Som.random(plan.rows, plan.cols, vectors.shape[1], rng)
    return untrained.train(vectors, plan.steps, plan.schedule, rng, partial(progress, stage))


def _description(
    samples: Sequence[SegmentSample], labels: list[str], points: int, contrast: float, preset: Preset, seed: int
) -> Description:
    return Description(
        labels=labels,
        points=points,
        contrast=contrast,
        part=preset.part,
        preset=preset.name,
        parameters=asdict(preset),
        seed=seed,
        persons=sorted({sample.person for sample in samples if sample.person}),
        samples=len(samples),
        data_digest=digest_of(samples),
        actum_version=actum.__version__,
    )


def digest_of(samples: Sequence[SegmentSample]) -> str:
    """Return the SHA-256 over what a training sees of its samples, in their order."""
    digest = hashlib.sha256()
    for sample in samples:
        digest.update(f"{sample.label}\0{sample.joints.shape}".encode())
        digest.update(np.ascontiguousarray(sample.joints).tobytes())
        digest.update(np.ascontiguousarray(sample.motion).tobytes())
    return digest.hexdigest()
