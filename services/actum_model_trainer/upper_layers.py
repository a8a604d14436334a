"""Training of the layers above the discriminants: the action map and the neurons, both on the discriminants' scores."""

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Floats, Indices
from actum.som import Som
from actum_model_trainer.discriminants import FittedStage
from actum_model_trainer.progress import Progress
from actum_model_trainer.provenance import TrainingError
from som_classifier.map_activity import soft_activity
from som_classifier.presets import PyramidPreset
from som_classifier.second_layer import ActionMap
from som_classifier.supervised import SupervisedLayer

SMALLEST_VARIANCE = 1e-6  # squared scores: a contrast divides by it and must not be 0


@dataclass(frozen=True, eq=False)
class UpperLayers:
    """The layers that turn scores into cosines.

    Attributes:
        action_map: the second layer.
        layer3: one neuron per action.
    """

    action_map: ActionMap
    layer3: SupervisedLayer

    def cosines(self, scores: Floats) -> Floats:
        """Return each neuron's cosine for each row of scores (n, actions), in the same shape."""
        som = self.action_map.som
        inputs = self.action_map.centred(
            soft_activity(som.excess2s(scores.astype(np.float32)), self.action_map.contrast)
        )
        cosines: Floats = inputs @ self.layer3.weights.T / np.sqrt(np.square(inputs).sum(axis=1, keepdims=True))
        return cosines


def train_upper(
    stage: FittedStage, actions: int, preset: PyramidPreset, rng: np.random.Generator, progress: Progress
) -> UpperLayers:
    """Train both layers on scores of complete actions, each a weighted mean of training and cross-validated score.

    Training scores are better than the scores of new people will be; cross-validated scores are worse, because their
    discriminants were fitted to fewer people than the final ones. Where there are few scores, mixup adds more, so
    that both layers also learn the region between the actions, where the scores of new people lie.

    Raises:
        TrainingError: the scores of all samples are the same.
    """
    fitted, share = stage.discriminants, preset.held_out_share
    blended = share * fitted.cross_validated_scores + (1 - share) * fitted.training_scores
    mixed, targets = mixup(blended, stage.targets, preset.fewest_scores, preset.least_share, rng)
    scores = mixed.astype(np.float32)
    action_map, activities = _trained_action_map(scores, targets, preset, progress)
    inputs = action_map.centred(activities).astype(np.float64)
    if not inputs.any():
        raise TrainingError(
            "all examples show the same movement, so the actions cannot be distinguished: record the examples again"
        )
    layer3 = SupervisedLayer.of_means(inputs, targets, actions).train(
        inputs, targets, preset.beta, preset.epochs, rng, partial(progress, "neurons")
    )
    return UpperLayers(action_map, SupervisedLayer(layer3.weights.astype(np.float32)))


def mixup(
    scores: Floats, targets: Indices, fewest: int, least_share: float, rng: np.random.Generator
) -> tuple[Floats, Indices]:
    """Return the scores and convex combinations of pairs of them (mixup), with the targets, `fewest` rows at least.

    A combination m × first + (1 − m) × second, with m uniform from `least_share` to 1, has the target of the first.

    Args:
        scores: (n, actions).
        targets: (n,), the index of each one's action.
        fewest: the least number of rows of the result, which are (max(n, fewest), actions).
        least_share: the smallest weight of the first in a combination.
        rng: draws pairs and weights.
    """
    missing = max(fewest - len(scores), 0)
    first, second = rng.integers(len(scores), size=(2, missing))
    shares = rng.uniform(least_share, 1.0, (missing, 1))
    mixtures = shares * scores[first] + (1 - shares) * scores[second]
    return np.concatenate([scores, mixtures]), np.concatenate([targets, targets[first]])


def _trained_action_map(
    scores: NDArray[np.float32], targets: Indices, preset: PyramidPreset, progress: Progress
) -> tuple[ActionMap, Floats]:
    """Return the map, trained on scores (n, actions), and its soft activities for them, (n, units)."""
    som = Som.linear(*preset.concepts, scores).train_batch(
        scores, preset.concept_epochs, preset.concept_radius, partial(progress, "map of actions")
    )
    contrast = preset.relative_concept_contrast * within_class_variance(scores, targets)
    activities = soft_activity(som.excess2s(scores), contrast)
    unit_length = activities / np.sqrt(np.square(activities).sum(axis=1, keepdims=True))
    return ActionMap(som, contrast, unit_length.mean(axis=0, dtype=np.float64).astype(np.float32)), activities


def within_class_variance(scores: Floats, targets: Indices) -> float:
    """Return the mean, over actions and components, of the variance of scores (n, actions) within an action.

    Args:
        scores: (n, actions).
        targets: (n,), the index of each one's action.
    """
    variances = [scores[targets == target].var(axis=0).mean() for target in np.unique(targets)]
    return float(np.mean(variances)) or SMALLEST_VARIANCE
