"""Linear initialisation: a map on the plane of the first two principal components of its inputs (Kohonen)."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som.blas import matmul
from actum.som.codebook import unit_coordinates

Doubles = NDArray[np.float64]

_ROUNDS = 100
"""Orthogonal iterations; in each the error falls by the ratio of the seventh variance to the second."""
_DIRECTIONS = 6
"""Directions that are iterated: with more than the two that are needed, these converge faster."""


def linear_weights(vectors: NDArray[Any], rows: int, cols: int) -> Doubles:
    """Return weights on the plane of the first two principal components of vectors (n, dim), shape (nodes, dim).

    The plane spans ± two standard deviations, with the first component along the longer side of the grid. Missing
    values (NaN) are taken as the mean of the others.

    Raises:
        ValueError: a component is missing in every vector: remove or fill it. Or there is no unit.
    """
    if min(rows, cols) < 1:
        raise ValueError(f"a grid of {rows}×{cols} has no units: use at least 1×1")
    known = ~np.isnan(vectors)
    if not known.any(axis=0).all():
        raise ValueError(
            f"component {np.flatnonzero(~known.any(axis=0))[0]} is NaN in every vector: remove this component, or "
            "fill in values"
        )
    mean = np.nanmean(vectors, axis=0, dtype=np.float64)
    axes = principal_axes(np.where(known, vectors - mean, 0.0))
    return mean + 2 * matmul(_scaled(unit_coordinates(rows, cols)), axes if rows >= cols else axes[::-1])


def principal_axes(centred: Doubles) -> Doubles:
    """Return the first two principal components of (n, dim), each as long as its standard deviation. Shape (2, dim).

    The largest component of each is positive. LAPACK's eigenvectors of large matrices change with the number of
    threads, so the matrix is first brought down to a few directions by orthogonal iteration.
    """
    covariance = matmul(centred.T, centred) / len(centred)
    dim = len(covariance)
    basis = np.random.default_rng(0).standard_normal((dim, min(dim, _DIRECTIONS)))
    for _ in range(_ROUNDS):
        basis = np.linalg.qr(matmul(covariance, basis))[0]
    variances, turns = np.linalg.eigh(matmul(basis.T, matmul(covariance, basis)))
    axes = np.zeros((2, dim))
    axes[: len(variances)] = (matmul(basis, turns) * np.sqrt(np.maximum(variances, 0))).T[:-3:-1]
    largest = np.take_along_axis(axes, np.abs(axes).argmax(axis=1)[:, None], axis=1)
    signed: Doubles = axes * np.where(largest < 0, -1.0, 1.0)
    return signed


def _scaled(positions: Doubles) -> Doubles:
    """Scale each coordinate of (nodes, 2) to [−1, 1]; 0 where all are the same."""
    middle = (positions.max(axis=0) + positions.min(axis=0)) / 2
    half = np.ptp(positions, axis=0) / 2
    scaled: Doubles = np.divide(positions - middle, half, out=np.zeros_like(positions), where=half > 0)
    return scaled
