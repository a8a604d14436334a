"""A run of sequential adaptations: in NumPy, and the same to the bit compiled by Numba where that is installed."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Kernel = Callable[[Array, Array, Array, Array, NDArray[np.intp], int], None]
"""Adapts weights, kept as (dim, stride), to inputs (steps, dim), one after the other: w += α G (x − w).

It further takes α times the Gaussian over rows (steps, rows), the Gaussian over columns (steps, substeps * cols), each
row's shift in substeps (rows,) and the substeps of a column. Missing components (NaN) are left out and left alone.
"""


@cache
def fastest() -> Kernel:
    """Return the compiled kernel where Numba can be imported, else the one in NumPy."""
    try:
        from actum.som.compiled import compiled_kernel

        return compiled_kernel()
    except ImportError:
        return adapt_in_numpy


def adapt_in_numpy(
    weights: Array, inputs: Array, over_rows: Array, over_cols: Array, shifts: NDArray[np.intp], substeps: int
) -> None:
    """Adapt the weights; see `Kernel`."""
    learner = _Learner(weights, shifts, substeps, over_cols.shape[1] // substeps)
    for x, row_gauss, col_gauss in zip(inputs, over_rows, over_cols, strict=True):
        learner.adapt(x, row_gauss, col_gauss)


class _Learner:
    """Weights of shape (dim, stride) and the space that a step needs; every operation runs along memory."""

    def __init__(self, weights: Array, shifts: NDArray[np.intp], substeps: int, cols: int) -> None:
        self._weights = weights
        self._difference = np.empty_like(weights)
        self._square = np.empty_like(weights)
        self._neighbourhood = np.zeros_like(weights[0])
        self._nodes = len(shifts) * cols
        self._rows = np.arange(len(shifts))
        self._shifts = shifts
        self._substeps = substeps
        self._cols = cols
        self._places = substeps * np.arange(cols) + (shifts[:, None] if shifts.any() else shifts[:1, None])

    def adapt(self, x: Array, row_gauss: Array, col_gauss: Array) -> None:
        known = ~np.isnan(x)
        if not known.all():
            self._adapt_known(x, known, row_gauss, col_gauss)
            return
        np.subtract(x[:, None], self._weights, out=self._difference)
        np.multiply(self._difference, self._difference, out=self._square)
        self._centre_on(self._winner(self._square), row_gauss, col_gauss)
        self._difference *= self._neighbourhood
        self._weights += self._difference

    def _adapt_known(self, x: Array, known: NDArray[np.bool_], row_gauss: Array, col_gauss: Array) -> None:
        difference = x[known, None] - self._weights[known]
        self._centre_on(self._winner(difference * difference), row_gauss, col_gauss)
        self._weights[known] += difference * self._neighbourhood

    def _winner(self, squares: Array) -> int:
        """Return the first unit of the least sum; NumPy adds rows one after the other, as the compiled kernel does."""
        return int(np.add.reduce(squares, axis=0)[: self._nodes].argmin())

    def _centre_on(self, winner: int, row_gauss: Array, col_gauss: Array) -> None:
        """Set α G of every unit: the product of a Gaussian over rows and one over columns."""
        row, col = divmod(winner, self._cols)
        across = row_gauss[np.abs(self._rows - row)]
        along = col_gauss[np.abs(self._places - (self._substeps * col + self._shifts[row]))]
        np.multiply(across[:, None], along, out=self._neighbourhood[: self._nodes].reshape(len(across), -1))
