"""Matrix products that are the same to the bit for any number of BLAS threads."""

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])

CHUNK_ROWS = 128
"""Rows multiplied at once: few enough that their products still lie in the cache when they are read."""
_INNER = 128
"""Longest inner dimension of one product; longer sums are split into parts of this length, so that tiles stay large."""
_LARGEST = 2**18
"""Multiplications in one product up to which OpenBLAS uses a single thread; several threads round differently."""
_LANES = 16
"""Widths are padded to multiples of this many numbers, which BLAS kernels treat alike."""
_ALIASING_BYTES = 4096
"""Rows that lie a multiple of this apart in memory compete for the same lines of the processor's cache."""


def padded_width(count: int) -> int:
    """Return the smallest multiple of `_LANES` that is no less than `count`."""
    return -(-count // _LANES) * _LANES


def stride(nodes: int, dtype: np.dtype[np.floating]) -> int:
    """Return how far apart rows of `nodes` numbers are stored, so that they do not contend for the same cache lines."""
    padded = padded_width(nodes)
    return padded + _LANES if padded * dtype.itemsize % _ALIASING_BYTES == 0 else padded


def matmul(left: NDArray[np.float64], right: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return left @ right, (n, m) times (m, k)."""
    out = np.empty((left.shape[0], right.shape[1]))
    matmul_into(left, right, out)
    return out


def matmul_into(left: Floats, right: Floats, out: Floats) -> None:
    """Write left @ right to out, (n, m) times (m, k), in tiles that BLAS multiplies on one thread."""
    inner = left.shape[1]
    _tiles(left[:, :_INNER], right[:_INNER], out)
    for start in range(_INNER, inner, _INNER):
        part = np.empty_like(out)
        _tiles(left[:, start : start + _INNER], right[start : start + _INNER], part)
        out += part


def row_matmul(left: Floats, right: Floats) -> Floats:
    """Return left @ right of a single row, (m,) times (m, k)."""
    if right.size <= _LARGEST:
        direct: Floats = left.dot(right)
        return direct
    out: Floats = np.zeros_like(right[0])
    width = _LARGEST // _INNER
    for start in range(0, len(left), _INNER):
        inner = slice(start, start + _INNER)
        for first in range(0, len(out), width):
            out[first : first + width] += left[inner].dot(right[inner, first : first + width])
    return out


def few_rows_matmul(left: Floats, right: Floats) -> Floats:
    """Return left @ right, (n, m) times (m, k) for a few rows n: at once where that is small, else row by row."""
    if len(left) * right.size <= _LARGEST:
        direct: Floats = left.dot(right)
        return direct
    return np.stack([row_matmul(row, right) for row in left])


def _tiles(left: Floats, right: Floats, out: Floats) -> None:
    """Write left @ right to out in tiles of at most `_LARGEST` multiplications each."""
    width = max(_LANES, _LARGEST // (CHUNK_ROWS * left.shape[1]) // _LANES * _LANES)
    for top in range(0, len(left), CHUNK_ROWS):
        rows = slice(top, top + CHUNK_ROWS)
        for start in range(0, right.shape[1], width):
            cols = slice(start, start + width)
            np.matmul(left[rows], right[:, cols], out=out[rows, cols])
