"""A stream's newest numbers as arrays: a decision then needs no walk through hundreds of samples."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

FIRST_ROWS = 512
"""Rows that there is room for at first: what a person's stream holds after 17 s at 30 Hz."""


class Columns:
    """Rows of numbers, one for each sample, in the order in which they came.

    Args:
        dtype: of the numbers.
        shape: of a row.
    """

    def __init__(self, dtype: type[np.generic], *shape: int) -> None:
        self._rows: NDArray[Any] = np.empty((FIRST_ROWS, *shape), dtype)
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def append(self, row: Any, kept: int) -> None:
        """Add a row; those before the newest `kept`, this one included, may be forgotten; there may be fewer."""
        if self._count == len(self._rows):
            live = self._rows[max(self._count + 1 - kept, 0) :]
            self._rows = np.empty((max(2 * kept, FIRST_ROWS), *live.shape[1:]), live.dtype)
            self._rows[: len(live)] = live
            self._count = len(live)
        self._rows[self._count] = row
        self._count += 1

    def newest(self, count: int) -> NDArray[Any]:
        """Return the newest rows, (count, *shape); rows that are added later do not change them."""
        return self._rows[self._count - count : self._count]
