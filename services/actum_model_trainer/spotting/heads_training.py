"""Training of the completeness heads: ridge regression, once on all windows and once without each fold."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.discriminants import SMALLEST_LENGTH2
from som_classifier.spotting.spotting_model import CompletenessHeads


@dataclass(frozen=True, eq=False)
class FoldedHeads:
    """Heads trained on all windows, and on those of all folds but one.

    Attributes:
        all: on all.
        without: by the fold that was left out.
    """

    all: CompletenessHeads
    without: Sequence[CompletenessHeads]


def fit_heads(
    vectors: NDArray[np.float32], completeness: Array, folds: Indices, fold_count: int, shrinkage: float
) -> FoldedHeads:
    """Fit completeness = vectors * axes + offsets by least squares + penalty * ‖axes‖².

    The penalty is `shrinkage` times the mean squared length of the centred vectors. The axes are sought in the span of
    the vectors (dual form), so that one matrix of n × n inner products serves all folds.

    Args:
        vectors: (n, inputs).
        completeness: (n, actions).
        folds: (n,), 0 to fold_count - 1.
        fold_count: how many there are; some may hold no window.
        shrinkage: relative penalty.
    """
    mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
    centred = vectors - mean
    products = (centred @ centred.T).astype(np.float64)
    penalty = shrinkage * max(float(np.trace(products)) / len(products), SMALLEST_LENGTH2)

    def without(fold: int | None) -> CompletenessHeads:
        kept = np.flatnonzero(folds != fold)
        kept_mean = completeness[kept].mean(axis=0) if len(kept) else np.zeros(completeness.shape[1])
        regularised = products[np.ix_(kept, kept)] + penalty * np.eye(len(kept))
        dual = np.linalg.solve(regularised, completeness[kept] - kept_mean)
        axes = centred[kept].T @ dual.astype(np.float32)
        return CompletenessHeads(axes, (kept_mean - mean @ axes).astype(np.float32))

    return FoldedHeads(without(None), [without(fold) for fold in range(fold_count)])
