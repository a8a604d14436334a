"""Median squared distances on a map, in units of which a preset gives the contrasts of soft activities."""

import numpy as np

from actum.arrays import Array, Floats
from actum.som import Som

CHUNK_ROWS = 64  # rows whose distances to all others are worked out at once, to bound the memory
SMALLEST_ERROR2 = 1e-6  # squared units of the vectors: a contrast divides by it and must not be 0
GRID_STEP2 = 1.0  # squared grid steps: the smallest distance there is between two neurons


def median_quantization_error2(som: Som, vectors: Floats) -> float:
    """Return the median squared distance of vectors (n, dim) to their winners; missing components (NaN) scaled up."""
    differences = vectors - som.weights[som.bmus(vectors)]
    known = ~np.isnan(differences)
    distances2 = np.square(np.where(known, differences, 0)).sum(axis=1) * som.dim / known.sum(axis=1)
    return float(np.median(distances2)) or SMALLEST_ERROR2


def median_neighbour_distance2(vectors: Array) -> float:
    """Return the median squared distance of each row (n, dim) of grid coordinates to its nearest other row.

    Where that is 0, it is one grid step.
    """
    nearest = []
    for start in range(0, len(vectors), CHUNK_ROWS):
        chunk = vectors[start : start + CHUNK_ROWS]
        distances2 = np.square(chunk[:, None] - vectors).sum(axis=2)
        distances2[np.arange(len(chunk)), np.arange(start, start + len(chunk))] = np.inf
        nearest.append(distances2.min(axis=1))
    return float(np.median(np.concatenate(nearest))) or GRID_STEP2
