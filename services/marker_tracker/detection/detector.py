"""The markers of each image: read again in their places, or searched for in the whole image when that is due."""

import math
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Pixels
from actum.node import SECOND_NS
from marker_tracker.detection.corners import refine
from marker_tracker.detection.decoding import Candidates, decode, read_in_place
from marker_tracker.detection.families import family
from marker_tracker.detection.marker import Marker
from marker_tracker.detection.quads import QuadDetector, inner_squares, rimmed_squares, within

SEARCH_INTERVAL_NS = SECOND_NS // 3
"""Nanoseconds between whole searches with nothing missing: unknown markers and second copies are to be told, too."""
MISSING_SEARCH_INTERVAL_NS = SECOND_NS // 20
"""Nanoseconds between whole searches while a wanted marker is missing: every image of a slow camera."""
STATIC_PX = 1.0
"""Pixels in each axis by which a marker may differ from its initial corners and still count as static."""
SAME_PLACE_SIDES = 0.25
"""Distance of centres, in sides of a marker, below which two markers are one printed marker read twice."""


class MarkerDetector:
    """Detects markers of several families in images that follow one another.

    A search of the whole image costs more than all the rest, so that markers are first read again where they were.
    A search has OpenCV find squares and decode them; the squares' corners are refined, and each code is read again at
    these corners. What cannot be read again is dropped. While a wanted marker is missing, squares that OpenCV could
    not decode are read as well, which finds markers that are small or steep.
    """

    def __init__(self, wanted: Mapping[str, Collection[int]]) -> None:
        """Detect these ids of these families, or all of a family where no ids are given."""
        self._families = [family(name) for name in wanted]
        self._quads = QuadDetector(self._families, [*wanted.values()])
        self._wanted = {(name, number) for name, ids in wanted.items() for number in ids}
        self._all_wanted = not all(wanted.values())
        self._last: list[Marker] = []
        self._searched_ns = 0

    def clear(self) -> None:
        """Forget where markers were."""
        self._last = []
        self._searched_ns = 0

    def detect(self, stamp_ns: int, pixels: Pixels) -> list[Marker]:
        """Detect the markers of the next grey image (height, width), of the size of the one before."""
        interval_ns = SEARCH_INTERVAL_NS if self._is_complete(self._last) else MISSING_SEARCH_INTERVAL_NS
        due = stamp_ns - self._searched_ns >= interval_ns
        markers = read_in_place(pixels, self._last, self._families)
        if not due:
            markers = _distinct([*markers, *self._read_near(pixels, markers)])
        if due or len(markers) < max(1, len(self._last)):
            markers = self.search(pixels, markers)
            self._searched_ns = stamp_ns
        self._last = markers
        return markers

    def search(self, pixels: Pixels, known: Sequence[Marker] = ()) -> list[Marker]:
        """Search a grey image (height, width) for markers, of which some may be known already."""
        quads = self._quads.find(pixels, _squares(known))
        markers = [*known, *self._read_decoded(pixels, quads.decoded[quads.new], quads.family[quads.new])]
        if not self._is_complete(markers):
            rough = rimmed_squares(pixels, quads)
            refined = refine(pixels, rough)
            markers += decode(pixels, [Candidates(each, refined, rough) for each in self._families])
        return _distinct(markers)

    def _is_complete(self, markers: Sequence[Marker]) -> bool:
        """Tell whether every wanted marker is found."""
        return not self._all_wanted and self._wanted <= {marker.key for marker in markers}

    def _read_near(self, pixels: Pixels, in_place: Sequence[Marker]) -> list[Marker]:
        """Read the other markers of the image before, which may have moved as far as refinement corrects corners."""
        found = {marker.key for marker in in_place}
        others = [marker for marker in self._last if marker.key not in found]
        if not others:
            return []
        rough = np.stack([_initial_px(marker) for marker in others])
        near = self._read(pixels, rough, np.array([marker.family for marker in others]))
        known = {marker.key for marker in others}
        return [marker for marker in near if marker.key in known]

    def _read_decoded(self, pixels: Pixels, rough: Array, numbers: NDArray[np.int_]) -> list[Marker]:
        """Read squares (n, 4, 2) that OpenCV decoded, each as of the family with a number (n,).

        In what cannot be read, a darker square is read: OpenCV may take the outline of the paper for the marker's.
        """
        names = np.array([each.name for each in self._families])
        markers = self._read(pixels, rough, names[numbers])
        inner: dict[str, Array] = {}
        for number, name in enumerate(names):
            own, read = rough[numbers == number], [marker for marker in markers if marker.family == name]
            if len(read) < len(own):
                inner[name] = inner_squares(pixels, own[~within(own, _squares(read))])
        if inner:
            inner_names = np.repeat([*inner], [len(each) for each in inner.values()])
            markers += self._read(pixels, np.concatenate([*inner.values()]), inner_names)
        return sorted(markers, key=lambda marker: names.tolist().index(marker.family))

    def _read(self, pixels: Pixels, rough: Array, names: NDArray[np.str_]) -> list[Marker]:
        """Refine rough squares (n, 4, 2) and read each as of the family with a name (n,)."""
        if not len(rough):
            return []
        refined = refine(pixels, rough)
        own = [(each, names == each.name) for each in self._families]
        return decode(pixels, [Candidates(each, refined[of_it], rough[of_it]) for each, of_it in own])


def _initial_px(marker: Marker) -> Array:
    """Reuse the previous initial corners (4, 2) of a static marker, so that refinement repeats; else its corners."""
    initial_px = marker.initial_px
    if initial_px is None or np.abs(initial_px.mean(axis=0) - marker.centre_px).max() > STATIC_PX:
        return marker.corners_px
    return initial_px


def _squares(markers: Sequence[Marker]) -> Array:
    """Stack the corners of markers: (n, 4, 2)."""
    return np.array([marker.corners_px for marker in markers]).reshape(-1, 4, 2)


def _distinct(markers: list[Marker]) -> list[Marker]:
    """Keep one marker in each place: the one with the fewest wrong cells."""
    kept: list[Marker] = []
    for marker in sorted(markers, key=lambda each: each.wrong):
        reach_px = SAME_PLACE_SIDES * marker.side_px
        if not any(math.dist(marker.centre_px, each.centre_px) < reach_px for each in kept):
            kept.append(marker)
    return kept
