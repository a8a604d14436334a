"""Batch training: every unit moves to the mean of what its neighbourhood won (Kohonen, 2013), by matrix products."""

from dataclasses import replace
from typing import Any, Generic

import numpy as np
from numpy.typing import ArrayLike, NDArray

from actum.som.blas import producted
from actum.som.codebook import Map, training_vectors
from actum.som.grid import Grid
from actum.som.lookup import Lookup
from actum.som.schedule import checked_radii

Doubles = NDArray[np.float64]


class BatchTraining(Generic[Map]):
    """A map while it learns, all inputs at once per epoch: wⱼ = Σₖ Gⱼₖ Sₖ / Σₖ Gⱼₖ Nₖ.

    S and N are the sum and the number of the inputs that unit k won, G = exp(−r² / 2 radius²) with r the distance on
    the grid. Missing components (NaN) count in neither. The same inputs and start make the same map, to the bit.
    """

    def __init__(self, som: Map, vectors: ArrayLike, radii: ArrayLike) -> None:
        """Prepare one epoch per neighbourhood radius (grid units).

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
        """Return per unit the sums of what it won, then the counts, shape (nodes, dim + 1 or 2 dim)."""
        nodes = self._start.grid.nodes
        sums = [np.bincount(winners, weights=column, minlength=nodes) for column in self._summed]
        counts = [np.bincount(winners, weights=column, minlength=nodes) for column in self._counted]
        return np.stack(sums + counts, axis=1)


def _columns(vectors: NDArray[Any]) -> tuple[Doubles, list[Doubles | None]]:
    """Return the columns to add up, zero where missing, and those to count by: one for all where none is missing."""
    columns = np.array(vectors.T, np.float64, order="C")
    missing = np.isnan(columns)
    if not missing.any():
        return columns, [None]
    columns[missing] = 0
    return columns, list((~missing).astype(np.float64))


def _smoothed(sums: Doubles, grid: Grid, radius: float) -> Doubles:
    """Return G sums; on a rectangular grid G is the product of a Gaussian over rows and one over columns."""
    if grid.topology == "hexagonal":
        return producted(_pairwise(grid.positions, radius), sums)
    width = sums.shape[1]
    over_rows = producted(_pairwise(np.arange(grid.rows)[:, None], radius), sums.reshape(grid.rows, -1))
    by_cols = over_rows.reshape(grid.rows, grid.cols, width).swapaxes(0, 1).reshape(grid.cols, -1)
    over_both = producted(_pairwise(np.arange(grid.cols)[:, None], radius), by_cols)
    return over_both.reshape(grid.cols, grid.rows, width).swapaxes(0, 1).reshape(-1, width)


def _pairwise(places: NDArray[Any] | NDArray[np.intp], radius: float) -> Doubles:
    """Return exp(−r² / 2 radius²) between all places, shape (n, n)."""
    distances2 = np.square(places[:, None] - places).sum(axis=2)
    gaussians: Doubles = np.exp(-distances2 / (2 * radius**2))
    return gaussians
