"""Several maps of the same number of units, looked up by one matrix product instead of one each."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import blas
from actum.som.codebook import Codebook

Array = NDArray[Any]


class Together:
    """Maps with equal numbers of units, their weights laid out as the diagonal blocks of one matrix.

    One product instead of several saves time where inputs come one by one. The result is that of each map's
    `Codebook.excess2s`, up to rounding.

    >>> maps = [Codebook(1, 2, [[0.0], [3.0]]), Codebook(1, 2, [[0.0, 0.0], [1.0, 1.0]])]
    >>> Together(maps).excess2s(np.array([[1.0, 1.0, 0.0]])).round(6).tolist()
    [[[0.0, 3.0], [0.0, 0.0]]]
    """

    def __init__(self, maps: Sequence[Codebook]) -> None:
        """Lay out the weights.

        Raises:
            ValueError: the maps differ in their number of units or their precision.
        """
        if len({(len(som.weights), som.dtype) for som in maps}) != 1:
            raise ValueError(
                "the maps differ in their number of units or data type "
                f"({[(len(som.weights), str(som.dtype)) for som in maps]}): give maps with the same number of units "
                "and the same data type"
            )
        self._shape = (-1, len(maps), len(maps[0].weights))
        self._dtype = maps[0].dtype
        lookups = [som.lookup for som in maps]
        self.centre = np.concatenate([lookup.centre for lookup in lookups])
        self.half_norms2 = np.concatenate([lookup.half_norms2 for lookup in lookups])
        self._slopes = _blocks([lookup.slopes for lookup in lookups])

    def excess2s(self, rows: Array) -> Array:
        """Return d² − d²_min of each unit of each map, shape (n, maps, units), in the maps' precision.

        Args:
            rows: (n, sum of the maps' dims), the inputs of all maps one after the other. None may be missing (NaN):
                it would spread to all maps.
        """
        scores = self.products((rows - self.centre).astype(self._dtype, copy=False))
        scores += self.half_norms2
        excess2s: Array = scores.reshape(self._shape)
        excess2s -= excess2s.min(axis=2, keepdims=True)
        excess2s *= 2
        return excess2s

    def products(self, centred: Array) -> Array:
        """Return the products of all maps' inputs less `centre`, (n, sum of dims), with the weights, (n, maps * units).

        With `half_norms2` they are the scores of `Lookup`.
        """
        return blas.few_rows_matmul(centred, self._slopes)


def _blocks(parts: Sequence[Array]) -> Array:
    """Return the block-diagonal matrix of some matrices."""
    heights, widths = zip(*(part.shape for part in parts), strict=True)
    blocks = np.zeros((sum(heights), sum(widths)), parts[0].dtype)
    for part, bottom, right in zip(parts, np.cumsum(heights), np.cumsum(widths), strict=True):
        blocks[bottom - len(part) : bottom, right - part.shape[1] : right] = part
    return blocks
