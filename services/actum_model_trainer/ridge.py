"""Ridge regression of indicators on vectors, and the scores that it gives to rows left out, without fitting it anew.

Scores = vectors · axes + offsets minimise the squared error + penalty × ‖axes‖². There are two forms, which give the
same up to rounding: the dual one for fewer vectors than inputs, the primal one for more. Neither centres the vectors
anew where rows are left out.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices
from actum_model_trainer.products import bordered, inverse_of, symmetric_product

SMALLEST_LENGTH2 = 1e-9
"""Squared length of vectors: the penalty must not be 0 where all are the same."""


class Ridge(Protocol):
    """A fitted regression of indicators (n, actions) on vectors (n, inputs)."""

    @property
    def axes(self) -> NDArray[np.float32]:
        """The axes, (inputs, actions)."""
        ...

    @property
    def offsets(self) -> NDArray[np.float32]:
        """The offsets, (actions,)."""
        ...

    @property
    def scores(self) -> Array:
        """The scores of all rows, (n, actions)."""
        ...

    def without(self, rows: Indices) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return axes (inputs, actions) and offsets (actions,) of a regression that was fitted to all other rows."""
        ...

    def held_out(self, rows: Indices) -> Array:
        """Return the scores (rows, actions) by a regression that was fitted to all other rows."""
        ...

    def each_left_out(self, count: int) -> Array:
        """Return the scores of the rows from `count` on, each by a regression that was fitted to all others."""
        ...


def ridge(vectors: NDArray[np.float32], indicators: Array, shrinkage: float) -> Ridge:
    """Fit in the form that costs less.

    Args:
        vectors: (n, inputs).
        indicators: (n, actions).
        shrinkage: the penalty, in units of the mean squared length of the centred vectors.
    """
    form = DualRidge.of if len(vectors) <= vectors.shape[1] else PrimalRidge
    return form(vectors, indicators, shrinkage)


