"""From squares to markers: which code the cells of each square show, and exact corners where the marker is small."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices, Mask, Pixels
from marker_tracker.detection.alignment import Alignment, align, sample_squares
from marker_tracker.detection.families import Cells, Family
from marker_tracker.detection.marker import AlignmentStart, Marker

SAMPLES_PER_CELL = 3
"""Along each side of a cell; a cell is read by their mean."""
SAMPLED_SHARE = 0.6
"""Of a cell's width, in which the samples lie: its rim is blurred."""
SHADOW_THRESHOLD = 0.25
"""Between black (0) and white (1), instead of the middle: in a shadow white is darker than the middle."""
MAX_WHITE_BORDER_SHARE = 0.1
"""Of the border's cells that may be read as white: with refined corners hardly one is."""
NARROW_CELL_PX = 3.5
"""Pixels per cell along the shortest side up to which neighbouring cells blur into one another."""
SHARPENING = 0.25
"""Of the Laplacian of a marker's cells, where it cannot be read otherwise: as the AprilTag library does."""
MIN_CORRELATION = 0.72
"""Normalised cross-correlation with the pattern: cells of other things are read as some code, too."""
SMALL_CELL_PX = 6.5
"""Pixels per cell up to which markers are aligned; the sides of larger ones are located well enough."""
MAX_COVERED_ALIGNED = 0.1
"""Share of a marker; where more is covered, or in shadow, its sides tell more than its pattern."""
MAX_COVERED_CLEAR = 0.02
"""Share of a marker up to which it is clear: what covers more would drag the alignment along from image to image."""


@dataclass(frozen=True)
class Candidates:
    """Squares that may show markers of a family.

    Attributes:
        family: the family.
        corners_px: (n, 4, 2), refined, clockwise.
        initial_px: (n, 4, 2), from which they were refined.
    """

    family: Family
    corners_px: Array
    initial_px: Array


@dataclass(frozen=True)
class _Readings:
    """Markers read in squares.

    `index` (n,) is of the square, `corners_px` (n, 4, 2) begin at the marker's own top left; `wrong` counts cells.
    """

    index: Indices
    corners_px: Array
    ids: list[int]
    wrong: list[int]


def decode(pixels: Pixels, candidates: Sequence[Candidates]) -> list[Marker]:
    """Read the markers in candidate squares of a grey image (height, width); align the small ones."""
    return [marker for each in candidates if len(each.corners_px) for marker in _decoded(pixels, each)]


def read_in_place(pixels: Pixels, markers: Sequence[Marker], families: Sequence[Family]) -> list[Marker]:
    """Align and read the small clear markers of the image before, from where their last motion would bring them.

    Left out are markers whose alignment does not converge, that are covered, or that no longer show their code.
    """
    return [marker for family in families for marker in _read_in_place(pixels, markers, family)]


def wrong_cells(pixels: Pixels, corners_px: Array, pattern: Cells) -> Cells:
    """Compare a square (4, 2) with a marker (across, across), its border included: True where it shows another."""
    wrong: Cells = _binarised(_sampled_cells(pixels, corners_px[None], len(pattern) - 2))[0] != pattern
    return wrong


def _decoded(pixels: Pixels, candidates: Candidates) -> list[Marker]:
    family = candidates.family
    readings = _read(_sampled_cells(pixels, candidates.corners_px, family.cells), candidates.corners_px, family)
    corners_px, covered, starts = _aligned_if_small(pixels, readings.corners_px, family.patterns[readings.ids])
    return [
        Marker(family.name, number, quad, wrong, part, candidates.initial_px[at], start)
        for at, number, wrong, quad, part, start in zip(
            readings.index, readings.ids, readings.wrong, corners_px, covered, starts, strict=True
        )
    ]


