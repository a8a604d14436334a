"""Ridge regression of indicators on vectors, and the scores that it gives to rows left out, without fitting it anew.

Scores = vectors · axes + offsets minimise the squared error + penalty × ‖axes‖². There are two forms, which give the
same up to rounding: the dual one for fewer vectors than inputs, the primal one for more. Neither centres the vectors
anew where rows are left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.products import inner_products, inverse_root, without_mean

SMALLEST_LENGTH2 = 1e-9
"""Squared length of vectors: the penalty must not be 0 where all are the same."""


def ridge(vectors: NDArray[np.float32], indicators: Array, shrinkage: float) -> "DualRidge | PrimalRidge":
    """Fit in the form that costs less.

    Args:
        vectors: (n, inputs).
        indicators: (n, actions).
        shrinkage: the penalty, in units of the mean squared length of the centred vectors.
    """
    if len(vectors) <= vectors.shape[1]:
        return DualRidge(DualForm.of(vectors, shrinkage), indicators)
    return PrimalRidge(vectors, indicators, shrinkage)


def ridges_of_first_and_all(
    vectors: NDArray[np.float32], indicators: Array, count: int, shrinkage: float
) -> tuple["DualRidge | PrimalRidge", "DualRidge | PrimalRidge"]:
    """Fit the first vectors alone, and all: by one matrix of inner products where these are fewer than inputs."""
    if len(vectors) > vectors.shape[1]:
        return ridge(vectors[:count], indicators[:count], shrinkage), ridge(vectors, indicators, shrinkage)
    form = DualForm.of(vectors, shrinkage)
    return DualRidge(form.of_first(count, shrinkage), indicators[:count]), DualRidge(form, indicators)


class DualForm(NamedTuple):
    """What axes in the span of n vectors are sought from.

    Attributes:
        vectors: (n, inputs).
        mean: (inputs,), of the vectors.
        penalty: of the squared axes.
        products: (n, n), the inner products of the vectors less their mean, with the penalty on their diagonal.
    """

    vectors: NDArray[np.float32]
    mean: NDArray[np.float32]
    penalty: float
    products: NDArray[np.float32]

    @classmethod
    def of(cls, vectors: NDArray[np.float32], shrinkage: float) -> "DualForm":
        """Multiply vectors (n, inputs) less their mean; the penalty is `shrinkage` times their mean squared length."""
        mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
        return cls._penalised(vectors, mean, inner_products(without_mean(vectors, mean)), shrinkage)

    @classmethod
    def _penalised(
        cls, vectors: NDArray[np.float32], mean: NDArray[np.float32], products: NDArray[np.float32], shrinkage: float
    ) -> "DualForm":
        length2 = float(np.trace(products, dtype=np.float64)) / len(products)
        penalty = shrinkage * max(length2, SMALLEST_LENGTH2)
        products.ravel()[:: len(products) + 1] += penalty
        return cls(vectors, mean, penalty, products)

    def of_first(self, count: int, shrinkage: float) -> "DualForm":
        """Return the form of the first so many vectors, about their own mean: their products need not be multiplied."""
        vectors, products = self.vectors[:count], self.products[:count, :count].copy()
        products.ravel()[:: count + 1] -= self.penalty
        shift = products.mean(axis=1, dtype=np.float64)
        products -= (shift - shift.mean() / 2).astype(np.float32)
        products -= (shift - shift.mean() / 2).astype(np.float32)[:, None]
        mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
        return self._penalised(vectors, mean, products, shrinkage)

    def fitted(self, dual: Array, intercept: Array) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the axes (inputs, actions) and offsets (actions,) of weights of the vectors (n, actions)."""
        axes = self.vectors.T @ dual.astype(np.float32)
        axes -= np.outer(self.mean, dual.sum(axis=0)).astype(np.float32)
        return axes, (intercept - self.mean @ axes).astype(np.float32)


