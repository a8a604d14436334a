"""Markers of several families in an image, their corners to a fraction of a pixel."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker import reading
from marker_tracker.alignment import Aligned, aligned, is_small
from marker_tracker.corners import refine
from marker_tracker.families import Cells, Family, Match, family
from marker_tracker.images import Pixels

Array = NDArray[np.float64]

BORDER_TOLERANCE = 0.1
"""Part of the border's cells that may look white once the corners are exact."""
SMALL_FAMILY = 50
"""Codes up to which it costs little to search all of them, so that unknown markers are found and told."""
MOST_LOOKED_AT_AGAIN = 16
STAYS_PX = 1.0
SAME_PLACE = 0.25
"""Markers whose centres are nearer than this, in parts of a side, are one printed marker."""


@dataclass(frozen=True)
class Marker:
    """A detected marker with `wrong` cells misread, and in part `covered` (0 to 1).

    `corners_px` (4, 2) go clockwise from the marker's own top left; `rough_px` (4, 2) are what they were refined from.
    """

    family: str
    id: int
    corners_px: Array
    wrong: int = 0
    covered: float = 0.0
    rough_px: Array | None = None

    @cached_property
    def side_px(self) -> float:
        """Mean length of the four sides."""
        sides = self.corners_px - self.corners_px[[3, 0, 1, 2]]
        return float(np.sqrt((sides * sides).sum(axis=1)).mean())

    @cached_property
    def centre_px(self) -> Array:
        """Mean of the corners: (2,)."""
        centre: Array = self.corners_px.sum(axis=0) / 4
        return centre


class MarkerDetector:
    """OpenCV finds squares and reads them; corners are then refined, and each code is read again at exact corners.

    What OpenCV took for a marker and cannot be read again is dropped; while a wanted marker is missing, squares that
    OpenCV could not read are given a second look, which finds markers that are small or steep.
    """

    def __init__(self, wanted: Mapping[str, Collection[int]]) -> None:
        """Search these families: for these ids, or for all where there are none or the family is small."""
        self._families = [family(name) for name in wanted]
        self._wanted = {(name, number) for name, ids in wanted.items() for number in ids}
        self._open = not all(wanted.values())
        dictionaries = [_searched(one, ids) for one, ids in zip(self._families, wanted.values(), strict=True)]
        self._detector = cv2.aruco.ArucoDetector(dictionaries, cv2.aruco.DetectorParameters())

    def detect(self, pixels: Pixels) -> list[Marker]:
        """Find the markers of a grey image (height, width)."""
        corners, _ids, rejected, families = self._detector.detectMarkersMultiDict(pixels)
        found = _quads(corners)
        numbers = np.zeros(0, dtype=int) if families is None else np.ravel(families)
        markers: list[Marker] = []
        refined = refine(pixels, found)
        for index in np.unique(numbers):
            of_family = numbers == index
            markers += self._read(pixels, refined[of_family], found[of_family], self._families[int(index)])
        if not self.is_complete(markers):
            markers += self._second_look(pixels, _quads(rejected), found)
        return _apart(markers)

    def is_complete(self, markers: Sequence[Marker]) -> bool:
        """Tell whether nothing is left to find."""
        return not self._open and self._wanted <= {(marker.family, marker.id) for marker in markers}

    def read_again(self, pixels: Pixels, markers: Sequence[Marker]) -> list[Marker]:
        """Find the markers of a grey image (height, width) that are still where they were in another, and no others."""
        if not markers:
            return []
        rough = np.stack([_start_px(marker) for marker in markers])
        refined, names = refine(pixels, rough), np.array([marker.family for marker in markers])
        here: list[Marker] = []
        for one in self._families:
            of_family = names == one.name
            here += self._read(pixels, refined[of_family], rough[of_family], one)
        known = {(marker.family, marker.id) for marker in markers}
        return _apart([marker for marker in here if (marker.family, marker.id) in known])

    def _second_look(self, pixels: Pixels, rejected: Array, found: Array) -> list[Marker]:
        """Read squares with a black rim that OpenCV could not read, the largest first."""
        free = _outside(rejected, found)
        rimmed = free[reading.has_black_rim(pixels, free)] if len(free) else free
        largest = rimmed[np.argsort([-cv2.contourArea(quad.astype(np.float32)) for quad in rimmed])]
        rough = largest[:MOST_LOOKED_AT_AGAIN]
        refined = refine(pixels, rough)
        return [marker for one in self._families for marker in self._read(pixels, refined, rough, one)]

    @staticmethod
    def _read(pixels: Pixels, squares: Array, rough: Array, one: Family) -> list[Marker]:
        if not len(squares):
            return []
        found: list[tuple[Match, int]] = []
        kept: list[int] = []
        shown = reading.read(pixels, squares, one.cells)
        for index, cells in enumerate(shown):
            match, border = one.match(cells[1:-1, 1:-1]), reading.border_wrong(cells)
            if match is not None and border <= BORDER_TOLERANCE * 4 * (one.cells + 1):
                found.append((match, match.wrong + border))
                kept.append(index)
                shown[index] = np.rot90(one.shown(match.id), match.turns)
        exact = _aligned(pixels, squares[kept], shown[kept])
        return [
            Marker(one.name, match.id, quad[(np.arange(4) - match.turns) % 4], wrong, covered, start)
            for (match, wrong), quad, covered, start in zip(
                found, exact.corners_px, exact.covered.tolist(), rough[kept], strict=True
            )
        ]


def _start_px(marker: Marker) -> Array:
    """Begin where the refinement began before, that what stays is found just as it was; not where it has moved on."""
    rough = marker.rough_px
    stays = rough is not None and np.abs(rough.mean(axis=0) - marker.centre_px).max() <= STAYS_PX
    return rough if rough is not None and stays else marker.corners_px


def _aligned(pixels: Pixels, squares: Array, shown: Cells) -> Aligned:
    """Align the small ones of one family's markers; nothing is known to cover the others."""
    small = is_small(squares, shown.shape[1])
    exact = Aligned(squares.copy(), np.zeros(len(squares)))
    if small.any():
        found = aligned(pixels, squares[small], shown[small])
        exact.corners_px[small], exact.covered[small] = found.corners_px, found.covered
    return exact


def _searched(one: Family, ids: Collection[int]) -> Any:
    """Leave out of a large family what is not wanted: time and false markers grow with the codes compared."""
    return one.only(ids) if ids and len(one.codes) > SMALL_FAMILY else one.dictionary


def _quads(corners: object) -> Array:
    return np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)


def _outside(squares: Array, found: Array) -> Array:
    """Leave out squares whose centre is in one that was found: cells of its code."""
    centres = squares.mean(axis=1)
    inside = [
        any(cv2.pointPolygonTest(quad.astype(np.float32), (float(x), float(y)), False) >= 0 for quad in found)
        for x, y in centres
    ]
    outside: Array = squares[~np.array(inside, dtype=bool)]
    return outside


def _apart(markers: list[Marker]) -> list[Marker]:
    """Keep one marker in each place: the one with the fewest wrong cells."""
    kept: list[Marker] = []
    for marker in sorted(markers, key=lambda one: one.wrong):
        reach_px = SAME_PLACE * marker.side_px
        if not any(math.dist(marker.centre_px, one.centre_px) < reach_px for one in kept):
            kept.append(marker)
    return kept
