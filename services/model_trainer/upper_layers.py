"""The map of actions and the neurons on it, trained on scores; and how sure their answers may be."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import Som
from model_trainer.calibration import fitted_gain
from model_trainer.description import TrainingError
from model_trainer.discriminants import Axes
from model_trainer.progress import Progress, silent
from som_classifier.layers import Concepts
from som_classifier.presets import PyramidPreset
from som_classifier.supervised import SupervisedLayer, activity

Floats = NDArray[Any]
Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Scored:
    """One stage's axes and what they were trained on.

    Attributes:
        owners: (n,), whose sample each training vector is.
        targets: (n,), which action it is.
        folds: (n,), which fold it is in.
    """

    axes: Axes
    owners: Indices
    targets: Indices
    folds: Indices


@dataclass(frozen=True, eq=False)
class UpperLayers:
    """What turns scores into an answer."""

    concepts: Concepts
    layer3: SupervisedLayer

    def cosines(self, scores: Floats) -> Floats:
        """Return each neuron's cosine for each row of scores (n, actions)."""
        heard = [self.concepts.activity(row) for row in scores.astype(np.float32)]
        return np.stack([self.layer3.cosines(activities) for activities in heard])


def train_upper(
    stage: Scored, actions: int, preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> UpperLayers:
    """Train both on the complete actions, on scores partly of the final axes, partly of axes without the person.

    The first alone are too clean, the second too poor: the final axes know more people than any of theirs.

    Raises:
        TrainingError: the scores of all samples are the same.
    """
    share = preset.held_out_share
    scores = (share * stage.axes.held_out + (1 - share) * stage.axes.own).astype(np.float32)
    return _trained(scores, stage.targets, actions, preset, rng, progress)


def held_out_gains(
    stages: Sequence[Scored], actions: int, preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> list[float]:
    """Return what makes cosines logits at each stage, fitted on people whom neither axes nor upper layers have seen."""
    cosines: list[list[Floats]] = [[] for _ in stages]
    targets: list[list[Indices]] = [[] for _ in stages]
    folds = np.unique(stages[-1].folds)
    for done, fold in enumerate(folds):
        progress("calibration", done, len(folds))
        upper = train_upper(_without(stages[-1], fold), actions, preset, rng, silent)
        for index, stage in enumerate(stages):
            outside = stage.folds == fold
            cosines[index].append(upper.cosines(stage.axes.held_out[outside]))
            targets[index].append(stage.targets[outside])
    progress("calibration", len(folds), len(folds))
    return [fitted_gain(np.concatenate(c), np.concatenate(t)) for c, t in zip(cosines, targets, strict=True)]


def _without(stage: Scored, fold: int) -> Scored:
    """Return the first view of each sample outside a fold, of all samples where those are of one action at most."""
    first = np.zeros(len(stage.owners), dtype=bool)
    first[np.unique(stage.owners, return_index=True)[1]] = True
    others = first & (stage.folds != fold)
    rows = others if len(np.unique(stage.targets[others])) > 1 else first
    axes = Axes(stage.axes.axes, stage.axes.offsets, stage.axes.own[rows], stage.axes.held_out[rows])
    return Scored(axes, stage.owners[rows], stage.targets[rows], stage.folds[rows])


def _trained(
    scores: NDArray[np.float32],
    targets: Indices,
    actions: int,
    preset: PyramidPreset,
    rng: np.random.Generator,
    progress: Progress,
) -> UpperLayers:
    layout = Som.linear(*preset.concepts, scores).train_batch(
        scores, preset.concept_epochs, preset.concept_radius, partial(progress, "map of actions")
    )
    contrast = preset.relative_concept_contrast * variance_within(scores, targets)
    activities = activity(layout.excess2s(scores), contrast)
    unit = activities / np.sqrt(np.square(activities).sum(axis=1, keepdims=True))
    concepts = Concepts(layout, contrast, unit.mean(axis=0, dtype=np.float64).astype(np.float32))
    inputs = concepts.centred(activities).astype(np.float64)
    if not inputs.any():
        raise TrainingError("all samples move alike: their actions cannot be told apart")
    layer3 = SupervisedLayer.of_means(inputs, targets, actions).train(
        inputs, targets, preset.beta, preset.epochs, rng, partial(progress, "neurons")
    )
    return UpperLayers(concepts, SupervisedLayer(layer3.weights.astype(np.float32)))


def variance_within(scores: Floats, targets: Indices) -> float:
    """Return the mean over actions and components of the scores' variance within an action."""
    variances = [scores[targets == target].var(axis=0).mean() for target in np.unique(targets)]
    return float(np.mean(variances)) or 1e-6