def _read(levels: Array, corners_px: Array, family: Family) -> _Readings:
    """Match grey levels, as of `_sampled_cells`, with a family's codes.

    What cannot be read as it is, is read as if in a shadow, and, where cells are narrow, sharpened.
    """
    sides_px = np.linalg.norm(corners_px - corners_px[:, [3, 0, 1, 2]], axis=2)
    narrow = sides_px.min(axis=1) <= NARROW_CELL_PX * (family.cells + 2)
    ids, turns, wrong = np.zeros((3, len(levels)), dtype=np.intp)
    any_width, matched = np.ones(len(levels), dtype=bool), np.zeros(len(levels), dtype=bool)
    for tried, threshold, tolerated, width in (
        (levels, 0.5, family.corrected, any_width),
        (levels, SHADOW_THRESHOLD, 0, any_width),
        (_sharpened(levels), 0.5, family.corrected, narrow),
    ):
        (unread,) = np.nonzero(width & ~matched)
        if len(unread):
            found = _matched(tried[unread], threshold, family, tolerated)
            ids[unread], turns[unread], wrong[unread], matched[unread] = found
    (index,) = np.nonzero(matched)
    upright = [np.roll(corners_px[at], turns[at], axis=0) for at in index]
    return _Readings(index, np.array(upright).reshape(-1, 4, 2), ids[index].tolist(), wrong[index].tolist())


def _sharpened(levels: Array) -> Array:
    """Undo blur between the cells of levels, as of `_sampled_cells`, by a Laplacian: (n, across, 1, across, 1)."""
    cells = levels.mean(axis=(2, 4))
    around = np.pad(cells, ((0, 0), (1, 1), (1, 1)), mode="edge")
    beside = around[:, :-2, 1:-1] + around[:, 2:, 1:-1] + around[:, 1:-1, :-2] + around[:, 1:-1, 2:]
    sharpened: Array = cells + SHARPENING * (4 * cells - beside)
    return sharpened[:, :, None, :, None]


def _matched(
    levels: Array, threshold: float, family: Family, tolerated: int
) -> tuple[Indices, Indices, NDArray[np.int64], Mask]:
    """Find the marker nearest to each reading of levels, as of `_sampled_cells`, with its border.

    Returns:
        Ids (n,), quarter turns (n,), wrong cells (n,), and whether code, border and levels fit as they must (n,).
    """
    cells = _binarised(levels, threshold)
    inner = cells[:, 1:-1, 1:-1]
    matches, white_border = family.match(inner), cells.sum(axis=(1, 2)) - inner.sum(axis=(1, 2))
    border_cells = 4 * (family.cells + 1)
    matched = (matches.wrong <= tolerated) & (white_border <= MAX_WHITE_BORDER_SHARE * border_cells)
    for at in np.nonzero(matched)[0]:
        cells[at] = np.rot90(family.patterns[matches.ids[at]], matches.turns[at])
    matched &= _correlation(levels, cells) >= MIN_CORRELATION
    return matches.ids, matches.turns, matches.wrong + white_border, matched


def _aligned_if_small(
    pixels: Pixels, corners_px: Array, patterns: Cells
) -> tuple[Array, list[float], list[AlignmentStart | None]]:
    """Align small markers (n, 4, 2); where more than a little is covered, corners stay as they were refined.

    Returns:
        Corners (n, 4, 2), the covered share of each, and where alignment begins in the next image.
    """
    exact, covered = corners_px.copy(), [0.0] * len(corners_px)
    starts: list[AlignmentStart | None] = [None] * len(corners_px)
    sides_px = np.linalg.norm(corners_px - corners_px[:, [3, 0, 1, 2]], axis=2).mean(axis=1)
    (small,) = np.nonzero(sides_px <= SMALL_CELL_PX * patterns.shape[1])
    if not len(small):
        return exact, covered, starts
    found = align(pixels, corners_px[small], patterns[small])
    for i, at in enumerate(small):
        covered[at] = float(found.covered[i])
        if covered[at] <= MAX_COVERED_ALIGNED:
            exact[at] = found.corners_px[i]
        if covered[at] <= MAX_COVERED_CLEAR:
            starts[at] = AlignmentStart(corners_px[at], found.photometric[i], np.zeros(2))
    return exact, covered, starts


