"""Batch training: each unit moves to the mean of the inputs that its neighbourhood won (Kohonen, 2013)."""

from dataclasses import replace
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som.blas import matmul
from actum.som.codebook import Map
from actum.som.inputs import training_vectors
from actum.som.lookup import Lookup
from actum.som.schedule import checked_radii

Doubles = NDArray[np.float64]


class BatchTraining(Generic[Map]):
    """A map while it learns from all inputs at once, epoch by epoch: wⱼ = Σₖ Gⱼₖ Sₖ / Σₖ Gⱼₖ Nₖ (Kohonen, 2013).

    Sₖ and Nₖ are the sum and the number of the inputs that unit k won, G = exp(−r² / 2 radius²) with r the distance on
    the grid. Missing components (NaN) count in neither. The same inputs and start make the same map, to the bit.

    >>> from actum.som import Som
    >>> vectors = np.random.default_rng(0).random((100, 2))
    >>> training = BatchTraining(Som.linear(4, 4, vectors), vectors, radii=[2.0, 1.0, 0.5])
    >>> for _ in range(3):
    ...     training.run_epoch()
    >>> training.som.quantization_error(vectors) < 0.2
    True
    """

    def __init__(self, som: Map, vectors: ArrayLike, radii: ArrayLike) -> None:
        """Prepare one epoch per neighbourhood radius.

        Args:
            som: the map to start from, left as it is.
            vectors: the inputs, (n, dim).
            radii: (epochs,), in grid units.

        Raises:
            ValueError: the vectors do not fit the map, or a radius is not above 0.
        """
        self._epochs_done = 0
        self._start = som
        self._weights = np.array(som.weights)
        self._radii = checked_radii(radii)
        self._vectors = training_vectors(vectors, som.dim, som.dtype)
        self._summed, self._counted = _columns(self._vectors)

    @property
    def som(self) -> Map:
        """The map as it is now."""
        return replace(self._start, weights=self._weights)

    def run_epoch(self) -> None:
        """Show the map all vectors once.

        Raises:
            IndexError: all epochs are done.
        """
        radius = self._radii[self._epochs_done]
        winners = Lookup(self._weights).winners(self._vectors)
        smoothed = _smoothed(self._sums(winners), self._start.rows, self._start.cols, radius)
        sums, counts = smoothed[:, : self._start.dim], smoothed[:, self._start.dim :]
        reached = np.broadcast_to(counts > np.finfo(np.float64).tiny, sums.shape)
        means = np.divide(sums, counts, out=self._weights.astype(np.float64), where=reached)
        self._weights = means.astype(self._start.dtype)
        self._epochs_done += 1

    def _sums(self, winners: NDArray[np.intp]) -> Doubles:
        """Return per unit the sums of the inputs that it won, then the counts, shape (nodes, dim + 1 or 2 dim)."""
        nodes = len(self._weights)
        sums = [np.bincount(winners, weights=column, minlength=nodes) for column in self._summed]
        counts = [np.bincount(winners, weights=column, minlength=nodes) for column in self._counted]
        return np.stack(sums + counts, axis=1)


def _columns(vectors: NDArray[Any]) -> tuple[Doubles, list[Doubles | None]]:
    """Return the transposed vectors (dim, n), 0 where missing, and weights (n,) that count known values.

    There is one array of weights per component, or a single None, which counts all, where nothing is missing.
    """
    columns = np.array(vectors.T, np.float64, order="C")
    missing = np.isnan(columns)
    if not missing.any():
        return columns, [None]
    columns[missing] = 0
    return columns, list((~missing).astype(np.float64))


def _smoothed(sums: Doubles, rows: int, cols: int, radius: float) -> Doubles:
    """Return Σₖ Gⱼₖ sumsₖ, (nodes, width): G is a Gaussian over rows times one over columns."""
    over_rows = matmul(_gaussians(rows, radius), sums.reshape(rows, -1))
    by_cols = over_rows.reshape(rows, cols, -1).swapaxes(0, 1).reshape(cols, -1)
    over_both = matmul(_gaussians(cols, radius), by_cols)
    return over_both.reshape(cols, rows, -1).swapaxes(0, 1).reshape(sums.shape)


def _gaussians(count: int, radius: float) -> Doubles:
    """Return exp(−r² / 2 radius²), r the distance between two of `count` units in a line; shape (count, count)."""
    places = np.arange(count)
    gaussians: Doubles = np.exp(-np.square(places[:, None] - places) / (2 * radius**2))
    return gaussians
