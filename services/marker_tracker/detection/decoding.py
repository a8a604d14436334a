"""Squares to markers: which code each shows, and its corners by all of its pattern where it is small."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection import reading
from marker_tracker.detection.alignment import Aligned, aligned, is_small
from marker_tracker.detection.families import Cells, Family, Match
from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]

BORDER_TOLERANCE = 0.1
"""Part of the border's cells that may look white once the corners are exact."""
MOST_COVERED = 0.1
"""Part of a marker that is not of its pattern, as in a shadow, from which on its sides tell more than the pattern."""
CLEAR = 0.02
"""Part up to which a marker is clear; what covers more of it would draw it along from image to image."""
LEAST_LIKENESS = 0.72
"""Correlation with its pattern from which on a marker is one: grey cells of something else are read as a code, too."""


@dataclass(frozen=True)
class Start:
    """Where the alignment of a marker begins in the next image: `corners_px` (4, 2), in the marker's order.

    They go with the marker, so that what stays is found just as it was. `look` (3,) is its blur in cells, black and
    contrast; `moved_px` (2,) is how far it went last.
    """

    corners_px: Array
    look: Array
    moved_px: Array


@dataclass(frozen=True)
class Marker:
    """A detected marker with `wrong` cells misread, and in part `covered` (0 to 1).

    `corners_px` (4, 2) go clockwise from the marker's own top left; `rough_px` (4, 2) are what they were refined from.
    One that was aligned by all of its pattern, and is not covered, has a `start`. A `hidden` one is where what covers
    it has gone.
    """

    family: str
    id: int
    corners_px: Array
    wrong: int = 0
    covered: float = 0.0
    rough_px: Array | None = None
    start: Start | None = None
    hidden: bool = False

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


@dataclass(frozen=True)
class Read:
    """Squares (n, 4, 2) that show codes, from each marker's own top left on: `which` (n,) of those looked at they are.

    `ids` and `wrong` (n,) tell the markers, and how many of their cells are misread.
    """

    which: NDArray[np.intp]
    squares: Array
    ids: list[int]
    wrong: list[int]


def read_squares(pixels: Pixels, squares: Array, rough: Array, one: Family) -> list[Marker]:
    """Read a family's markers in squares (n, 4, 2), clockwise, that were refined from `rough` (n, 4, 2)."""
    if not len(squares):
        return []
    read = _read(pixels, squares, one)
    exact, covered, starts = _exact(pixels, read.squares, one.shown[read.ids])
    return [
        Marker(one.name, number, quad, wrong, part, rough[at], start)
        for at, number, wrong, quad, part, start in zip(
            read.which, read.ids, read.wrong, exact, covered, starts, strict=True
        )
    ]


def read_in_place(pixels: Pixels, markers: Sequence[Marker], one: Family) -> list[Marker]:
    """Read again those of a family's markers that were clear and go on as before, so that alignment finds them."""
    before = [(marker, marker.start) for marker in markers if marker.start is not None]
    if not before:
        return []
    starts_px = np.stack([start.corners_px + start.moved_px for _, start in before])
    shown, looks = one.shown[[marker.id for marker, _ in before]], np.stack([start.look for _, start in before])
    found = aligned(pixels, starts_px, shown, looks)
    levels = reading.sampled(pixels, found.corners_px, one.cells)
    wrong = (reading.white(levels) != shown).sum(axis=(1, 2))
    shows = (wrong <= one.corrected) & (reading.likeness(levels, shown) >= LEAST_LIKENESS)
    (here,) = np.nonzero(shows & found.settled & (found.covered <= CLEAR))
    return [_gone_on(before[at], found, at, int(wrong[at])) for at in here.tolist()]


def _gone_on(before: tuple[Marker, Start], found: Aligned, at: int, wrong: int) -> Marker:
    (marker, start), corners_px = before, found.corners_px[at]
    moved_px = corners_px.mean(axis=0) - marker.centre_px
    return replace(
        marker,
        corners_px=corners_px,
        wrong=wrong,
        covered=float(found.covered[at]),
        start=Start(start.corners_px + moved_px, found.looks[at], moved_px),
    )


def _read(pixels: Pixels, squares: Array, one: Family) -> Read:
    """Match what squares (n, 4, 2) show with a family's codes, in plain light or else in a shadow."""
    levels = reading.sampled(pixels, squares, one.cells)
    shown = reading.white(levels)
    matched: list[tuple[Match, int]] = []
    which: list[int] = []
    for index, level in enumerate(levels):
        match = _matched(one, shown[index], one.corrected) or _matched(one, _in_shadow(level), 0)
        if match is not None:
            matched.append(match)
            which.append(index)
            shown[index] = np.rot90(one.shown[match[0].id], match[0].turns)
    alike = reading.likeness(levels, shown)[which] >= LEAST_LIKENESS
    kept, found = np.array(which, dtype=np.intp)[alike], [it for it, like in zip(matched, alike, strict=True) if like]
    upright = [np.roll(squares[at], match.turns, axis=0) for at, (match, _) in zip(kept, found, strict=True)]
    return Read(
        kept, np.array(upright).reshape(-1, 4, 2), [match.id for match, _ in found], [wrong for _, wrong in found]
    )


def _in_shadow(level: Array) -> Cells:
    cells: Cells = reading.white(level[None], reading.SHADOWED)[0]
    return cells


def _matched(one: Family, cells: Cells, corrected: int) -> tuple[Match, int] | None:
    """Find the marker that shows cells with their border, and how many of them are wrong."""
    match, border = one.match(cells[1:-1, 1:-1]), reading.border_wrong(cells)
    if match is None or match.wrong > corrected or border > BORDER_TOLERANCE * 4 * (one.cells + 1):
        return None
    return match, match.wrong + border


def _exact(pixels: Pixels, squares: Array, shown: Cells) -> tuple[Array, list[float], list[Start | None]]:
    """Align the small ones of squares (n, 4, 2) where their pattern tells more than their sides.

    Returns:
        Corners (n, 4, 2), the part of each that is covered, and where to begin in the next image.
    """
    exact, covered = squares.copy(), [0.0] * len(squares)
    starts: list[Start | None] = [None] * len(squares)
    (small,) = np.nonzero(is_small(squares, shown.shape[1]))
    if not len(small):
        return exact, covered, starts
    found = aligned(pixels, squares[small], shown[small])
    for at, corners_px, part, look in zip(small, found.corners_px, found.covered.tolist(), found.looks, strict=True):
        covered[at] = part
        exact[at] = corners_px if part <= MOST_COVERED else squares[at]
        starts[at] = Start(squares[at], look, np.zeros(2)) if part <= CLEAR else None
    return exact, covered, starts
