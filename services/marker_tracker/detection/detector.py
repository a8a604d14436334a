"""Detect the markers of each image: read those of the previous image again in place, and search at intervals."""

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
"""Nanoseconds between searches while no wanted marker is missing: they find unknown markers and second copies."""
MISSING_SEARCH_INTERVAL_NS = SECOND_NS // 20
"""Nanoseconds between searches while a wanted marker is missing: every image at up to 20 Hz."""
STATIC_PX = 1.0
"""Pixels in each axis by which a marker may differ from its initial corners and still count as static."""
SAME_PLACE_SIDES = 0.25
"""Distance of centres, in sides of a marker, below which two markers are one printed marker read twice."""


class MarkerDetector:
    """Detects markers of several families in the successive images of a camera.

    Markers of the previous image are first read again in place, because a search of the whole image is slow. In a
    search, OpenCV finds squares and decodes them; their corners are refined, and each code is read again at the refined
    corners or else dropped. While a wanted marker is missing, squares that OpenCV could not decode are read as well,
    which finds small markers and markers seen at a steep angle.
    """

    def __init__(self, wanted: Mapping[str, Collection[int]]) -> None:
        """Detect the wanted ids of each family by its name; no ids stand for the whole family."""
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
        """Detect the markers of the next grey image (height, width); all images have the same size."""
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
        """Search a grey image (height, width) for markers; the known ones, already read in it, are returned as well."""
        quads = self._quads.find(pixels, _squares(known))
        markers = [*known, *self._read_decoded(pixels, quads.decoded[quads.new], quads.family[quads.new])]
        if not self._is_complete(markers):
            rough = rimmed_squares(pixels, quads)
            refined = refine(pixels, rough)
            markers += decode(pixels, [Candidates(each, refined, rough) for each in self._families])
        return _distinct(markers)

    def _is_complete(self, markers: Sequence[Marker]) -> bool:
        """Return whether every wanted marker is found."""
        return not self._all_wanted and self._wanted <= {marker.key for marker in markers}

    def _read_near(self, pixels: Pixels, in_place: Sequence[Marker]) -> list[Marker]:
        """Read the previous image's markers that are not `in_place`, by refining their previous corners."""
        read_keys = {marker.key for marker in in_place}
        unread = [marker for marker in self._last if marker.key not in read_keys]
        if not unread:
            return []
        rough = np.stack([_initial_px(marker) for marker in unread])
        near = self._read(pixels, rough, np.array([marker.family for marker in unread]))
        unread_keys = {marker.key for marker in unread}
        return [marker for marker in near if marker.key in unread_keys]

    def _read_decoded(self, pixels: Pixels, rough: Array, numbers: NDArray[np.int_]) -> list[Marker]:
        """Read squares (n, 4, 2) that OpenCV decoded, each as a marker of the family of index `numbers` (n,).

        In a square that cannot be read, the darker square inside is read: OpenCV may have found the paper's outline.
        """
        names = np.array([each.name for each in self._families])
        markers = self._read(pixels, rough, names[numbers])
        inner: dict[str, Array] = {}
        for number, name in enumerate(names):
            squares, read = rough[numbers == number], [marker for marker in markers if marker.family == name]
            if len(read) < len(squares):
                inner[name] = inner_squares(pixels, squares[~within(squares, _squares(read))])
        if inner:
            inner_names = np.repeat([*inner], [len(each) for each in inner.values()])
            markers += self._read(pixels, np.concatenate([*inner.values()]), inner_names)
        return sorted(markers, key=lambda marker: names.tolist().index(marker.family))

    def _read(self, pixels: Pixels, rough: Array, names: NDArray[np.str_]) -> list[Marker]:
        """Refine rough squares (n, 4, 2) and read each as a marker of the family with its name (n,)."""
        if not len(rough):
            return []
        refined = refine(pixels, rough)
        members = [(each, names == each.name) for each in self._families]
        return decode(pixels, [Candidates(each, refined[member], rough[member]) for each, member in members])


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
    taken_px: list[list[float]] = []
    for marker in sorted(markers, key=lambda each: each.wrong):
        reach_px, centre_px = SAME_PLACE_SIDES * marker.side_px, marker.centre_px.tolist()
        if not any(math.dist(centre_px, each_px) < reach_px for each_px in taken_px):
            kept.append(marker)
            taken_px.append(centre_px)
    return kept