@dataclass(frozen=True, eq=False)
class DualRidge:
    """The axes are sought in the span of the vectors, so that one inverse of their inner products serves all folds.

    Attributes:
        mean: (inputs,), of the vectors.
        centred: (n, inputs), the vectors less their mean.
        indicators: (n, actions).
        penalty: of the squared axes.
        inverse: of the penalised inner products, (n, n).
    """

    mean: NDArray[np.float32]
    centred: NDArray[np.float32]
    indicators: Array
    penalty: float
    inverse: Array

    @classmethod
    def of(cls, vectors: NDArray[np.float32], indicators: Array, shrinkage: float) -> "DualRidge":
        """Fit, as `ridge` does.

        The inner products are inverted in double precision: in single, inverses by blocks of thousands of rows diverge.
        """
        mean = vectors.mean(axis=0, dtype=np.float64).astype(np.float32)
        centred = vectors - mean
        products = symmetric_product(centred, centred.T)
        penalty = shrinkage * max(float(np.trace(products)) / len(products), SMALLEST_LENGTH2)
        return cls(mean, centred, indicators, penalty, inverse_of(_penalised(products, penalty)))

    def and_also(self, vectors: NDArray[np.float32], indicators: Array) -> "DualRidge":
        """Return the regression on these and more rows, with the same penalty, about the same mean of the vectors."""
        centred = vectors - self.mean
        beside, last = ((each @ centred.T).astype(np.float64) for each in (self.centred, centred))
        return replace(
            self,
            centred=np.concatenate([self.centred, centred]),
            indicators=np.concatenate([self.indicators, indicators]),
            inverse=bordered(self.inverse, beside, _penalised(last, self.penalty)),
        )

    @property
    def axes(self) -> NDArray[np.float32]:
        """The axes, (inputs, actions)."""
        return self.fitted[0]

    @property
    def offsets(self) -> NDArray[np.float32]:
        """The offsets, (actions,)."""
        return self.fitted[1]

    @cached_property
    def fitted(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """The axes (inputs, actions) and offsets (actions,)."""
        return self._of(self._dual, self.indicators.mean(axis=0))

    @property
    def scores(self) -> Array:
        """The scores of all rows, (n, actions): what is to be answered less the penalty times the weights of rows."""
        scores: Array = self.indicators - self.penalty * self._dual
        return scores

    def without(self, rows: Indices) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return axes (inputs, actions) and offsets (actions,) of a regression that was fitted to all other rows."""
        targets, intercept = self._targets_without(rows)
        dual = self.inverse @ targets
        dual -= self.inverse[:, rows] @ np.linalg.solve(self.inverse[np.ix_(rows, rows)], dual[rows])
        return self._of(dual, intercept)

    def held_out(self, rows: Indices) -> Array:
        """Return the scores (rows, actions) by a regression that was fitted to all other rows.

        By the inverse B of a block matrix, K_hf (K_ff + penalty)⁻¹ = −B_hh⁻¹ B_hf: nothing need be fitted.
        """
        targets, intercept = self._targets_without(rows)
        own = self.inverse[rows]
        scores: Array = intercept - np.linalg.solve(own[:, rows], own @ targets)
        return scores

    def each_left_out(self, count: int) -> Array:
        """Return the scores of the rows from `count` on, each by a regression that was fitted to all others.

        By the leave-one-out formula of ridge regression. The intercept is that of all rows.
        """
        scores: Array = self.indicators[count:] - self._dual[count:] / np.diag(self.inverse)[count:, None]
        return scores

    @cached_property
    def _dual(self) -> Array:
        """The weights of the rows, of which the axes consist, (n, actions)."""
        dual: Array = self.inverse @ (self.indicators - self.indicators.mean(axis=0))
        return dual

    def _targets_without(self, rows: Indices) -> tuple[Array, Array]:
        """Return the indicators less their mean over all other rows, 0 for these rows, (n, actions), and that mean."""
        targets = self.indicators.copy()
        targets[rows] = 0
        others = np.ones(len(targets), dtype=bool)
        others[rows] = False
        intercept: Array = targets.sum(axis=0) / max(np.count_nonzero(others), 1)
        targets[others] -= intercept
        return targets, intercept

    def _of(self, dual: Array, intercept: Array) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return the axes (inputs, actions) and offsets (actions,) of weights of the vectors (n, actions)."""
        axes: NDArray[np.float32] = self.centred.T @ dual.astype(np.float32)
        return axes, (intercept - self.mean @ axes).astype(np.float32)


def _penalised(products: Array, penalty: float) -> Array:
    """Add the penalty to the diagonal of inner products (n, n), in place."""
    products.ravel()[:: len(products) + 1] += penalty
    return products


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
        self._mean = mean
        axes, self._intercept = self._moments.solution(self._penalty)
        self.axes, self.offsets = self._of(axes, self._intercept)

    @cached_property
    def scores(self) -> Array:
        """The scores of all rows, (n, actions)."""
        scores: Array = (self._centred @ self.axes).astype(np.float64) + self._intercept
        return scores

    def without(self, rows: Indices) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return axes (inputs, actions) and offsets (actions,) of a regression that was fitted to all other rows."""
        return self._of(*self._solution_without(rows))

    def held_out(self, rows: Indices) -> Array:
        """Return the scores (rows, actions) by a regression that was fitted to all other rows."""
        axes, intercept = self._solution_without(rows)
        scores: Array = self._centred[rows] @ axes + intercept
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

    def _solution_without(self, rows: Indices) -> tuple[Array, Array]:
        rest = self._moments.without(_Moments.of(self._centred[rows], self._indicators[rows]))
        return rest.solution(self._penalty)

    def _of(self, axes: Array, intercept: Array) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return axes (inputs, actions) and the offsets (actions,) with which they apply to vectors not centred."""
        rounded = axes.astype(np.float32)
        return rounded, (intercept - self._mean @ rounded).astype(np.float32)
