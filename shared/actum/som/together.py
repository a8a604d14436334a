"""Several maps of the same number of units, looked up together."""

from collections.abc import Sequence
from itertools import accumulate
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som import blas
from actum.som.codebook import Codebook

Array = NDArray[Any]


class Together:
    """Maps with equal numbers of units.

    All but the products is done for all maps at once, which saves time where inputs come one by one. The result is that
    of each map's `Codebook.excess2s`, up to rounding.

    >>> maps = [Codebook(1, 2, [[0.0], [3.0]]), Codebook(1, 2, [[0.0, 0.0], [1.0, 1.0]])]
    >>> Together(maps).excess2s(np.array([[1.0, 1.0, 0.0]])).round(6).tolist()
    [[[0.0, 3.0], [0.0, 0.0]]]
    """

    def __init__(self, maps: Sequence[Codebook]) -> None:
        """Lay out what is added and subtracted.

        Raises:
            ValueError: the maps differ in their number of units or their precision.
        """
        if len({(len(som.weights), som.dtype) for som in maps}) != 1:
            found = [(len(som.weights), str(som.dtype)) for som in maps]
            raise ValueError(
                f"the maps differ in their numbers of units or in their data types ({found}): give maps with the same "
                "number of units and the same data type"
            )
        self._dtype = maps[0].dtype
        lookups = [som.lookup for som in maps]
        self.centre = np.concatenate([lookup.centre for lookup in lookups])
        self.half_norms2 = np.array([lookup.half_norms2 for lookup in lookups])
        ends = accumulate(lookup.dim for lookup in lookups)
        self._slopes = [
            (slice(end - lookup.dim, end), lookup.slopes) for end, lookup in zip(ends, lookups, strict=True)
        ]

    def excess2s(self, rows: Array) -> Array:
        """Return d² − d²_min of each unit of each map, shape (n, maps, units), in the maps' precision.

        Args:
            rows: (n, sum of the maps' dims), the inputs of all maps one after the other. None may be missing (NaN):
                it would spread to all maps.
        """
        centred = (rows - self.centre).astype(self._dtype, copy=False)
        excess2s = np.empty((len(centred), *self.half_norms2.shape), self._dtype)
        for number, (columns, slopes) in enumerate(self._slopes):
            excess2s[:, number] = blas.few_rows_matmul(centred[:, columns], slopes)
        excess2s += self.half_norms2
        excess2s -= excess2s.min(axis=2, keepdims=True)
        excess2s *= 2
        return excess2s
