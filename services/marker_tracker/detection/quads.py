"""Black squares in an image, found by OpenCV: those it decoded, and undecoded ones that are worth reading again."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array, Mask, Pixels
from marker_tracker.detection.alignment import sample_squares
from marker_tracker.detection.families import Family

SMALL_FAMILY = 50
"""Largest family that is searched as a whole: it costs little, and unknown markers are found and reported."""
MAX_REJECTED_READ = 16
"""Rejected squares read per image; each costs about a tenth of a millisecond to refine and read."""
RIM_OFFSET = 0.1
"""Distance of the samples from a side, as a share of it: outside lies the white margin, inside the black border."""
RIM_SAMPLES = 8
"""Samples along each side: their median is not misled by a finger on less than half of it."""
RIM_EXTENT = (0.15, 0.85)
"""Part of a side in which the samples lie: near its ends, rough corners miss the side."""
MIN_CONTRAST = 10.0
"""Grey levels by which the outside of a side is brighter than its inside: less is noise."""
THRESHOLD_WINDOWS_PX = (5, 25, 10)
"""Smallest and largest window of the adaptive threshold, and the step between them. OpenCV's smallest is 3, which is
too small for a blurred edge."""
OUTLINE_PX = THRESHOLD_WINDOWS_PX[0] // 2
"""Pixels by which OpenCV's squares may extend beyond their edge, onto a dark surface around the paper."""
MIN_QUAD_DISTANCE = 0.05
"""Distance of two squares' corners, as a share of the perimeter, below which OpenCV drops the smaller square. With its
default of 0.125 it drops many markers in favour of the outline of their paper."""
POLYGON_TOLERANCE = 0.03
"""Deviation of an outline from its polygon, as a share of the outline's length: OpenCV's default."""


@dataclass(frozen=True)
class Quads:
    """Quadrilaterals in an image, clockwise.

    Attributes:
        decoded: (n, 4, 2), quadrilaterals that OpenCV decoded as markers.
        family: (n,) index of each decoded marker's family among the searched ones.
        new: (n,) whether the decoded marker does not lie on a known one.
        rejected: (m, 4, 2), quadrilaterals that OpenCV could not decode.
    """

    decoded: Array
    family: NDArray[np.int_]
    new: Mask
    rejected: Array


class QuadDetector:
    """OpenCV's marker detector for several families."""

    def __init__(self, families: Sequence[Family], wanted: Sequence[Collection[int]]) -> None:
        """Search each family for its wanted ids, or for all ids where none are wanted or the family is small."""
        dictionaries = [_searched(family, ids) for family, ids in zip(families, wanted, strict=True)]
        parameters = cv2.aruco.DetectorParameters()
        least_px, greatest_px, step_px = THRESHOLD_WINDOWS_PX
        parameters.adaptiveThreshWinSizeMin = least_px
        parameters.adaptiveThreshWinSizeMax = greatest_px
        parameters.adaptiveThreshWinSizeStep = step_px
        parameters.minMarkerDistanceRate = MIN_QUAD_DISTANCE
        self._detector = cv2.aruco.ArucoDetector(dictionaries, parameters)

    def find(self, pixels: Pixels, known: Array) -> Quads:
        """Find the quadrilaterals in a grey image (height, width), given the corners (k, 4, 2) of its known markers."""
        corners, _ids, rejected, families = self._detector.detectMarkersMultiDict(pixels)
        family = np.zeros(0, dtype=int) if families is None else np.ravel(families).astype(int)
        decoded = _array(corners)
        return Quads(decoded, family, ~within(decoded, known), _array(rejected))


def within(squares: Array, others: Array) -> Mask:
    """Find which squares (n, 4, 2) have their centre inside one of the others (m, 4, 2): a mask (n,)."""
    outlines = others.astype(np.float32)
    centres = squares.mean(axis=1)
    inside = [
        any(cv2.pointPolygonTest(quad, (float(x), float(y)), False) >= 0 for quad in outlines) for x, y in centres
    ]
    return np.array(inside, dtype=bool)


