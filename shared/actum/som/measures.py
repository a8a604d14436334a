"""How well a map fits its inputs and keeps their order, from winners, weights and grid."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som.grid import Grid

Array = NDArray[Any]
Indices = NDArray[np.intp]


def partial_distances2(vectors: Array, weights: Array) -> NDArray[np.float64]:
    """Return the squared distance of each vector (…, dim) to its weight (…, dim), shape (…).

    Components missing in the vector (NaN) are left out, and what the others add up to is scaled by dim / known.
    """
    difference = np.subtract(vectors, weights, dtype=np.float64)
    distances2: NDArray[np.float64] = np.einsum("...i,...i->...", difference, difference)
    missing = np.isnan(difference)
    if not missing.any():
        return distances2
    known = difference.shape[-1] - missing.sum(axis=-1)
    partial: NDArray[np.float64] = np.nansum(difference**2, axis=-1) * (difference.shape[-1] / known)
    return partial


def topographic_error(best_two: Indices, grid: Grid, neighbours: int | None = None) -> float:
    """Return the share of the pairs of best units, shape (n, 2), that are no neighbours on the grid."""
    return float((~grid.are_neighbours(best_two[:, 0], best_two[:, 1], neighbours)).mean())


def u_matrix(weights: Array, grid: Grid, neighbours: int | None = None) -> NDArray[np.float64]:
    """Return each unit's mean distance to its neighbours' weights, shape (rows, cols); 0 for a unit without any."""
    first, second = grid.edges(neighbours)
    distances = np.linalg.norm(np.subtract(weights[first], weights[second], dtype=np.float64), axis=1)
    sums = np.bincount(first, weights=distances, minlength=grid.nodes)
    counts = np.maximum(np.bincount(first, minlength=grid.nodes), 1)
    means: NDArray[np.float64] = sums / counts
    return means.reshape(grid.rows, grid.cols)


def hits(winners: Indices, grid: Grid) -> Indices:
    """Return how often each unit is among the winners (n,), shape (rows, cols)."""
    return np.bincount(winners, minlength=grid.nodes).reshape(grid.rows, grid.cols)
