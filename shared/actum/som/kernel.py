"""The kernels of sequential training, in NumPy and compiled: equal to the bit."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.core import steps

Array = NDArray[Any]
Kernel = Callable[[Array, Array, Array, Array], None]
"""Takes sequential steps in place: what `adapt_in_numpy` does, with the same arguments."""


def adapt_in_numpy(weights: Array, inputs: Array, over_rows: Array, over_cols: Array) -> None:
    """Adapt the weights in place to one input after the other: w += α G (x − w), G centred on the winner of x.

    G of a unit is a Gaussian of its distance from the winner along rows, times one along columns. Missing components
    (NaN) of an input are left out of its distances, and adapt nothing. It is what `SequentialTraining` falls back on
    without a compiled kernel, and may be given to it as its kernel:

    >>> from actum.som import Schedule, SequentialTraining, Som
    >>> schedule, inputs = Schedule(alpha=(0.5, 0.1), radius=(1.0, 0.5)), [[0.0], [1.0]]
    >>> training = SequentialTraining(Som(1, 2, [[0.2], [0.6]]), inputs, [0, 1, 0, 1], schedule, adapt_in_numpy)
    >>> training.run(4)
    >>> training.som.weights.round(2).tolist()
    [[0.19], [0.6]]

    Args:
        weights: (dim, stride), float32 or float64: unit k is column k, further columns are ignored.
        inputs: (steps, dim), in the weights' precision.
        over_rows: (steps, rows), α times the Gaussian for units 0, 1, … rows apart.
        over_cols: (steps, cols), the Gaussian for units 0, 1, … columns apart.
    """
    learner = _Learner(weights, over_rows.shape[1], over_cols.shape[1])
    for x, row_gauss, col_gauss in zip(inputs, over_rows, over_cols, strict=True):
        learner.adapt(x, row_gauss, col_gauss)


def adapt_compiled(weights: Array, inputs: Array, over_rows: Array, over_cols: Array) -> None:
    """Adapt the weights in place as `adapt_in_numpy` does, by a compiled step, many times as fast."""
    assert steps is not None
    steps.learned(weights, inputs, over_rows, over_cols, len(inputs), weights.itemsize)


class _Learner:
    """Weights of shape (dim, stride) and the space that a step needs; every operation runs along memory."""

    def __init__(self, weights: Array, rows: int, cols: int) -> None:
        self._weights = weights
        self._difference = np.empty_like(weights)
        self._square = np.empty_like(weights)
        self._neighbourhood = np.zeros_like(weights[0])
        self._nodes = rows * cols
        self._rows, self._cols = np.arange(rows), np.arange(cols)

    def adapt(self, x: Array, row_gauss: Array, col_gauss: Array) -> None:
        """Take one step: find the winner of x (dim,), and move the weights towards x."""
        known = ~np.isnan(x)
        if not known.all():
            difference = x[known, None] - self._weights[known]
            self._centre_on(self._winner(difference * difference), row_gauss, col_gauss)
            self._weights[known] += difference * self._neighbourhood
            return
        np.subtract(x[:, None], self._weights, out=self._difference)
        np.multiply(self._difference, self._difference, out=self._square)
        self._centre_on(self._winner(self._square), row_gauss, col_gauss)
        self._difference *= self._neighbourhood
        self._weights += self._difference

    def _winner(self, squares: Array) -> int:
        """Return the first unit of the least sum; NumPy adds rows one after the other, as the compiled kernel does."""
        return int(np.add.reduce(squares, axis=0)[: self._nodes].argmin())

    def _centre_on(self, winner: int, row_gauss: Array, col_gauss: Array) -> None:
        """Set α G of every unit: the product of a Gaussian over rows and one over columns."""
        row, col = divmod(winner, len(self._cols))
        across = row_gauss[np.abs(self._rows - row)]
        along = col_gauss[np.abs(self._cols - col)]
        np.multiply(across[:, None], along, out=self._neighbourhood[: self._nodes].reshape(len(across), -1))
