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
MOST_COVERED = 0.1
"""Part of a marker that is not of its pattern, as in a shadow, from which on its sides tell more than the pattern."""
MOST_LOOKED_AT_AGAIN = 16
LEAST_LIKENESS = 0.72
"""Correlation with its pattern from which on a marker is one: grey cells of something else are read as a code, too."""
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
            of_family, one = numbers == index, self._families[int(index)]
            read = self._read(pixels, refined[of_family], found[of_family], one)
            markers += read
            if len(read) < np.count_nonzero(of_family):
                markers += self._read_within(pixels, _outside(found[of_family], _squares(read)), one)
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

    def _read_within(self, pixels: Pixels, unread: Array, one: Family) -> list[Marker]:
        """Read what is darker in squares that OpenCV read: it may take the white's outline for the marker's."""
        within = [square for quad in unread if (square := reading.dark_square(pixels, quad)) is not None]
        if not within:
            return []
        rough = np.stack(within)
        return self._read(pixels, refine(pixels, rough), rough, one)

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
        levels = reading.sampled(pixels, squares, one.cells)
        shown, shadowed = reading.white(levels), reading.white(levels, reading.SHADOWED)
        for index in range(len(squares)):
            read = _matched(one, shown[index], one.corrected) or _matched(one, shadowed[index], 0)
            if read is not None:
                found.append(read)
                kept.append(index)
                shown[index] = np.rot90(one.shown(read[0].id), read[0].turns)
        if not kept:
            return []
        exact = _aligned(pixels, squares[kept], shown[kept])
        alike = reading.likeness(levels[kept], shown[kept]) >= LEAST_LIKENESS
        return [
            Marker(one.name, match.id, quad[(np.arange(4) - match.turns) % 4], wrong, covered, start)
            for (match, wrong), quad, covered, start, is_one in zip(
                found, exact.corners_px, exact.covered.tolist(), rough[kept], alike, strict=True
            )
            if is_one
        ]


def _matched(one: Family, cells: Cells, corrected: int) -> tuple[Match, int] | None:
    """Find the marker that shows cells with their border, and how many of them are wrong."""
    match, border = one.match(cells[1:-1, 1:-1]), reading.border_wrong(cells)
    if match is None or match.wrong > corrected or border > BORDER_TOLERANCE * 4 * (one.cells + 1):
        return None
    return match, match.wrong + border


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
        shaded = (found.covered > MOST_COVERED)[:, None, None]
        exact.corners_px[small] = np.where(shaded, squares[small], found.corners_px)
        exact.covered[small] = found.covered
    return exact


def _searched(one: Family, ids: Collection[int]) -> Any:
    """Leave out of a large family what is not wanted: time and false markers grow with the codes compared."""
    return one.only(ids) if ids and len(one.codes) > SMALL_FAMILY else one.dictionary


def _quads(corners: object) -> Array:
    return np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)


def _squares(markers: Sequence[Marker]) -> Array:
    return np.array([marker.corners_px for marker in markers]).reshape(-1, 4, 2)


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
