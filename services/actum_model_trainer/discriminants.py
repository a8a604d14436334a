"""Linear discriminants by ridge regression, and the cross-validated scores they give to people left out."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.basis import Basis
from actum_model_trainer.ridge import DualRidge, PrimalRidge, ridge, ridges_of_first_and_all

FOLDS_WITHIN_AN_ACTION = 5  # of an action that one person alone did
MAX_PERSON_FOLDS = 10  # more people share folds: each fold costs a linear solve, and more folds change little


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

    def through(self, basis: Basis | None) -> "Discriminants":
        """Return the discriminants for vectors, where these are for the vectors' coordinates in a basis."""
        if basis is None:
            return self
        axes = basis.axes(self.axes)
        return replace(self, axes=axes, offsets=basis.offsets(self.offsets, axes))


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


def folds_of(people: Sequence[str], labels: Sequence[str]) -> Indices:
    """Return the fold of each sample for cross-validation, shape (n,): one per person, who is so scored by the others.

    The samples of an action that only one person did are divided evenly: the others hold no sample of it.

    Args:
        people: (n,), who performed each sample.
        labels: (n,), the action of each.
    """
    everybody = sorted(set(people))
    by_label: dict[str, set[str]] = {}
    for person, label in zip(people, labels, strict=True):
        by_label.setdefault(label, set()).add(person)
    counts: Counter[str] = Counter()
    number, folds = {person: index for index, person in enumerate(everybody)}, []
    for person, label in zip(people, labels, strict=True):
        folds.append(number[person] % MAX_PERSON_FOLDS if len(by_label[label]) > 1 else counts[label])
        counts[label] = (counts[label] + 1) % FOLDS_WITHIN_AN_ACTION
    return np.array(folds)


def fit_discriminants(
    vectors: NDArray[np.float32], indicators: Array, folds: Indices, shrinkage: float
) -> Discriminants:
    """Fit scores = vectors · axes + offsets to indicators, minimising squared error + penalty × ‖axes‖².

    Args:
        vectors: (n, inputs).
        indicators: (n, actions), 1 for the action done, else 0.
        folds: (n,), from `folds_of`.
        shrinkage: relative penalty.
    """
    return _scored(ridge(vectors, indicators, shrinkage), indicators, folds)


def fit_without_and_with(
    vectors: NDArray[np.float32],
    indicators: Array,
    folds: Indices,
    shrinkage: float,
    background: NDArray[np.float32],
) -> list[Discriminants]:
    """Fit discriminants to the vectors alone, as `fit_discriminants` does, and others to vectors and background.

    Args:
        vectors: (n, inputs).
        indicators: (n, actions).
        folds: (n,).
        shrinkage: relative penalty.
        background: (m, inputs), vectors of movement that is none of the actions: all their indicators are 0.
    """
    every = np.concatenate([vectors, background])
    padded = np.concatenate([indicators, np.zeros((len(background), indicators.shape[1]))])
    without, beside = ridges_of_first_and_all(every, padded, len(vectors), shrinkage)
    return [_scored(without, indicators, folds), _scored(beside, padded, folds)]


def _scored(fitted: DualRidge | PrimalRidge, indicators: Array, folds: Indices) -> Discriminants:
    """Return fitted discriminants with the scores that they give; rows beyond the n folds are background."""
    count = len(folds)
    return Discriminants(
        fitted.axes,
        fitted.offsets,
        fitted.scores[:count],
        _cross_validated(fitted, indicators, folds),
        _untaught(fitted, indicators, count),
        fitted.each_left_out(count),
    )


def _cross_validated(fitted: DualRidge | PrimalRidge, indicators: Array, folds: Indices) -> Array:
    """Return the scores (n, actions), cross-validated for all vectors whose action occurs in another fold, too.

    Rows beyond the n folds are background, which is fitted to in every fold.
    """
    scores, every = fitted.scores[: len(folds)].copy(), indicators.sum(axis=0)
    each = [np.flatnonzero(folds == fold) for fold in np.unique(folds)]
    for held_out, of_fold in zip(each, fitted.held_out(each), strict=True):
        fitted_actions = np.flatnonzero(every > indicators[held_out].sum(axis=0))
        scorable = indicators[np.ix_(held_out, fitted_actions)].any(axis=1)
        scores[held_out[scorable]] = of_fold[scorable]
    return scores


def _untaught(fitted: DualRidge | PrimalRidge, indicators: Array, count: int) -> Array:
    """Return the scores (count, actions) of the first rows by discriminants that were fitted without their action."""
    scores = np.zeros((count, indicators.shape[1]))
    each = [np.flatnonzero(of_action) for of_action in indicators[:count].T]
    for held_out, of_action in zip(each, fitted.held_out(each), strict=True):
        scores[held_out] = of_action
    return scores
