"""Decode squares: read the code in the cells of each, and align the markers that are small."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Indices, Mask, Pixels
from marker_tracker.detection.alignment import Alignment, align, sample_squares
from marker_tracker.detection.families import Cells, Family
from marker_tracker.detection.marker import AlignmentStart, Marker

SAMPLES_PER_CELL = 3
"""Samples along each side of a cell; their mean is the cell's grey level."""
SAMPLED_SHARE = 0.6
"""Share of a cell's width in which the samples lie: its rim is blurred."""
SHADOW_THRESHOLD = 0.25
"""Binarisation threshold in a shadow, between black (0) and white (1): there white is darker than the usual 0.5."""
MAX_WHITE_BORDER_SHARE = 0.1
"""Share of the border's cells that may be read as white: with refined corners hardly any is."""
NARROW_CELL_PX = 3.5
"""Largest width of a narrow cell, in pixels along the shortest side: neighbouring cells blur into one another."""
SHARPENING = 0.25
"""Weight of the Laplacian that sharpens narrow cells which cannot be read otherwise: the AprilTag library's."""
MIN_CORRELATION = 0.72
"""Least normalised cross-correlation with the pattern: squares that are no markers may be read as a code, too."""
SMALL_CELL_PX = 6.5
"""Pixels per cell up to which markers are aligned; the sides of larger ones are located well enough."""
MAX_COVERED_ALIGNED = 0.1
"""Largest covered or shadowed share of a marker that is aligned; above it, corners fitted to the sides are better."""
MAX_COVERED_CLEAR = 0.02
"""Largest covered share of a clear marker, which is aligned from image to image: more would drag its corners along."""


@dataclass(frozen=True)
class Candidates:
    """Squares that may show markers of a family.

    Attributes:
        family: the family.
        corners_px: (n, 4, 2), refined corners, clockwise.
        initial_px: (n, 4, 2), the same corners before refinement.
    """

    family: Family
    corners_px: Array
    initial_px: Array


@dataclass(frozen=True)
class _Readings:
    """The n markers read in a family's candidate squares.

    Attributes:
        index: (n,) of each marker's square among the candidates.
        corners_px: (n, 4, 2), clockwise from the marker's own top left.
        ids: of the markers in the family.
        wrong: number of misread cells of each.
    """

    index: Indices
    corners_px: Array
    ids: list[int]
    wrong: list[int]


def decode(pixels: Pixels, candidates: Sequence[Candidates]) -> list[Marker]:
    """Read the markers in candidate squares of a grey image (height, width); align the small ones."""
    return [marker for each in candidates if len(each.corners_px) for marker in _decoded(pixels, each)]


def read_in_place(pixels: Pixels, markers: Sequence[Marker], families: Sequence[Family]) -> list[Marker]:
    """Align and read the small clear markers of the previous image again, starting where their last motion leads.

    Markers are left out if their alignment does not converge, they are covered, or their code cannot be read.
    """
    return [marker for family in families for marker in _read_in_place(pixels, markers, family)]


def wrong_cells(pixels: Pixels, corners_px: Array, pattern: Cells) -> Cells:
    """Compare a square's cells (4, 2) with a pattern (across, across), border included: True where they differ."""
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
    """Match levels, as `_sampled_cells` returns them, with a family's codes.

    Squares that cannot be read are read again with the threshold for shadows and, if their cells are narrow, sharpened.
    """
    sides_px = np.linalg.norm(corners_px - corners_px[:, [3, 0, 1, 2]], axis=2)
    narrow = sides_px.min(axis=1) <= NARROW_CELL_PX * (family.cells + 2)
    ids, turns, wrong = np.zeros((3, len(levels)), dtype=np.intp)
    all_squares, matched = np.ones(len(levels), dtype=bool), np.zeros(len(levels), dtype=bool)
    for prepare, threshold, tolerated, applies in (
        (np.asarray, 0.5, family.corrected, all_squares),
        (np.asarray, SHADOW_THRESHOLD, 0, all_squares),
        (_sharpened, 0.5, family.corrected, narrow),
    ):
        (unread,) = np.nonzero(applies & ~matched)
        if len(unread):
            result = _matched(prepare(levels[unread]), threshold, family, tolerated)
            ids[unread], turns[unread], wrong[unread], matched[unread] = result
    (index,) = np.nonzero(matched)
    upright = corners_px[index[:, None], (np.arange(4) - turns[index, None]) % 4]
    return _Readings(index, upright, ids[index].tolist(), wrong[index].tolist())


def _sharpened(levels: Array) -> Array:
    """Sharpen levels, as from `_sampled_cells`, by the Laplacian of the cells' means: (n, across, 1, across, 1)."""
    cells = levels.mean(axis=(2, 4))
    padded = np.pad(cells, ((0, 0), (1, 1), (1, 1)), mode="edge")
    neighbours = padded[:, :-2, 1:-1] + padded[:, 2:, 1:-1] + padded[:, 1:-1, :-2] + padded[:, 1:-1, 2:]
    sharpened: Array = cells + SHARPENING * (4 * cells - neighbours)
    return sharpened[:, :, None, :, None]


