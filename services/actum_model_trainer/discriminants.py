"""Linear discriminants by ridge regression, and the cross-validated scores they give to people left out."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Floats, Indices
from actum_model_trainer.samples import SegmentSample

FOLDS_WITHIN_AN_ACTION = 5  # of an action that one person alone did
MAX_PERSON_FOLDS = 10  # more people share folds: each fold costs a linear solve, and more folds change little
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
        untaught_scores: (n, actions), from discriminants fitted without the vector's action, as if untaught.
        background_scores: (m, actions), of the background's vectors, from discriminants fitted without the vector.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    training_scores: Array
    cross_validated_scores: Array
    untaught_scores: Array
    background_scores: Array


@dataclass(frozen=True, eq=False)
class FittedStage:
    """The discriminants of one stage of an action, with sample and action of the n vectors they were fitted to.

    Attributes:
        discriminants: fitted to them.
        sample_indices: (n,), which sample each vector was pooled from.
        targets: (n,), the index of its action.
    """

    discriminants: Discriminants
    sample_indices: Indices
    targets: Indices


def folds_of(samples: Sequence[SegmentSample]) -> Indices:
    """Return the fold of each sample for cross-validation, shape (n,): one per person, who is so scored by the others.

    The samples of an action that only one person did are divided evenly: the others hold no sample of it.
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
    vectors: NDArray[np.float32],
    indicators: Array,
    folds: Indices,
    shrinkage: float,
    background: NDArray[np.float32] | None = None,
) -> Discriminants:
    """Fit scores = vectors · axes + offsets to indicators, minimising squared error + penalty × ‖axes‖².

    The axes are sought in the span of the vectors (`dual_form`), so that one inverse of their inner products serves all
    folds.

    Args:
        vectors: (n, inputs).
        indicators: (n, actions), 1 for the action done, else 0.
        folds: (n,), from `folds_of`.
        shrinkage: relative penalty.
        background: (m, inputs), vectors of movement that is none of the actions: all their indicators are 0.
    """
    count = len(vectors)
    if background is not None:
        vectors = np.concatenate([vectors, background])
        indicators = np.concatenate([indicators, np.zeros((len(background), indicators.shape[1]))])
    mean, centred, products, penalty = dual_form(vectors, shrinkage)
    inverse = np.linalg.inv(products + penalty * np.eye(len(products)))
    intercept: Array = indicators.mean(axis=0)
    dual = inverse @ (indicators - intercept)
    axes = centred.T @ dual.astype(np.float32)
    fitted = products @ dual + intercept
    return Discriminants(
        axes,
        (intercept - mean @ axes).astype(np.float32),
        fitted[:count],
        _cross_validated(fitted, inverse, indicators, folds),
        _untaught(inverse, indicators, count),
        _each_left_out(inverse, indicators, count),
    )


def dual_form(
    vectors: NDArray[np.float32], shrinkage: float
) -> tuple[NDArray[np.float32], NDArray[np.float32], Array, float]:
    """Return the mean (inputs,) of vectors (n, inputs), the centred vectors, their inner products (n, n), the penalty.

    The penalty is `shrinkage` times the mean squared length of the centred vectors.
    """
    mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
    centred = vectors - mean
    products = (centred @ centred.T).astype(np.float64)
    return mean, centred, products, shrinkage * max(float(np.trace(products)) / len(products), SMALLEST_LENGTH2)


def _cross_validated(training_scores: Array, inverse: Floats, indicators: Array, folds: Indices) -> Array:
    """Return the scores (n, actions), cross-validated for all vectors whose action occurs in another fold, too.

    Rows beyond the n folds are background, which is fitted to in every fold.
    """
    scores, rows = training_scores[: len(folds)].copy(), np.arange(len(indicators))
    for fold in np.unique(folds):
        held_out = np.flatnonzero(folds == fold)
        fitted = np.delete(rows, held_out)
        fitted_actions = np.flatnonzero(indicators[fitted].any(axis=0))
        scorable = indicators[np.ix_(held_out, fitted_actions)].any(axis=1)
        if scorable.any():
            scores[held_out[scorable]] = _held_out_scores(inverse, indicators, fitted, held_out)[scorable]
    return scores


def _held_out_scores(inverse: Floats, indicators: Array, fitted: Indices, held_out: Indices) -> Array:
    """Return the scores (held out, actions) of discriminants fitted to the other rows, from the inverse B for all rows.

    By the inverse of a block matrix, K_hf (K_ff + penalty)⁻¹ = −B_hh⁻¹ B_hf: no discriminants need be fitted.
    """
    intercept: Array = indicators[fitted].mean(axis=0)
    product = inverse[np.ix_(held_out, fitted)] @ (indicators[fitted] - intercept)
    scores: Array = intercept - np.linalg.solve(inverse[np.ix_(held_out, held_out)], product)
    return scores


def _untaught(inverse: Floats, indicators: Array, count: int) -> Array:
    """Return the scores (count, actions) of the first rows by discriminants that were fitted without their action."""
    scores, rows = np.zeros((count, indicators.shape[1])), np.arange(len(indicators))
    for of_action in indicators[:count].T:
        held_out = np.flatnonzero(of_action)
        scores[held_out] = _held_out_scores(inverse, indicators, np.delete(rows, held_out), held_out)
    return scores


def _each_left_out(inverse: Floats, indicators: Array, count: int) -> Array:
    """Return the scores of the rows from `count` on, each by discriminants that were fitted to all other rows.

    By the leave-one-out formula of ridge regression: no discriminants need be fitted. The mean is that of all rows.
    """
    dual = inverse[count:] @ (indicators - indicators.mean(axis=0))
    scores: Array = indicators[count:] - dual / np.diag(inverse)[count:, None]
    return scores
