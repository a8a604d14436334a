"""Linear discriminants by ridge regression, and the cross-validated scores they give to people left out."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.samples import SegmentSample

FOLDS_WITHIN_AN_ACTION = 5  # of an action that one person alone did
MAX_PERSON_FOLDS = 10  # more people share folds: each fold costs a solution, and more say little more
SMALLEST_LENGTH2 = 1e-9  # squared length of pooled vectors: the penalty must not be 0 where all are the same


@dataclass(frozen=True, eq=False)
class Discriminants:
    """Fitted discriminants and the scores they give to the n vectors they were fitted to.

    Attributes:
        axes: (inputs, actions).
        offsets: (actions,).
        training_scores: (n, actions).
        cross_validated_scores: (n, actions), from discriminants fitted without the vector's fold; the training score
            where no other fold holds the vector's action.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    training_scores: Array
    cross_validated_scores: Array


@dataclass(frozen=True, eq=False)
class FittedStage:
    """The discriminants of one stage of an action, with what is known of the n vectors they were fitted to.

    Attributes:
        discriminants: fitted to them.
        sample_indices: (n,), which sample each vector was pooled from.
        targets: (n,), the index of its action.
    """

    discriminants: Discriminants
    sample_indices: Indices
    targets: Indices


def folds_of(samples: Sequence[SegmentSample]) -> Indices:
    """Divide samples into folds for cross-validation, shape (n,): by person, so that each is scored by the others.

    An action that only one person did is divided evenly instead: without that person nothing were known of it.
    """
    people = sorted({sample.person for sample in samples})
    by_label: dict[str, set[str]] = {}
    for sample in samples:
        by_label.setdefault(sample.label, set()).add(sample.person)
    counts: Counter[str] = Counter()
    folds = []
    for sample in samples:
        by_person = len(by_label[sample.label]) > 1
        folds.append(people.index(sample.person) % MAX_PERSON_FOLDS if by_person else counts[sample.label])
        counts[sample.label] = (counts[sample.label] + 1) % FOLDS_WITHIN_AN_ACTION
    return np.array(folds)


def fit_discriminants(
    vectors: NDArray[np.float32], indicators: Array, folds: Indices, shrinkage: float
) -> Discriminants:
    """Fit scores = vectors · axes + offsets to indicators, minimising squared error + penalty × ‖axes‖².

    The penalty is `shrinkage` times the mean squared length of the centred vectors. The axes are sought in the span of
    the vectors (dual form), so that one inverse of their n × n inner products serves all folds.

    Args:
        vectors: (n, inputs).
        indicators: (n, actions), 1 for the action done, else 0.
        folds: (n,), from `folds_of`.
        shrinkage: relative penalty.
    """
    mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
    centred = vectors - mean
    products = (centred @ centred.T).astype(np.float64)
    penalty = shrinkage * max(float(np.trace(products)) / len(products), SMALLEST_LENGTH2)
    inverse = np.linalg.inv(products + penalty * np.eye(len(products)))
    intercept: Array = indicators.mean(axis=0)
    dual = inverse @ (indicators - intercept)
    axes = centred.T @ dual.astype(np.float32)
    training_scores = products @ dual + intercept
    cross_validated = _cross_validated(training_scores, inverse, indicators, folds)
    return Discriminants(axes, (intercept - mean @ axes).astype(np.float32), training_scores, cross_validated)


def _cross_validated(training_scores: Array, inverse: Array, indicators: Array, folds: Indices) -> Array:
    """Replace the scores (n, actions) of all vectors whose action other folds know, too."""
    scores = training_scores.copy()
    for fold in np.unique(folds):
        inside, outside = np.flatnonzero(folds != fold), np.flatnonzero(folds == fold)
        known_actions = np.flatnonzero(indicators[inside].any(axis=0))
        known = indicators[np.ix_(outside, known_actions)].any(axis=1)
        if known.any():
            scores[outside[known]] = _scores_of_left_out(inverse, indicators, inside, outside)[known]
    return scores


def _scores_of_left_out(inverse: Array, indicators: Array, inside: Indices, outside: Indices) -> Array:
    """Return the scores (outside, actions) on discriminants fitted to the rows inside, from the inverse B for all rows.

    By the inverse of a block matrix, K_oi (K_ii + penalty)⁻¹ = −B_oo⁻¹ B_oi: nothing is fitted anew.
    """
    intercept: Array = indicators[inside].mean(axis=0)
    towards = inverse[np.ix_(outside, inside)] @ (indicators[inside] - intercept)
    scores: Array = intercept - np.linalg.solve(inverse[np.ix_(outside, outside)], towards)
    return scores
