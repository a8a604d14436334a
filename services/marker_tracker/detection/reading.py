"""What the cells of a square show, once its corners are known exactly."""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.families import Cells
from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]

POINTS = 3
"""Along each cell; what is read is their mean."""
MIDDLE = 0.6
"""Part of a cell in which they lie: its rim is blurred."""
RIM = 0.1
"""Distance from a side, in parts of it, at which a black square on white is black and white."""
RIM_POINTS = 8
LEAST_CONTRAST = 10.0
SHADOWED = 0.25
"""Where cells are parted when a shadow lies on some of them: white is darker there than the middle."""
STRAIGHT = 0.03
"""How far a square's outline may leave its sides, in parts of its length: OpenCV's own."""


def read(pixels: Pixels, corners_px: Array, cells: int) -> Cells:
    """Read the cells of squares (n, 4, 2) with their border: (n, cells + 2, cells + 2), True where white."""
    return white(sampled(pixels, corners_px, cells))


def sampled(pixels: Pixels, corners_px: Array, cells: int) -> Array:
    """Sample the grey levels of squares (n, 4, 2) with their border: (n, cells + 2, POINTS, cells + 2, POINTS)."""
    across = cells + 2
    return levels_at(pixels, corners_px, _grid(across)).reshape(-1, across, POINTS, across, POINTS)


def white(levels: Array, part: float = 0.5) -> Cells:
    """Part cells between their border's median and the mean of the bright ones: levels as of `sampled`.

    Returns:
        (n, across, across), True where white.
    """
    levels = levels.sum(axis=(2, 4))
    rim = (levels[:, 0], levels[:, -1], levels[:, 1:-1, 0], levels[:, 1:-1, -1])
    border = np.sort(np.concatenate(rim, axis=1), axis=1)
    dark = border[:, border.shape[1] // 2, None, None]
    bright = levels > (levels.min(axis=(1, 2), keepdims=True) + levels.max(axis=(1, 2), keepdims=True)) / 2
    count = np.maximum(bright.sum(axis=(1, 2), keepdims=True), 1)
    light = np.maximum((levels * bright).sum(axis=(1, 2), keepdims=True) / count, dark)
    return np.asarray(levels > dark + part * (light - dark))


@cache
def _grid(across: int) -> Array:
    """Points of the unit square that are read: `POINTS` x `POINTS` for each cell, row by row."""
    ticks = np.arange(across)[:, None] + 0.5 + np.linspace(-MIDDLE / 2, MIDDLE / 2, POINTS)
    unit = ticks.ravel() / across
    return np.stack(np.meshgrid(unit, unit), axis=-1).reshape(-1, 2)


def likeness(levels: Array, shown: Cells) -> Array:
    """Correlate grey levels as of `sampled` with what they are to show (n, across, across): (n,), -1 to 1."""
    mean = levels.mean(axis=(2, 4))
    light, middle = shown.mean(axis=(1, 2)), mean.mean(axis=(1, 2))
    common = (mean * shown).mean(axis=(1, 2)) - light * middle
    spread = np.einsum("nikjl,nikjl->n", levels, levels) / levels[0].size - middle**2
    alike: Array = common / np.sqrt(np.maximum(spread * light * (1 - light), 1e-9))
    return alike


def dark_square(pixels: Pixels, corners_px: Array) -> Array | None:
    """Find the darker square that a square (4, 2) encloses, a marker on its paper: (4, 2), clockwise."""
    left, top, width, height = cv2.boundingRect(corners_px.astype(np.float32))
    left, top, right, bottom = max(left, 0), max(top, 0), left + width, top + height
    window = pixels[top:bottom, left:right]
    inside = np.zeros(window.shape, dtype=np.uint8)
    cv2.fillConvexPoly(inside, np.round(corners_px - (left, top)).astype(np.int32), 1)
    levels = np.ascontiguousarray(window[inside > 0])
    middle = cv2.threshold(levels[None], 0, 255, cv2.THRESH_OTSU)[0] if levels.size else 0.0
    dark = ((window <= middle) & (inside > 0)).astype(np.uint8)
    outlines, _ = cv2.findContours(dark, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    if not outlines:
        return None
    hull = cv2.convexHull(max(outlines, key=cv2.contourArea))
    found = cv2.approxPolyDP(hull, STRAIGHT * cv2.arcLength(hull, True), True)
    if len(found) != 4:
        return None
    square: Array = found[:, 0].astype(np.float64) + np.array([left, top])
    return square if cv2.contourArea(found, oriented=True) > 0 else square[::-1]


def border_wrong(shown: Cells) -> int:
    """Count the white cells of the border."""
    return int(shown.sum() - shown[1:-1, 1:-1].sum())


def has_black_rim(pixels: Pixels, corners_px: Array) -> NDArray[np.bool_]:
    """Tell which squares (n, 4, 2) are darker just inside than just outside, at all of their sides but one.

    Rough corners may miss a side of a small square by as much as the black border is wide.
    """
    along = np.linspace(0.15, 0.85, RIM_POINTS)
    outside, inside = (np.concatenate([_side(along, depth), _side(along, 1 - depth)]) for depth in (-RIM, RIM))
    levels = levels_at(pixels, corners_px, np.concatenate([outside, inside]))
    rise = levels[:, : len(outside)] - levels[:, len(outside) :]
    sides = np.median(rise.reshape(len(corners_px), 4, RIM_POINTS), axis=2)
    return np.asarray(np.sort(sides, axis=1)[:, 1] > LEAST_CONTRAST)


def _side(along: Array, depth: float) -> Array:
    """Points at a depth from one horizontal and one vertical side of the unit square."""
    level = np.full_like(along, depth)
    return np.concatenate([np.stack([along, level], axis=1), np.stack([level, along], axis=1)])


def levels_at(pixels: Pixels, corners_px: Array, unit: Array) -> Array:
    """Sample grey levels (n, points) at points of the unit square, laid by perspective on squares (n, 4, 2)."""
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
    image_from_unit = np.array([cv2.getPerspectiveTransform(square, quad.astype(np.float32)) for quad in corners_px])
    by_column = np.swapaxes(image_from_unit.reshape(-1, 3, 3), 1, 2)
    mapped = unit @ by_column[:, :2] + by_column[:, 2:]
    points = (mapped[..., :2] / mapped[..., 2:]).astype(np.float32)
    sampled = cv2.remap(pixels, points[..., 0], points[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, dtype=np.float64)
