"""Typical squared distances, in units of which contrasts are set."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import Som

Array = NDArray[np.float64]
Floats = NDArray[Any]
NEIGHBOUR_CHUNK = 64


def typical_error2(som: Som, vectors: Floats) -> float:
    """Return the median squared distance of the rows to their winners."""
    differences = vectors - som.weights[som.bmus(vectors)]
    known = ~np.isnan(differences)
    distances2 = np.square(np.where(known, differences, 0)).sum(axis=1) * som.dim / known.sum(axis=1)
    return float(np.median(distances2)) or 1e-6


def typical_distance2(vectors: Array) -> float:
    """Return the median squared distance of each row (n, dim) to its nearest other row; 1 where that is 0.

    The rows are grid coordinates, so 1 is the smallest distance there is between two neurons.
    """
    nearest = [_nearest_distance2(vectors, start) for start in range(0, len(vectors), NEIGHBOUR_CHUNK)]
    return float(np.median(np.concatenate(nearest))) or 1.0


def _nearest_distance2(vectors: Array, start: int) -> Array:
    chunk = vectors[start : start + NEIGHBOUR_CHUNK]
    distances2 = np.square(chunk[:, None] - vectors).sum(axis=2)
    distances2[np.arange(len(chunk)), np.arange(start, start + len(chunk))] = np.inf
    nearest: Array = distances2.min(axis=1)
    return nearest
