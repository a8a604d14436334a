"""The families of markers: what cells each of their markers shows, and which marker shows given cells."""

from collections.abc import Collection
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

Cells = NDArray[np.bool_]
Codes = NDArray[np.uint64]

PREFIX = "DICT_"
CORRECTED = 0.6
"""In what part of the cells that a family could correct errors are corrected: OpenCV's own."""


class UnknownFamilyError(ValueError):
    """A name that is no family of markers."""


class UnknownMarkerError(ValueError):
    """A family has no marker of that id."""


@dataclass(frozen=True)
class Match:
    """The marker that shows some cells: how many quarter turns its top left is on clockwise, and the wrong cells."""

    id: int
    turns: int
    wrong: int


@dataclass(frozen=True)
class Family:
    """A dictionary of OpenCV: `cells` along a side without the border, `codes` (ids, 4) of each id in each turn."""

    name: str
    cells: int
    corrected: int
    codes: Codes
    dictionary: Any

    def match(self, cells: Cells) -> Match | None:
        """Find the marker that shows cells (cells, cells), True where white, with no more errors than `corrected`."""
        wrong = np.bitwise_count(self.codes ^ _code(cells))
        at = int(np.argmin(wrong))
        fewest = int(wrong.flat[at])
        return Match(at // 4, at % 4, fewest) if fewest <= self.corrected else None

    @cached_property
    def shown(self) -> Cells:
        """What each marker shows with its border, upright: (ids, cells + 2, cells + 2), True where white."""
        bits = self.codes[:, :1] >> np.arange(self.cells**2, dtype=np.uint64) & np.uint64(1)
        return np.pad(bits.astype(bool).reshape(-1, self.cells, self.cells), ((0, 0), (1, 1), (1, 1)))

    def only(self, ids: Collection[int]) -> Any:
        """Make a dictionary of these ids alone, in rising order: every id it lacks costs no time and is no mistake."""
        rows = np.ascontiguousarray(self.dictionary.bytesList[sorted(ids)])
        return cv2.aruco.Dictionary(rows, self.cells, self.dictionary.maxCorrectionBits)


def canonical(name: str) -> str:
    """Turn a family's name, with or without DICT_ and in any case, into OpenCV's.

    Raises:
        UnknownFamilyError: there is no such family.
    """
    known = {entry.upper(): entry for entry in sorted(dir(cv2.aruco), reverse=True) if entry.startswith(PREFIX)}
    upper = name.strip().upper()
    found = known.get(upper) or known.get(PREFIX + upper)
    if found is None:
        names = sorted(set(known))
        raise UnknownFamilyError(f"{name!r} is no marker dictionary: use one of {', '.join(names)}")
    return found


@cache
def family(name: str) -> Family:
    """Load a family by its name.

    Raises:
        UnknownFamilyError: there is no such family.
    """
    own = canonical(name)
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, own))
    cells = int(dictionary.markerSize)
    codes = np.array([_turned(dictionary, number) for number in range(len(dictionary.bytesList))], dtype=np.uint64)
    return Family(own, cells, int(dictionary.maxCorrectionBits * CORRECTED), codes, dictionary)


def _turned(dictionary: Any, number: int) -> list[np.uint64]:
    """Code a marker's cells as they are read when the reading starts 0 to 3 corners, clockwise, after its top left."""
    drawn = cv2.aruco.generateImageMarker(dictionary, number, int(dictionary.markerSize) + 2)
    return [_code(np.rot90(drawn[1:-1, 1:-1] > 0, turns)) for turns in range(4)]


def _code(cells: Cells) -> np.uint64:
    weights = np.uint64(1) << np.arange(cells.size, dtype=np.uint64)
    return np.uint64((weights * cells.ravel()).sum(dtype=np.uint64))
