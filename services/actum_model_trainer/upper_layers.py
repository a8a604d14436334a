"""The map of actions and the neurons on it, trained on scores; and how sure their answers may be."""

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import Som
from actum_model_trainer.description import TrainingError
from actum_model_trainer.discriminants import Axes
from actum_model_trainer.progress import Progress
from som_classifier.map_activity import soft_activity
from som_classifier.presets import PyramidPreset
from som_classifier.second_layer import ActionMap
from som_classifier.supervised import SupervisedLayer

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

    action_map: ActionMap
    layer3: SupervisedLayer

    def cosines(self, scores: Floats) -> Floats:
        """Return each neuron's cosine for each row of scores (n, actions)."""
        heard = self.action_map.centred(
            soft_activity(self.action_map.som.excess2s(scores.astype(np.float32)), self.action_map.contrast)
        )
        cosines: Floats = heard @ self.layer3.weights.T / np.sqrt(np.square(heard).sum(axis=1, keepdims=True))
        return cosines


def train_upper(
    stage: Scored, actions: int, preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> UpperLayers:
    """Train both on the complete actions, on scores partly of the final axes, partly of axes without the person.

    The first alone are too clean, the second too poor: the final axes know more people than any of theirs. Few scores
    are filled up with mixtures, so that both layers also know what lies between the actions, where other people's are.

    Raises:
        TrainingError: the scores of all samples are the same.
    """
    share = preset.held_out_share
    scores = share * stage.axes.held_out + (1 - share) * stage.axes.own
    scores, targets = mixed(scores, stage.targets, preset.fewest_scores, preset.least_share, rng)
    return _trained(scores.astype(np.float32), targets, actions, preset, rng, progress)


def mixed(
    scores: Floats, targets: Indices, fewest: int, least_share: float, rng: np.random.Generator
) -> tuple[Floats, Indices]:
    """Return the scores (n, actions) and mixtures of two of them, filled up to `fewest` rows, and the targets of all.

    A mixture is m × one + (1 − m) × another, m drawn evenly from `least_share` to 1, and has the target of the one.
    """
    missing = max(fewest - len(scores), 0)
    one, other = rng.integers(len(scores), size=(2, missing))
    shares = rng.uniform(least_share, 1.0, (missing, 1))
    mixtures = shares * scores[one] + (1 - shares) * scores[other]
    return np.concatenate([scores, mixtures]), np.concatenate([targets, targets[one]])


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
    activities = soft_activity(layout.excess2s(scores), contrast)
    unit = activities / np.sqrt(np.square(activities).sum(axis=1, keepdims=True))
    action_map = ActionMap(layout, contrast, unit.mean(axis=0, dtype=np.float64).astype(np.float32))
    inputs = action_map.centred(activities).astype(np.float64)
    if not inputs.any():
        raise TrainingError("all samples move alike: their actions cannot be told apart")
    layer3 = SupervisedLayer.of_means(inputs, targets, actions).train(
        inputs, targets, preset.beta, preset.epochs, rng, partial(progress, "neurons")
    )
    return UpperLayers(action_map, SupervisedLayer(layer3.weights.astype(np.float32)))


def variance_within(scores: Floats, targets: Indices) -> float:
    """Return the mean over actions and components of the scores' variance within an action."""
    variances = [scores[targets == target].var(axis=0).mean() for target in np.unique(targets)]
    return float(np.mean(variances)) or 1e-6
