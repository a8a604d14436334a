"""Products and inverses of large matrices, of which parts are computed side by side.

The parts are the same however many threads there are, and so are the results.
"""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array, Floats
from actum_model_trainer.side_by_side import side_by_side

LARGEST_AT_ONCE = 192
"""Rows of a matrix that is inverted at once; larger ones are inverted by blocks, mostly by products."""
SMALLEST_HALVED = 1000
"""Rows of a product from which its halves are computed side by side: smaller ones take less than threads cost."""


def symmetric_product(left: Floats, right: Floats) -> Array:
    """Return left @ right, (n, m) times (m, n), where it is symmetric: of its blocks beside the diagonal one each."""
    count = len(left)
    if count < SMALLEST_HALVED:
        return (left @ right).astype(np.float64, copy=False)
    first, second = slice(0, count // 2), slice(count // 2, count)
    result = np.empty((count, count))

    def compute(blocks: Sequence[tuple[slice, slice]]) -> None:
        for rows, columns in blocks:
            result[rows, columns] = left[rows] @ right[:, columns]

    side_by_side(compute, [[(first, second)], [(first, first), (second, second)]])
    result[second, first] = result[first, second].T
    return result


def product(left: Array, right: Array) -> Array:
    """Return left @ right, (n, m) times (m, k)."""
    if len(left) < SMALLEST_HALVED:
        return left @ right
    result = np.empty((len(left), right.shape[1]))

    def compute(rows: slice) -> None:
        np.matmul(left[rows], right, out=result[rows])

    side_by_side(compute, [slice(0, len(left) // 2), slice(len(left) // 2, len(left))])
    return result


def inverse_of(matrix: Array) -> Array:
    """Return the inverse of a symmetric positive definite matrix (n, n).

    By blocks, it is mostly products of matrices, which take less than half as long as `np.linalg.inv`.
    """
    if len(matrix) <= LARGEST_AT_ONCE:
        return np.linalg.inv(matrix).astype(np.float64)
    half = len(matrix) // 2
    return bordered(inverse_of(matrix[:half, :half]), matrix[:half, half:], matrix[half:, half:])


def bordered(first: Array, beside: Array, last: Array) -> Array:
    """Return the inverse of a symmetric matrix of blocks, (n + m, n + m).

    Args:
        first: the inverse of its first block, (n, n).
        beside: the block beside that one, (n, m).
        last: the last block, (m, m).
    """
    count, by_first = len(first), product(first, beside)
    rest = inverse_of(last - symmetric_product(beside.T, by_first))
    corner, inverse = product(by_first, rest), np.empty((count + len(last),) * 2)
    np.add(first, symmetric_product(corner, by_first.T), out=inverse[:count, :count])
    np.negative(corner, out=inverse[:count, count:])
    inverse[count:, :count], inverse[count:, count:] = inverse[:count, count:].T, rest
    return inverse
