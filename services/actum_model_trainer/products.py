"""Inner products of many vectors, and systems of equations with their matrix, in as few operations as rounding allows.

Matrices are factored by `numpy.linalg.cholesky`. An inverse by blocks would cost as little, but each level of blocks
multiplies its errors by about the square of the condition: of 5,000 windows, nothing of the inverse was right.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Floats
from actum_model_trainer.side_by_side import side_by_side

SMALLEST_HALVED = 1000
"""Vectors whose inner products are computed by halves, side by side: those of fewer take less than threads cost."""
LARGEST_AT_ONCE = 128
"""Rows of a triangular matrix that NumPy solves or inverts at once, as if it were any matrix; it has no other way."""


def inner_products(vectors: NDArray[np.float32]) -> Array:
    """Return the inner products (n, n) of vectors (n, inputs), the same however many threads there are."""
    count = len(vectors)
    if count < SMALLEST_HALVED:
        return (vectors @ vectors.T).astype(np.float64)
    first, second = slice(0, count // 2), slice(count // 2, count)
    products = np.empty((count, count))

    def compute(blocks: Sequence[tuple[slice, slice]]) -> None:
        for rows, columns in blocks:
            products[rows, columns] = vectors[rows] @ vectors[columns].T

    side_by_side(compute, [[(first, second)], [(first, first), (second, second)]])
    products[second, first] = products[first, second].T
    return products


def solution(matrix: Array, targets: Array) -> Array:
    """Return the solution (n, m) of matrix @ solution = targets, with a symmetric positive definite matrix (n, n)."""
    root = np.linalg.cholesky(matrix)
    solved, blocks = np.array(targets, dtype=np.float64), range(0, len(root), LARGEST_AT_ONCE)
    for start in blocks:
        own = slice(start, start + LARGEST_AT_ONCE)
        solved[own] = np.linalg.solve(root[own, own], solved[own] - root[own, :start] @ solved[:start])
    for start in reversed(blocks):
        own, after = slice(start, start + LARGEST_AT_ONCE), start + LARGEST_AT_ONCE
        solved[own] = np.linalg.solve(root[own, own].T, solved[own] - root[after:, own].T @ solved[after:])
    return solved


def inverse_root(matrix: Array) -> Array:
    """Return the lower triangle W (n, n) with Wᵀ W = the inverse of a symmetric positive definite matrix (n, n)."""
    return _inverse_of_triangle(np.linalg.cholesky(matrix))


def _inverse_of_triangle(lower: Floats) -> Array:
    if len(lower) <= LARGEST_AT_ONCE:
        return np.linalg.inv(lower).astype(np.float64)
    half = len(lower) // 2
    inverse = np.zeros(lower.shape)
    inverse[:half, :half] = _inverse_of_triangle(lower[:half, :half])
    inverse[half:, half:] = _inverse_of_triangle(lower[half:, half:])
    inverse[half:, :half] = inverse[half:, half:] @ (lower[half:, :half] @ -inverse[:half, :half])
    return inverse
