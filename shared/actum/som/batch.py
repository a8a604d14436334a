"""Batch training: each unit moves to the mean of the inputs that its neighbourhood won (Kohonen, 2013)."""

from dataclasses import replace
from functools import reduce
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som.blas import matmul
from actum.som.codebook import Map
from actum.som.grid import Grid
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
    >>> while training.epochs_done < training.epochs:
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
        self.epochs_done = 0
        self._start = som
        self._weights = np.array(som.weights)
        self._radii = checked_radii(radii)
        self._vectors = training_vectors(vectors, som.dim, som.dtype)
        self._summed, self._counted = _columns(self._vectors)

    @property
    def epochs(self) -> int:
        """How many epochs there are in all."""
        return len(self._radii)

    @property
    def som(self) -> Map:
        """The map as it is now."""
        return replace(self._start, weights=self._weights)

    def run_epoch(self) -> None:
        """Show the map all vectors once.

        Raises:
            IndexError: all epochs are done.
        """
        radius = self._radii[self.epochs_done]
        winners = Lookup(self._weights).winners(self._vectors)
        smoothed = _smoothed(self._sums(winners), self._start.grid, radius)
        sums, counts = smoothed[:, : self._start.dim], smoothed[:, self._start.dim :]
        reached = np.broadcast_to(counts > np.finfo(np.float64).tiny, sums.shape)
        means = np.divide(sums, counts, out=self._weights.astype(np.float64), where=reached)
        self._weights = means.astype(self._start.dtype)
        self.epochs_done += 1

    def _sums(self, winners: NDArray[np.intp]) -> Doubles:
        """Return per unit the sums of the inputs that it won, then the counts, shape (nodes, dim + 1 or 2 dim)."""
        nodes = self._start.grid.nodes
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


def _smoothed(sums: Doubles, grid: Grid, radius: float) -> Doubles:
    """Return Σₖ Gⱼₖ sumsₖ, in the shape of the sums, (nodes, width).

    Between rows that are shifted alike G is separable, a Gaussian over rows times one over columns.
    """
    by_row = sums.reshape(grid.rows, grid.cols, -1)
    smoothed = np.empty_like(by_row)
    shifts = np.unique(grid.shifts)
    for shift in shifts:
        smoothed[grid.shifts == shift] = reduce(
            np.add, (_spread(by_row, grid, radius, shift, start) for start in shifts)
        )
    return smoothed.reshape(sums.shape)


def _spread(by_row: Doubles, grid: Grid, radius: float, shift: int, start: int) -> Doubles:
    """Return the part of the smoothed rows of shift `shift` that comes from rows of shift `start`.

    Args:
        by_row: the sums, (rows, cols, width).
        grid: of the map.
        radius: of the neighbourhood, grid units.
        shift: of the smoothed rows, in substeps.
        start: of the rows whose sums are taken, in substeps.

    Returns:
        (rows of shift `shift`, cols, width).
    """
    to, origin = np.flatnonzero(grid.shifts == shift), np.flatnonzero(grid.shifts == start)
    cols, width = np.arange(grid.cols), by_row.shape[2]
    over_rows = matmul(
        _gaussians(to * grid.row_spacing, origin * grid.row_spacing, radius), by_row[origin].reshape(len(origin), -1)
    )
    by_cols = over_rows.reshape(len(to), grid.cols, width).swapaxes(0, 1).reshape(grid.cols, -1)
    over_both = matmul(_gaussians(cols + shift / grid.substeps, cols + start / grid.substeps, radius), by_cols)
    spread: Doubles = over_both.reshape(grid.cols, len(to), width).swapaxes(0, 1)
    return spread


def _gaussians(positions: NDArray[Any], others: NDArray[Any], radius: float) -> Doubles:
    """Return exp(−r² / 2 radius²), r the distance between positions on a line, (n,) and (m,); shape (n, m)."""
    gaussians: Doubles = np.exp(-np.square(positions[:, None] - others) / (2 * radius**2))
    return gaussians