def inner_squares(pixels: Pixels, squares: Array) -> Array:
    """Find the darker square inside each square (n, 4, 2), such as a marker on its paper: (up to n, 4, 2)."""
    inner_ones = [inner for square in squares if (inner := _inner_square(pixels, square)) is not None]
    return np.array(inner_ones).reshape(-1, 4, 2)


def rimmed_squares(pixels: Pixels, quads: Quads) -> Array:
    """Choose the rejected squares with a black rim, the largest first, at most `MAX_REJECTED_READ`: (n, 4, 2).

    Squares inside a decoded marker are left out: they are its cells.
    """
    free = quads.rejected[~within(quads.rejected, quads.decoded)]
    rimmed = free[_has_black_rim(pixels, free)] if len(free) else free
    largest: Array = rimmed[np.argsort([-cv2.contourArea(quad.astype(np.float32)) for quad in rimmed])]
    return largest[:MAX_REJECTED_READ]


def _searched(family: Family, ids: Collection[int]) -> Any:
    """Make the OpenCV dictionary to search: a large family's wanted ids only, as more codes give false markers."""
    return family.only(ids) if ids and len(family.codes) > SMALL_FAMILY else family.dictionary


def _array(corners: object) -> Array:
    return np.asarray(corners, dtype=np.float64).reshape(-1, 4, 2)


def _inner_square(pixels: Pixels, corners_px: Array) -> Array | None:
    """Find the darker square that a square (4, 2) encloses: (4, 2), clockwise; None where there is none."""
    left, top, width, height = cv2.boundingRect(corners_px.astype(np.float32))
    left, top, right, bottom = max(left, 0), max(top, 0), left + width, top + height
    window = pixels[top:bottom, left:right]
    inside = np.zeros(window.shape, dtype=np.uint8)
    outline = np.round(corners_px - (left, top)).astype(np.int32)
    cv2.fillConvexPoly(inside, outline, 1)
    cv2.polylines(inside, [outline], True, 0, 2 * OUTLINE_PX + 1)
    levels = np.ascontiguousarray(window[inside > 0])
    middle = cv2.threshold(levels[None], 0, 255, cv2.THRESH_OTSU)[0] if levels.size else 0.0
    dark = ((window <= middle) & (inside > 0)).astype(np.uint8)
    outlines, _ = cv2.findContours(dark, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    if not outlines:
        return None
    hull = cv2.convexHull(max(outlines, key=cv2.contourArea))
    polygon = cv2.approxPolyDP(hull, POLYGON_TOLERANCE * cv2.arcLength(hull, True), True)
    if len(polygon) != 4:
        return None
    square: Array = polygon[:, 0].astype(np.float64) + np.array([left, top])
    return square if cv2.contourArea(polygon, oriented=True) > 0 else square[::-1]


def _has_black_rim(pixels: Pixels, corners_px: Array) -> Mask:
    """Find which squares (n, 4, 2) are darker just inside than just outside, on at least three sides: a mask (n,).

    Rough corners may miss a side of a small square by as much as the black border is wide.
    """
    outside, inside = (np.concatenate([_along_sides(at), _along_sides(1 - at)]) for at in (-RIM_OFFSET, RIM_OFFSET))
    levels = sample_squares(pixels, corners_px, np.concatenate([outside, inside]))
    rise = levels[:, : len(outside)] - levels[:, len(outside) :]
    sides = np.median(rise.reshape(len(corners_px), 4, RIM_SAMPLES), axis=2)
    return np.asarray(np.sort(sides, axis=1)[:, 1] > MIN_CONTRAST)


def _along_sides(offset: float) -> Array:
    """Points (2 RIM_SAMPLES, 2) of the unit square along y = offset, then along x = offset."""
    along = np.linspace(*RIM_EXTENT, RIM_SAMPLES)
    level = np.full_like(along, offset)
    return np.concatenate([np.stack([along, level], axis=1), np.stack([level, along], axis=1)])
