"""Marker families: the bit pattern of each marker, and the marker nearest to a square's cells."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Indices, Mask

Cells = Mask
"""The cells of markers, row by row, True where white."""
Codes = NDArray[np.uint64]
"""Cells without the border, packed into one number: the first cell is the lowest bit."""

PREFIX = "DICT_"
"""Prefix of OpenCV's names of families."""
CORRECTED_SHARE = 0.6
"""Share of a family's correctable cells that are corrected: OpenCV's default `errorCorrectionRate`."""


class UnknownFamilyError(ValueError):
    """No family of markers has that name."""


class UnknownMarkerError(ValueError):
    """A family has no marker of that id."""


@dataclass(frozen=True)
class Matches:
    """The marker nearest to each of n squares' binary cells.

    Attributes:
        ids: (n,) of the markers.
        turns: (n,) quarter turns from the square's first corner clockwise to the marker's own top left.
        wrong: (n,) cells that differ, the border not counted.
    """

    ids: Indices
    turns: Indices
    wrong: NDArray[np.int64]


@dataclass(frozen=True)
class Family:
    """A predefined dictionary of OpenCV.

    Attributes:
        name: OpenCV's name of it.
        cells: along a side, without the border.
        corrected: largest number of wrong cells with which a marker is still recognised.
        codes: (ids, 4) of each marker, as read in each of the four turns.
        dictionary: OpenCV's own object.
    """

    name: str
    cells: int
    corrected: int
    codes: Codes
    dictionary: Any

    def match(self, cells: Cells) -> Matches:
        """Find the marker with the fewest wrong cells for each square's cells (n, cells, cells), without border."""
        wrong = np.bitwise_count(self.codes.reshape(1, -1) ^ _packed(cells)[:, None])
        nearest = np.argmin(wrong, axis=1)
        fewest = np.take_along_axis(wrong, nearest[:, None], axis=1)[:, 0].astype(np.int64)
        return Matches(nearest // 4, nearest % 4, fewest)

    @cached_property
    def patterns(self) -> Cells:
        """All markers upright with their black borders: (ids, cells + 2, cells + 2), True where white."""
        bits = self.codes[:, :1] >> np.arange(self.cells**2, dtype=np.uint64) & np.uint64(1)
        return np.pad(bits.astype(bool).reshape(-1, self.cells, self.cells), ((0, 0), (1, 1), (1, 1)))

    @cached_property
    def turned_patterns(self) -> Cells:
        """All markers in each of the four turns in which they are read: (ids, 4, cells + 2, cells + 2)."""
        return np.stack([np.rot90(self.patterns, turns, axes=(1, 2)) for turns in range(4)], axis=1)

    def only(self, ids: Collection[int]) -> Any:
        """Make an OpenCV dictionary of these ids alone, in rising order: fewer codes take less time to compare."""
        rows = np.ascontiguousarray(self.dictionary.bytesList[sorted(ids)])
        return cv2.aruco.Dictionary(rows, self.cells, self.dictionary.maxCorrectionBits)


def canonical(name: str) -> str:
    """Return OpenCV's name of a family, from a name in any letter case, with or without DICT_.

    Raises:
        UnknownFamilyError: there is no such family.
    """
    known = {entry.upper(): entry for entry in sorted(dir(cv2.aruco), reverse=True) if entry.startswith(PREFIX)}
    upper = name.strip().upper()
    official = known.get(upper) or known.get(PREFIX + upper)
    if official is None:
        names = sorted(set(known))
        raise UnknownFamilyError(f"{name!r} is not a marker dictionary: use one of {', '.join(names)}")
    return official


@cache
def family(name: str) -> Family:
    """Load a family by its name.

    Raises:
        UnknownFamilyError: there is no such family.
    """
    official = canonical(name)
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, official))
    cells, ids = int(dictionary.markerSize), range(len(dictionary.bytesList))
    drawn = [cv2.aruco.generateImageMarker(dictionary, number, cells + 2)[1:-1, 1:-1] > 0 for number in ids]
    codes = np.stack([_packed(np.rot90(drawn, turns, axes=(1, 2))) for turns in range(4)], axis=1)
    return Family(official, cells, int(dictionary.maxCorrectionBits * CORRECTED_SHARE), codes, dictionary)


def _packed(cells: Cells) -> Codes:
    """Pack cells (n, cells, cells) into codes (n,)."""
    weights = np.uint64(1) << np.arange(cells.shape[1] * cells.shape[2], dtype=np.uint64)
    packed: Codes = (cells.reshape(len(cells), -1) * weights).sum(axis=1, dtype=np.uint64)
    return packed
