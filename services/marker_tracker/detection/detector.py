"""Markers of several families in an image, their corners to a fraction of a pixel."""

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection import reading
from marker_tracker.detection.corners import refine
from marker_tracker.detection.decoding import Marker, read_in_place, read_squares
from marker_tracker.detection.families import Family, family
from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]

SMALL_FAMILY = 50
"""Codes up to which it costs little to search all of them, so that unknown markers are found and told."""
MOST_LOOKED_AT_AGAIN = 16
STAYS_PX = 1.0
SAME_PLACE = 0.25
"""Markers whose centres are nearer than this, in parts of a side, are one printed marker."""


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

    def detect(self, pixels: Pixels, here: Sequence[Marker] = ()) -> list[Marker]:
        """Find the markers of a grey image (height, width), of which some may be known to be here."""
        corners, _ids, rejected, families = self._detector.detectMarkersMultiDict(pixels)
        found, numbers = _quads(corners), np.zeros(0, dtype=int) if families is None else np.ravel(families).astype(int)
        new = ~_is_within(found, _squares(here))
        markers = [*here, *self._read_found(pixels, found[new], numbers[new])]
        if not self.is_complete(markers):
            markers += self._second_look(pixels, _quads(rejected), found)
        return _apart(markers)

    def _read_found(self, pixels: Pixels, found: Array, numbers: NDArray[np.int_]) -> list[Marker]:
        """Read squares (n, 4, 2) that OpenCV found, each of the family of a number (n,)."""
        markers: list[Marker] = []
        refined = refine(pixels, found)
        for index in np.unique(numbers):
            of_family, one = numbers == index, self._families[int(index)]
            read = read_squares(pixels, refined[of_family], found[of_family], one)
            markers += read
            if len(read) < np.count_nonzero(of_family):
                markers += self._read_within(pixels, _outside(found[of_family], _squares(read)), one)
        return markers

    def is_complete(self, markers: Sequence[Marker]) -> bool:
        """Tell whether nothing is left to find."""
        return not self._open and self._wanted <= {_key(marker) for marker in markers}

    def read_in_place(self, pixels: Pixels, markers: Sequence[Marker]) -> list[Marker]:
        """Find the small markers of a grey image (height, width) that have hardly moved since another."""
        return [marker for one in self._families for marker in read_in_place(pixels, _of(one, markers), one)]

    def read_again(self, pixels: Pixels, markers: Sequence[Marker]) -> list[Marker]:
        """Find the markers of a grey image (height, width) that are still where they were in another, and no others."""
        here = self.read_in_place(pixels, markers)
        in_place = {_key(marker) for marker in here}
        moved = [marker for marker in markers if _key(marker) not in in_place]
        return _apart([*here, *self._read_near(pixels, moved)])

    def _read_near(self, pixels: Pixels, markers: Sequence[Marker]) -> list[Marker]:
        """Read again what may have moved by as much as corners are refined."""
        if not markers:
            return []
        rough = np.stack([_start_px(marker) for marker in markers])
        refined, names = refine(pixels, rough), np.array([marker.family for marker in markers])
        near: list[Marker] = []
        for one in self._families:
            of_family = names == one.name
            near += read_squares(pixels, refined[of_family], rough[of_family], one)
        known = {_key(marker) for marker in markers}
        return [marker for marker in near if _key(marker) in known]

    def _read_within(self, pixels: Pixels, unread: Array, one: Family) -> list[Marker]:
        """Read what is darker in squares that OpenCV read: it may take the white's outline for the marker's."""
        within = [square for quad in unread if (square := reading.dark_square(pixels, quad)) is not None]
        if not within:
            return []
        rough = np.stack(within)
        return read_squares(pixels, refine(pixels, rough), rough, one)

    def _second_look(self, pixels: Pixels, rejected: Array, found: Array) -> list[Marker]:
        """Read squares with a black rim that OpenCV could not read, the largest first."""
        free = _outside(rejected, found)
        rimmed = free[reading.has_black_rim(pixels, free)] if len(free) else free
        largest = rimmed[np.argsort([-cv2.contourArea(quad.astype(np.float32)) for quad in rimmed])]
        rough = largest[:MOST_LOOKED_AT_AGAIN]
        refined = refine(pixels, rough)
        return [marker for one in self._families for marker in read_squares(pixels, refined, rough, one)]


def _key(marker: Marker) -> tuple[str, int]:
    return marker.family, marker.id


def _of(one: Family, markers: Sequence[Marker]) -> list[Marker]:
    return [marker for marker in markers if marker.family == one.name]


def _start_px(marker: Marker) -> Array:
    """Begin where the refinement began before, that what stays is found just as it was; not where it has moved on."""
    rough = marker.rough_px
    stays = rough is not None and np.abs(rough.mean(axis=0) - marker.centre_px).max() <= STAYS_PX
    return rough if rough is not None and stays else marker.corners_px


def _searched(one: Family, ids: Collection[int]) -> Any:
    """Leave out of a large family what is not wanted: time and false markers grow with the codes compared."""
    return one.only(ids) if ids and len(one.codes) > SMALL_FAMILY else one.dictionary


def _quads(corners: object) -> Array:
    return np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)


def _squares(markers: Sequence[Marker]) -> Array:
    return np.array([marker.corners_px for marker in markers]).reshape(-1, 4, 2)


def _outside(squares: Array, found: Array) -> Array:
    """Leave out squares whose centre is in one that was found: cells of its code."""
    outside: Array = squares[~_is_within(squares, found)]
    return outside


def _is_within(squares: Array, others: Array) -> NDArray[np.bool_]:
    """Tell which squares (n, 4, 2) have their centre in another (m, 4, 2)."""
    outlines = others.astype(np.float32)
    centres = squares.mean(axis=1)
    within = [
        any(cv2.pointPolygonTest(quad, (float(x), float(y)), False) >= 0 for quad in outlines) for x, y in centres
    ]
    return np.array(within, dtype=bool)


def _apart(markers: list[Marker]) -> list[Marker]:
    """Keep one marker in each place: the one with the fewest wrong cells."""
    kept: list[Marker] = []
    for marker in sorted(markers, key=lambda one: one.wrong):
        reach_px = SAME_PLACE * marker.side_px
        if not any(math.dist(marker.centre_px, one.centre_px) < reach_px for one in kept):
            kept.append(marker)
    return kept
