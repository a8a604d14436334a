"""Calibration of a model: inverse temperatures of its confidence, and how much people move in an action.

Inverse temperatures are estimated on cross-validated scores, which show how well the model does on people it was not
trained on. Few people show little of that, a single one nothing. Therefore each estimate is averaged with the value for
models of other people's actions (`som_classifier.presets.Prior`), which counts as much as `Prior.people` further
people.
"""

import math
from collections.abc import Sequence
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Floats, Indices
from actum.limits import MAX_COORDINATE_M
from actum_model_trainer.discriminants import FittedStage
from actum_model_trainer.temperature_scaling import matched_inverse_temperature
from actum_model_trainer.upper_layers import UpperLayers
from som_classifier.body_movement import BodyMovement
from som_classifier.first_layer import FirstMaps
from som_classifier.presets import Prior

LEAST_MOVEMENT_SHARE = 0.5
"""Share of an action's usual movement below which another person hardly does it. Of the actions of four public sets, at
most one in a hundred moves less, and in most of them one in 250; see `benchmarks.recognition.stillness`."""
USUAL_SHARE = 0.99
"""Share of true instances in which legs and trunk move no more than is expected of the action."""
LEAST_ABOVE = math.log(2.0)
"""Legs or a trunk may always move twice as much: people who all stand still show nothing of how others move."""


def inverse_temperatures(
    stages: Sequence[FittedStage], upper: UpperLayers, prior: Prior, people: int, depth_inferred: bool
) -> list[float]:
    """Return the inverse temperature of each stage: the matched one averaged with the prior's, at most the matched one.

    People within a training set differ less from one another than from new people, so that the matched inverse
    temperature tends to be too large and is never too small.

    Args:
        stages: with their cross-validated scores.
        upper: the layers that turn scores into cosines.
        prior: of models of other people's actions.
        people: number of people in the training.
        depth_inferred: whether some distances were inferred from an image and a standard body's size: less exact.
    """
    expected = prior.gain_where_inferred if depth_inferred else prior.gain
    matched = np.array([cross_validated_inverse_temperature(stage, upper) for stage in stages])
    averaged = np.exp(averaged_with_prior(np.log(matched), np.log(expected), prior, people))
    return [float(inverse_temperature) for inverse_temperature in np.minimum(matched, averaged)]


def cross_validated_inverse_temperature(stage: FittedStage, upper: UpperLayers) -> float:
    """Return the inverse temperature that makes the mean confidence equal the accuracy of the cross-validated scores.

    An answer counts as right where the largest score is that of the action done. The accuracy is that of the scores,
    not of the cosines, because the upper layers were trained on these very scores. Laplace's rule (one right and one
    wrong answer more) keeps the accuracy below 1 where all n answers are right.
    """
    scores = stage.discriminants.cross_validated_scores
    right = int((scores.argmax(axis=1) == stage.targets).sum())
    return matched_inverse_temperature(upper.cosines(scores), (right + 1) / (len(stage.targets) + 2))


def log_errors_of(first: FirstMaps, postures: Sequence[Floats]) -> Array:
    """Return the mean log(d²) of each sample's postures (frames, 15, 3), d the distance (m) to the posture map."""
    return np.array([first.log_errors(frames, first.winners(frames)).mean() for frames in postures])


def expected_log_errors(log_errors: Array, targets: Indices, prior: Prior) -> list[float]:
    """Return for each action the mean log(d²), d the distance (m) to the posture map, to expect of a new person.

    It is the prior's, plus the difference between the action's own mean and that of all samples: a map has few units
    for rare postures. Each action's mean difference is shrunk towards 0, as if by one more sample of difference 0.

    Args:
        log_errors: (n,), of the samples.
        targets: (n,), the samples' actions.
        prior: of models of other people's actions.
    """
    above_mean = np.bincount(targets, weights=log_errors - log_errors.mean()) / (np.bincount(targets) + 1)
    return [float(prior.log_error + difference) for difference in above_mean]


def least_movement_m(movements_m: Array, targets: Indices) -> float:
    """Return the movement (m) below which a segment may be none of the trained actions.

    It is a share of that of the action that moves least, so that holding still can be taught, and that of an action is
    the median over its samples, so that a single one marked in the wrong place does not decide.

    Args:
        movements_m: (n,), of the samples.
        targets: (n,), their actions.
    """
    medians = [median(movements_m[targets == target].tolist()) for target in np.unique(targets)]
    return float(round(LEAST_MOVEMENT_SHARE * min(medians), 4))


def body_movement(
    moved: Array, movements_m: Array, targets: Indices, who: NDArray[np.str_], prior: Prior, people: int
) -> BodyMovement:
    """Return how much people move in each action.

    How far legs and trunk may move above that is a quantile over the samples, each beside the mean of its action by
    other people, averaged with the prior's, and at least `LEAST_ABOVE`. A part that no sample of an action shows may
    move as it likes.

    Args:
        moved: (n, 2), the logarithm of how much legs and trunk move in each sample (m), NaN where that is not seen.
        movements_m: (n,), how much everything moves.
        targets: (n,), the samples' actions.
        who: (n,), who performed each sample.
        prior: of models of other people's actions.
        people: who performed the samples.
    """
    above, usual = np.empty_like(moved), []
    for target in range(targets.max() + 1):
        of_action = np.flatnonzero(targets == target)
        usual.append(_means(moved[of_action]))
        for person in np.unique(who[of_action]):
            own = who[of_action] == person
            above[of_action[own]] = moved[of_action[own]] - _means(moved[of_action[~own]])
    shown = np.array([_quantile(of_part, prior.movement_above) for of_part in above.T])
    most_above = np.maximum(averaged_with_prior(shown, prior.movement_above, prior, people), LEAST_ABOVE)
    least_m = least_movement_m(movements_m, targets)
    return BodyMovement(np.nan_to_num(usual, nan=math.log(MAX_COORDINATE_M)).tolist(), most_above.tolist(), least_m)


def _means(rows: Array) -> Array:
    """Return the mean of each column over the rows (n, 2) that have it, NaN where none has."""
    known = ~np.isnan(rows)
    sums = np.where(known, rows, 0.0).sum(axis=0)
    means: Array = np.divide(sums, known.sum(axis=0), out=np.full(rows.shape[1], np.nan), where=known.any(axis=0))
    return means


def _quantile(above: Array, otherwise: float) -> float:
    known = above[~np.isnan(above)]
    return float(np.quantile(known, USUAL_SHARE)) if len(known) else otherwise


def averaged_with_prior(estimate: Any, expected: Any, prior: Prior, people: int) -> Any:
    """Return the mean of both, the estimate weighted by the people beyond the first: one shows no differences."""
    return (prior.people * expected + (people - 1) * estimate) / (prior.people + people - 1)
