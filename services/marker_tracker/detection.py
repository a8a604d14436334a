"""Markers of several families in an image, their corners to a fraction of a pixel."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker import reading
from marker_tracker.corners import refine
from marker_tracker.families import Family, family
from marker_tracker.images import Pixels

Array = NDArray[np.float64]

BORDER_TOLERANCE = 0.1
"""Part of the border's cells that may look white once the corners are exact."""
SMALL_FAMILY = 50
"""Codes up to which it costs little to search all of them, so that unknown markers are found and told."""
MOST_LOOKED_AT_AGAIN = 16
SAME_PLACE = 0.25
"""Markers whose centres are nearer than this, in parts of a side, are one printed marker."""


@dataclass(frozen=True)
class Marker:
    """A detected marker with `wrong` cells misread; `corners_px` (4, 2) go clockwise from the marker's own top left."""

    family: str
    id: int
    corners_px: Array
    wrong: int = 0

    @cached_property
    def side_px(self) -> float:
        """Mean length of the four sides."""
        sides = self.corners_px - self.corners_px[[3, 0, 1, 2]]
        return float(np.sqrt((sides * sides).sum(axis=1)).mean())

    @cached_property
    def centre_px(self) -> Array:
        """Mean of the corners."""
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
        """Find the markers of a grey image."""
        corners, _ids, rejected, families = self._detector.detectMarkersMultiDict(pixels)
        found = _quads(corners)
        numbers = np.zeros(0, dtype=int) if families is None else np.ravel(families)
        markers: list[Marker] = []
        refined = refine(pixels, found)
        for index in np.unique(numbers):
            markers += self._read(pixels, refined[numbers == index], self._families[int(index)])
        if self._open or not self._wanted <= {(marker.family, marker.id) for marker in markers}:
            markers += self._second_look(pixels, _quads(rejected), found)
        return _apart(markers)

    def _second_look(self, pixels: Pixels, rejected: Array, found: Array) -> list[Marker]:
        """Read squares with a black rim that OpenCV could not read, the largest first."""
        free = _outside(rejected, found)
        rimmed = free[reading.has_black_rim(pixels, free)] if len(free) else free
        largest = rimmed[np.argsort([-cv2.contourArea(quad.astype(np.float32)) for quad in rimmed])]
        refined = refine(pixels, largest[:MOST_LOOKED_AT_AGAIN])
        return [marker for one in self._families for marker in self._read(pixels, refined, one)]

    @staticmethod
    def _read(pixels: Pixels, squares: Array, one: Family) -> list[Marker]:
        if not len(squares):
            return []
        markers: list[Marker] = []
        for quad, shown in zip(squares, reading.read(pixels, squares, one.cells), strict=True):
            match = one.match(shown[1:-1, 1:-1])
            border = reading.border_wrong(shown)
            if match is not None and border <= BORDER_TOLERANCE * 4 * (one.cells + 1):
                turned = quad[(np.arange(4) - match.turns) % 4]
                markers.append(Marker(one.name, match.id, turned, match.wrong + border))
        return markers


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
