"""Three things that are not as the paper prints them: its axes, its neighbourhood, its activity."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from benchmarks.recognition.scores import table
from numpy.typing import NDArray

from actum import geometry
from actum.som import Som
from som_classifier.attention import PART_NAMES, PostureInput
from som_classifier.presets import PAPER

from .data import Data

Floats = NDArray[Any]
STEPS = 20_000
PRINTED_SIGMA = 1e6
ARM = PostureInput(PAPER.posture.axes, PAPER.posture.origin, "right_arm")


def details(data: Data) -> Iterator[str]:
    """On the training people of MSR Action3D."""
    steps_deg = np.concatenate([turns_deg(joints_m) for joints_m in data.msr_in_camera_m])
    yield f"""All sequences of MSR Action3D, {len(steps_deg)} steps from a frame to the next: the axes of every posture
turn by {np.median(steps_deg):.1f}° in the median, and by {np.quantile(steps_deg, 0.99):.0f}° or more in one of a
hundred."""
    training, _ = data.odd_even()
    vectors = np.concatenate([_arm(sample.postures) for sample in training]).astype(np.float32)
    errors = {name: _quantization_error(vectors, power) for name, power in (("squared", 2.0), ("as printed", 1.0))}
    yield f"""The first map of the right arm of people 1, 3, 5, 7 and 9, {STEPS} steps from the same weights through the
same postures, G = exp(−‖r_c − r‖² / 2σ²) and exp(−‖r_c − r‖ / 2σ²):"""
    yield table(("neighbourhood", "quantization error, m"), ([name, f"{error:.4f}"] for name, error in errors.items()))
    yield f"""y = exp(−s / 10⁶) in single precision, s in metres: in {100 * _winner_kept(vectors):.0f} % of these
postures the largest y is the nearest neuron's."""


def turns_deg(joints_m: Floats) -> Floats:
    """Return by how much the axes of postures (n, 15, 3) turn from each to the next, shape (n − 1,)."""
    turned = geometry.ego_from_camera(joints_m)[:, :3, :3]
    cosines = (np.einsum("nij,nij->n", turned[1:], turned[:-1]) - 1) / 2
    degrees: Floats = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    return degrees


def _arm(postures: Floats) -> Floats:
    arm = PART_NAMES.index("right_arm")
    return np.stack([ARM.rows(posture, posture)[arm] for posture in postures])


def _quantization_error(vectors: Floats, power: float) -> float:
    """Train a map step by step with exp(−r^power / 2σ²), and return the mean distance to the winners."""
    plan, rng = PAPER.layer1, np.random.default_rng(0)
    som = Som.random(plan.rows, plan.cols, vectors.shape[1], rng)
    weights, places = som.weights.copy(), som.coordinates
    for alpha, radius in zip(*plan.schedule.values(STEPS), strict=True):
        x = vectors[rng.integers(len(vectors))]
        winner = int(np.square(weights - x).sum(axis=1).argmin())
        away = np.linalg.norm(places - places[winner], axis=1) ** power
        weights += alpha * np.exp(-away / (2 * radius**2))[:, None] * (x - weights)
    return Som(plan.rows, plan.cols, weights).quantization_error(vectors)


def _winner_kept(vectors: Floats) -> float:
    """Return how often argmax y is argmin s on a trained map, everything in single precision."""
    plan, rng = PAPER.layer1, np.random.default_rng(0)
    untrained = Som.random(plan.rows, plan.cols, vectors.shape[1], rng, dtype=np.float32)
    som = untrained.train(vectors, STEPS, plan.schedule, rng)
    weights = som.weights.astype(np.float64)
    distances = np.stack([np.linalg.norm(weights - x, axis=1) for x in vectors[::20]]).astype(np.float32)
    activities = np.exp(-distances / np.float32(PRINTED_SIGMA))
    return float((activities.argmax(axis=1) == distances.argmin(axis=1)).mean())
