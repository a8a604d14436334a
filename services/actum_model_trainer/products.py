"""Inner products of many vectors, and systems of equations with their matrix, in as few operations as rounding allows.

An inverse by blocks would cost as little as the factors here, but each level of blocks multiplies its errors by about
the square of the condition: of 5,000 windows, nothing of the inverse was right.
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


def inner_products(vectors: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the inner products (n, n) of vectors (n, inputs), the same however many threads there are."""
    count = len(vectors)
    if count < SMALLEST_HALVED:
        return vectors @ vectors.T
    first, second = slice(0, count // 2), slice(count // 2, count)
    products = np.empty((count, count), np.float32)

    def compute(pairs: Sequence[tuple[slice, slice]]) -> None:
        for rows, columns in pairs:
            products[rows, columns] = vectors[rows] @ vectors[columns].T

    side_by_side(compute, [[(first, second)], [(first, first), (second, second)]])
    products[second, first] = products[first, second].T
    return products


def without_mean(vectors: NDArray[np.float32], mean: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return vectors (n, inputs) less their mean (inputs,)."""
    result = np.empty_like(vectors)
    side_by_side(lambda rows: np.subtract(vectors[rows], mean, out=result[rows]), blocks(len(vectors), SMALLEST_HALVED))
    return result


def solution(matrix: NDArray[np.float32], targets: Array) -> Array:
    """Return the solution (n, m) of matrix @ solution = targets, with a symmetric positive definite matrix (n, n).

    Its factors in single precision solve the system to a few digits, and once more what that misses. That suffices for
    inner products with a penalty: their condition is at most the number of vectors by the shrinkage.

    Raises:
        numpy.linalg.LinAlgError: rounding makes the matrix indefinite.
    """
    root = _Root(matrix)
    solved = root.solution(targets)
    missed = np.array(targets, dtype=np.float64)
    for rows in blocks(len(matrix), LARGEST_AT_ONCE):
        missed[rows] -= matrix[rows].astype(np.float64) @ solved
    return solved + root.solution(missed)


class _Root:
    """The triangle L of L Lᵀ = a symmetric positive definite matrix (n, n), in single precision.

    Nearly all of the work are products, which take half as long as in double precision. NumPy's own takes as long.
    """

    def __init__(self, matrix: NDArray[np.float32]) -> None:
        self._lower, self._blocks = matrix.copy(), blocks(len(matrix), LARGEST_AT_ONCE)
        self._inverses = [self._factored(own) for own in self._blocks]

    def _factored(self, own: slice) -> NDArray[np.float32]:
        """Write the columns of a block, whose earlier ones are written; return the inverse of its triangle."""
        lower, columns = self._lower, self._lower[own.start :, own]
        columns -= lower[own.start :, : own.start] @ lower[own, : own.start].T
        inverse = np.linalg.inv(np.linalg.cholesky(lower[own, own].astype(np.float64))).astype(np.float32)
        lower[own.stop :, own] = lower[own.stop :, own] @ inverse.T
        return inverse

    def solution(self, targets: Array) -> Array:
        """Return the solution (n, m) of L Lᵀ solution = targets."""
        solved = targets.astype(np.float32)
        for own, inverse in zip(self._blocks, self._inverses, strict=True):
            solved[own] = inverse @ (solved[own] - self._lower[own, : own.start] @ solved[: own.start])
        for own, inverse in zip(reversed(self._blocks), reversed(self._inverses), strict=True):
            solved[own] = inverse.T @ (solved[own] - self._lower[own.stop :, own].T @ solved[own.stop :])
        return solved.astype(np.float64)


def blocks(count: int, width: int) -> list[slice]:
    """Return slices of so many rows each, the last perhaps of fewer, that together hold all rows."""
    return [slice(start, min(start + width, count)) for start in range(0, count, width)]


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