class DualRidge:
    """The axes are sought in the span of the vectors, so that one inverse of their inner products serves all folds.

    Of the inverse, only its root W is held: Wᵀ W is the inverse, and any block of it the product of columns of W.
    """

    def __init__(self, form: DualForm, indicators: Array) -> None:
        self._indicators, self._root = indicators, inverse_root(form.products.astype(np.float64))
        intercept: Array = indicators.mean(axis=0)
        self._dual: Array = self._root.T @ (self._root @ (indicators - intercept))
        self.axes, self.offsets = form.fitted(self._dual, intercept)
        self.scores: Array = indicators - form.penalty * self._dual

    def held_out(self, folds: Sequence[Indices]) -> list[Array]:
        """Return the scores (rows, actions) of each of some folds by a regression that was fitted to all other rows.

        By the inverse B of a block matrix, K_hf (K_ff + penalty)⁻¹ = −B_hh⁻¹ B_hf: nothing need be fitted. What a
        fold's rows indicate is left out to the last bit: it is 0 in the fold's own columns of the product for all.
        """
        intercepts, targets = [], []
        for rows in folds:
            others = np.ones((len(self._indicators), 1), dtype=bool)
            others[rows] = False
            mean = self._indicators.mean(axis=0, where=others) if others.any() else np.zeros(len(self.offsets))
            intercepts.append(mean)
            targets.append(np.where(others, self._indicators - mean, 0.0))
        products = np.split(self._root @ np.hstack(targets), len(folds), axis=1)
        return [self._scores(*each) for each in zip(folds, intercepts, products, strict=True)]

    def _scores(self, rows: Indices, intercept: Array, of_others: Array) -> Array:
        first = rows.min(initial=len(self._root))  # above it, these columns of the root are 0
        own = self._root[first:, rows]
        scores: Array = intercept - np.linalg.solve(own.T @ own, own.T @ of_others[first:])
        return scores

    def each_left_out(self, count: int) -> Array:
        """Return the scores of the rows from `count` on, each by a regression that was fitted to all others.

        By the leave-one-out formula of ridge regression. The intercept is that of all rows.
        """
        of_inverse = np.square(self._root[:, count:]).sum(axis=0)
        scores: Array = self._indicators[count:] - self._dual[count:] / of_inverse[:, None]
        return scores


@dataclass(frozen=True, eq=False)
class _Moments:
    """Sums over rows: of products of inputs (inputs, inputs), of inputs with indicators, of both, and how many rows."""

    products: Array
    with_indicators: Array
    inputs: Array
    indicators: Array
    rows: int

    @classmethod
    def of(cls, centred: NDArray[np.float32], indicators: Array) -> "_Moments":
        """Sum up rows (n, inputs) and (n, actions)."""
        products = (centred.T @ centred).astype(np.float64)
        with_indicators = (centred.T @ indicators.astype(np.float32)).astype(np.float64)
        inputs = centred.sum(axis=0, dtype=np.float64)
        return cls(products, with_indicators, inputs, indicators.sum(axis=0), len(centred))

    def without(self, other: "_Moments") -> "_Moments":
        """Subtract the sums over some of the rows."""
        return _Moments(
            self.products - other.products,
            self.with_indicators - other.with_indicators,
            self.inputs - other.inputs,
            self.indicators - other.indicators,
            self.rows - other.rows,
        )

    def solution(self, penalty: float) -> tuple[Array, Array]:
        """Return the axes (inputs, actions) and the intercept (actions,)."""
        intercept = self.indicators / max(self.rows, 1)
        targets = self.with_indicators - np.outer(self.inputs, intercept)
        penalised: Array = self.products + penalty * np.eye(len(self.products))
        return np.linalg.solve(penalised, targets).astype(np.float64), intercept


class PrimalRidge:
    """The axes are sought from the sums of products of inputs: rows left out are subtracted from these."""

    def __init__(self, vectors: NDArray[np.float32], indicators: Array, shrinkage: float) -> None:
        mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
        self._centred, self._indicators = vectors - mean, indicators
        self._moments = _Moments.of(self._centred, indicators)
        length2 = float(np.trace(self._moments.products)) / len(vectors)
        self._penalty = shrinkage * max(length2, SMALLEST_LENGTH2)
        axes, self._intercept = self._moments.solution(self._penalty)
        self.axes: NDArray[np.float32] = axes.astype(np.float32)
        self.offsets: NDArray[np.float32] = (self._intercept - mean @ self.axes).astype(np.float32)

    @cached_property
    def scores(self) -> Array:
        """The scores of all rows, (n, actions)."""
        scores: Array = (self._centred @ self.axes).astype(np.float64) + self._intercept
        return scores

    def held_out(self, folds: Sequence[Indices]) -> list[Array]:
        """Return the scores (rows, actions) of each of some folds by a regression that was fitted to all other rows."""
        return [self._held_out(rows) for rows in folds]

    def _held_out(self, rows: Indices) -> Array:
        centred = self._centred[rows]
        rest = self._moments.without(_Moments.of(centred, self._indicators[rows]))
        axes, intercept = rest.solution(self._penalty)
        scores: Array = centred @ axes + intercept
        return scores

    def each_left_out(self, count: int) -> Array:
        """Return the scores of the rows from `count` on, each by a regression that was fitted to all others.

        By the leave-one-out formula of ridge regression. The intercept is that of all rows.
        """
        centred = self._centred[count:].astype(np.float64)
        inverse = np.linalg.inv(self._moments.products + self._penalty * np.eye(centred.shape[1]))
        leverages = np.einsum("ij,ij->i", centred @ inverse, centred)
        errors = self._indicators[count:] - self.scores[count:]
        scores: Array = self._indicators[count:] - errors / (1 - leverages)[:, None]
        return scores