def _matched(
    levels: Array, threshold: float, family: Family, tolerated: int
) -> tuple[Indices, Indices, NDArray[np.int64], Mask]:
    """Binarise levels, as from `_sampled_cells`, and find the marker nearest to each square, border included.

    Returns:
        Ids (n,), quarter turns (n,), wrong cells (n,), and whether code, border and levels fit well enough (n,).
    """
    cells = _binarised(levels, threshold)
    inner = cells[:, 1:-1, 1:-1]
    matches, white_border = family.match(inner), cells.sum(axis=(1, 2)) - inner.sum(axis=(1, 2))
    border_cells = 4 * (family.cells + 1)
    matched = (matches.wrong <= tolerated) & (white_border <= MAX_WHITE_BORDER_SHARE * border_cells)
    cells[matched] = family.turned_patterns[matches.ids[matched], matches.turns[matched]]
    matched &= _correlation(levels, cells) >= MIN_CORRELATION
    return matches.ids, matches.turns, matches.wrong + white_border, matched


def _aligned_if_small(
    pixels: Pixels, corners_px: Array, patterns: Cells
) -> tuple[Array, list[float], list[AlignmentStart | None]]:
    """Align small markers (n, 4, 2), except those that are covered by more than `MAX_COVERED_ALIGNED`.

    Returns:
        Corners (n, 4, 2), the covered share of each marker, and the initial values of its alignment in the next image.
    """
    exact, covered = corners_px.copy(), [0.0] * len(corners_px)
    starts: list[AlignmentStart | None] = [None] * len(corners_px)
    sides_px = np.linalg.norm(corners_px - corners_px[:, [3, 0, 1, 2]], axis=2).mean(axis=1)
    (small,) = np.nonzero(sides_px <= SMALL_CELL_PX * patterns.shape[1])
    if not len(small):
        return exact, covered, starts
    aligned = align(pixels, corners_px[small], patterns[small])
    for i, at in enumerate(small):
        covered[at] = float(aligned.covered[i])
        if covered[at] <= MAX_COVERED_ALIGNED:
            exact[at] = aligned.corners_px[i]
        if covered[at] <= MAX_COVERED_CLEAR:
            starts[at] = AlignmentStart(corners_px[at], aligned.photometric[i], np.zeros(2))
    return exact, covered, starts


def _read_in_place(pixels: Pixels, markers: Sequence[Marker], family: Family) -> list[Marker]:
    before = [(each, each.start) for each in markers if each.family == family.name and each.start is not None]
    if not before:
        return []
    expected_px = np.stack([start.corners_px + start.motion_px for _, start in before])
    patterns = family.patterns[[marker.id for marker, _ in before]]
    aligned = align(pixels, expected_px, patterns, np.stack([start.photometric for _, start in before]))
    levels = _sampled_cells(pixels, aligned.corners_px, family.cells)
    wrong = (_binarised(levels) != patterns).sum(axis=(1, 2))
    shows_code = (wrong <= family.corrected) & (_correlation(levels, patterns) >= MIN_CORRELATION)
    (index,) = np.nonzero(shows_code & aligned.converged & (aligned.covered <= MAX_COVERED_CLEAR))
    centres_px = aligned.corners_px.mean(axis=1)
    return [_moved(*before[at], aligned, at, centres_px[at], int(wrong[at])) for at in map(int, index)]


def _moved(marker: Marker, start: AlignmentStart, aligned: Alignment, at: int, centre_px: Array, wrong: int) -> Marker:
    motion_px = centre_px - marker.centre_px
    moved = AlignmentStart(start.corners_px + motion_px, aligned.photometric[at], motion_px)
    return Marker(
        marker.family, marker.id, aligned.corners_px[at], wrong, float(aligned.covered[at]), marker.initial_px, moved
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
    """Binarise cells by a threshold between the border's median (0) and the mean of the bright cells (1).

    Takes levels as `_sampled_cells` returns them; returns (n, across, across), True where white.
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
    """Normalised cross-correlation (n,) of levels, as from `_sampled_cells`, with patterns (n, across, across)."""
    mean = levels.mean(axis=(2, 4))
    light, middle = patterns.mean(axis=(1, 2)), mean.mean(axis=(1, 2))
    covariance = (mean * patterns).mean(axis=(1, 2)) - light * middle
    variance = np.einsum("nikjl,nikjl->n", levels, levels) / levels[0].size - middle**2
    correlation: Array = covariance / np.sqrt(np.maximum(variance * light * (1 - light), 1e-9))
    return correlation