def _read_in_place(pixels: Pixels, markers: Sequence[Marker], family: Family) -> list[Marker]:
    before = [(each, each.start) for each in markers if each.family == family.name and each.start is not None]
    if not before:
        return []
    expected_px = np.stack([start.corners_px + start.motion_px for _, start in before])
    patterns = family.patterns[[marker.id for marker, _ in before]]
    found = align(pixels, expected_px, patterns, np.stack([start.photometric for _, start in before]))
    levels = _sampled_cells(pixels, found.corners_px, family.cells)
    wrong = (_binarised(levels) != patterns).sum(axis=(1, 2))
    shows_code = (wrong <= family.corrected) & (_correlation(levels, patterns) >= MIN_CORRELATION)
    (index,) = np.nonzero(shows_code & found.converged & (found.covered <= MAX_COVERED_CLEAR))
    return [_moved(before[at][0], before[at][1], found, at, int(wrong[at])) for at in index.tolist()]


def _moved(marker: Marker, start: AlignmentStart, found: Alignment, at: int, wrong: int) -> Marker:
    corners_px = found.corners_px[at]
    motion_px = corners_px.mean(axis=0) - marker.centre_px
    return replace(
        marker,
        corners_px=corners_px,
        wrong=wrong,
        covered=float(found.covered[at]),
        start=AlignmentStart(start.corners_px + motion_px, found.photometric[at], motion_px),
    )


def _sampled_cells(pixels: Pixels, corners_px: Array, cells: int) -> Array:
    """Sample squares (n, 4, 2) with their borders: (n, cells + 2, SAMPLES_PER_CELL, cells + 2, SAMPLES_PER_CELL)."""
    across = cells + 2
    levels = sample_squares(pixels, corners_px, _sample_points(across))
    return levels.reshape(-1, across, SAMPLES_PER_CELL, across, SAMPLES_PER_CELL)


@cache
def _sample_points(across: int) -> Array:
    """Sampled points (m, 2) of the unit square, row by row."""
    within = np.linspace(-SAMPLED_SHARE / 2, SAMPLED_SHARE / 2, SAMPLES_PER_CELL)
    unit = (np.arange(across)[:, None] + 0.5 + within).ravel() / across
    return np.stack(np.meshgrid(unit, unit), axis=-1).reshape(-1, 2)


def _binarised(levels: Array, threshold: float = 0.5) -> Cells:
    """Binarise cells by a threshold between the border's median (0) and the mean of the bright ones (1).

    From levels as of `_sampled_cells` to (n, across, across), True where white.
    """
    levels = levels.sum(axis=(2, 4))
    rim = (levels[:, 0], levels[:, -1], levels[:, 1:-1, 0], levels[:, 1:-1, -1])
    border = np.sort(np.concatenate(rim, axis=1), axis=1)
    dark = border[:, border.shape[1] // 2, None, None]
    bright = levels > (levels.min(axis=(1, 2), keepdims=True) + levels.max(axis=(1, 2), keepdims=True)) / 2
    count = np.maximum(bright.sum(axis=(1, 2), keepdims=True), 1)
    light = np.maximum((levels * bright).sum(axis=(1, 2), keepdims=True) / count, dark)
    return np.asarray(levels > dark + threshold * (light - dark))


def _correlation(levels: Array, patterns: Cells) -> Array:
    """Normalised cross-correlation (n,) of levels, as of `_sampled_cells`, with patterns (n, across, across)."""
    mean = levels.mean(axis=(2, 4))
    light, middle = patterns.mean(axis=(1, 2)), mean.mean(axis=(1, 2))
    covariance = (mean * patterns).mean(axis=(1, 2)) - light * middle
    variance = np.einsum("nikjl,nikjl->n", levels, levels) / levels[0].size - middle**2
    correlation: Array = covariance / np.sqrt(np.maximum(variance * light * (1 - light), 1e-9))
    return correlation
