"""Corners of small markers by all of their pattern: the image of a known code is laid on the grey levels.

A small marker's sides are too short, and its cells too narrow, for edges to be found each by itself; a finger on one
of them would pull it along.
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.families import Cells
from marker_tracker.detection.images import Pixels
from marker_tracker.detection.reading import levels_at

Array = NDArray[np.float64]

SMALL_CELL_PX = 6.5
"""Cells up to this size are aligned; the sides of larger ones are known well enough."""
POINTS = 3
"""Grey levels along each cell."""
QUIET = 0.5
"""How many cells of the white around the black border are taken in."""
ITERATIONS = 3
ENOUGH_PX, SETTLED_PX = 0.05, 0.15
"""A step of the corners after which the next would be lost in noise, and one that shows that nothing runs away."""
START_BLUR_PX = 0.8
BLUR_PX = np.array([0.35, 2.5])
OUTLYING = 0.12
"""Residuals in parts of the contrast from which on a grey level counts little: what covers the marker is no pattern."""
FURTHEST_PX = 1.5
LEAST_CONTRAST = 10.0
NOT_OF_IT = 0.2
"""Weight below which a grey level is none of the pattern's."""
DAMPING, LEAST = 1e-3, 1e-3
SLOPE, CURVE = math.sqrt(2 / math.pi), 0.044715


@dataclass(frozen=True)
class Aligned:
    """Corners (n, 4, 2), and which part (n,) of each marker is covered: its grey levels are not of the pattern.

    `looks` (n, 3) are each one's blur in cells, black and contrast; `settled` (n,) tells which have come to rest.
    """

    corners_px: Array
    covered: Array
    looks: Array
    settled: NDArray[np.bool_]


def aligned(pixels: Pixels, corners_px: Array, shown: Cells, looks: Array | None = None) -> Aligned:
    """Align one family's markers with what they show, border and all (n, across, across), True where white.

    With corners (n, 4, 2) clockwise, blur, black and contrast as parameters, sum rho(I(H u) - black - contrast T(u))
    over points u of the marker is made small by Gauss-Newton steps, where T is the pattern blurred as the image is and
    rho Cauchy's. What runs further than `FURTHEST_PX` stays as it is. The looks (n, 3) of another image are a start.
    """
    moves = np.broadcast_to(np.eye(8), (len(corners_px), 8, 8))
    return _aligned(pixels, corners_px, _on_white(shown), moves, looks)


def aligned_alike(pixels: Pixels, corners_px: Array, shown: Cells) -> Aligned:
    """Align as `aligned` does, but by shift, turn and size alone, by which what is half covered is known better."""
    around = corners_px - corners_px.mean(axis=1, keepdims=True)
    turned = np.stack([-around[..., 1], around[..., 0]], axis=-1)
    across, down = np.broadcast_to([1.0, 0.0], around.shape), np.broadcast_to([0.0, 1.0], around.shape)
    moves = np.stack(
        [across, down, around / _sides(corners_px)[:, None, None], turned / _sides(corners_px)[:, None, None]]
    )
    return _aligned(pixels, corners_px, _on_white(shown), np.moveaxis(moves.reshape(4, -1, 8), 0, 2))


def is_small(corners_px: Array, across: int) -> NDArray[np.bool_]:
    """Tell which squares (n, 4, 2) have cells so small that they are to be aligned."""
    small: NDArray[np.bool_] = _sides(corners_px) <= SMALL_CELL_PX * across
    return small


def _aligned(pixels: Pixels, corners_px: Array, white: Array, moves: Array, looks: Array | None = None) -> Aligned:
    """Align by a number of moves: each (8,) is how the corners go, (n, 8, moves)."""
    found, looks = corners_px.copy(), _first_look(pixels, corners_px, white) if looks is None else looks.copy()
    blurs = BLUR_PX / (_sides(corners_px) / (white.shape[1] - 2))[:, None]
    covered, stepped_px = np.zeros(len(found)), np.full(len(found), np.inf)
    for _ in range(ITERATIONS):
        (on,) = np.nonzero(stepped_px > ENOUGH_PX)
        if not len(on):
            break
        step, change, weight = _step(pixels, found[on], white[on], looks[on], moves[on])
        found[on] += np.clip(step, -FURTHEST_PX, FURTHEST_PX)
        looks[on] = _possible(looks[on] + change, blurs[on])
        covered[on], stepped_px[on] = (weight < NOT_OF_IT).mean(axis=1), np.abs(step).max(axis=(1, 2))
    ran = np.abs(found - corners_px).max(axis=(1, 2)) > FURTHEST_PX
    found[ran] = corners_px[ran]
    return Aligned(found, covered, looks, (stepped_px <= SETTLED_PX) & ~ran)


def _on_white(shown: Cells) -> Array:
    return np.pad(shown, ((0, 0), (1, 1), (1, 1)), constant_values=True).astype(np.float64)


def _possible(looks: Array, blurs: Array) -> Array:
    looks[:, 0] = np.clip(looks[:, 0], blurs[:, 0], blurs[:, 1])
    looks[:, 2] = np.maximum(looks[:, 2], LEAST_CONTRAST)
    return looks


def _sides(corners: Array) -> Array:
    sides: Array = np.linalg.norm(corners - corners[:, [3, 0, 1, 2]], axis=2).mean(axis=1)
    return sides


def _first_look(pixels: Pixels, corners: Array, white: Array) -> Array:
    """Guess blur in cells, black and contrast (n, 3), by the medians where it is to be darkest and lightest."""
    across = white.shape[1] - 2
    blur = START_BLUR_PX / (_sides(corners) / across)
    levels, pattern = levels_at(pixels, corners, _grid(across)), _pattern(white, blur, across)[0]
    darkest, lightest = np.quantile(pattern, (0.25, 0.75), axis=1, keepdims=True)
    dark, light = _medians(levels, pattern <= darkest), _medians(levels, pattern >= lightest)
    return np.stack([blur, dark, np.maximum(light - dark, LEAST_CONTRAST)], axis=1)


def _medians(levels: Array, chosen: NDArray[np.bool_]) -> Array:
    """Return the median of each row's chosen levels (n, m): (n,); there is one in every row."""
    ordered, count = np.sort(np.where(chosen, levels, np.inf), axis=1), np.count_nonzero(chosen, axis=1)
    rows = np.arange(len(ordered))
    medians: Array = (ordered[rows, (count - 1) // 2] + ordered[rows, count // 2]) / 2
    return medians


def _step(pixels: Pixels, corners: Array, white: Array, look: Array, moves: Array) -> tuple[Array, Array, Array]:
    """Take one Gauss-Newton step: (n, 4, 2) of the corners in px, (n, 3) of the look; and weigh the levels (n, m)."""
    across = white.shape[1] - 2
    blur, black, contrast = look.T[:, :, None]
    levels = levels_at(pixels, corners, _grid(across))
    pattern, slopes, by_blur = _pattern(white, blur[:, 0], across)
    residual = levels - black - contrast * pattern
    weight = 1 / (1 + (residual / (OUTLYING * contrast)) ** 2)
    jacobian = np.empty((len(levels), moves.shape[2] + 3, levels.shape[1]))
    by_corner = _by_corner(contrast[..., None] * _in_image(slopes, corners), across)
    np.matmul(np.swapaxes(moves, 1, 2), by_corner, out=jacobian[:, :-3])
    jacobian[:, -3], jacobian[:, -2], jacobian[:, -1] = -contrast * by_blur, -1.0, -pattern
    weighted = jacobian * weight[:, None]
    normal = weighted @ np.swapaxes(jacobian, 1, 2)
    normal += np.eye(normal.shape[1]) * (DAMPING * np.einsum("nii->ni", normal) + LEAST)[:, None, :]
    step = -np.linalg.solve(normal, weighted @ residual[..., None])
    return (moves @ step[:, :-3]).reshape(-1, 4, 2), step[:, -3:, 0], weight


def _by_corner(gradient: Array, across: int) -> Array:
    """Return how the grey levels change with each corner's x and y (n, 8, m) by how they change in the image."""
    by_corner: Array = _shares(across)[:, None] * gradient[:, None]
    return by_corner.reshape(len(gradient), 8, -1)


@cache
def _grid(across: int) -> Array:
    """Points (m, 2) of the unit square and a little beyond, row by row."""
    ticks = _ticks(across) / across
    return np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)


def _ticks(across: int) -> Array:
    count = round((across + 2 * QUIET) * POINTS)
    return (np.arange(count) + 0.5) / POINTS - QUIET


@cache
def _shares(across: int) -> Array:
    """How much each corner (4) moves each point (m): bilinearly."""
    u, v = _grid(across).T
    return np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])


def _pattern(white: Array, blur: Array, across: int) -> tuple[Array, Array, Array]:
    """Blur the cells: (n, m) at each point, its slopes (n, 2, m) along the unit square's sides, and by the blur."""
    x = (_ticks(across)[:, None] - np.arange(-1, across + 2))[None] / blur[:, None, None]
    squared = x * x
    below = np.tanh(SLOPE * x * (1 + CURVE * squared)) / 2
    density = (1 - 4 * below**2) / 2 * SLOPE * (1 + 3 * CURVE * squared)
    cells = below[..., :-1] - below[..., 1:]
    steep = (density[..., :-1] - density[..., 1:]) / blur[:, None, None]
    moment = x * density
    wider = (moment[..., 1:] - moment[..., :-1]) / blur[:, None, None]
    turned = [np.swapaxes(part, 1, 2) for part in (cells, steep, wider)]
    rows = cells @ white
    flat = (len(white), -1)
    pattern, along, by_blur = (rows @ part for part in turned)
    down = steep @ white @ turned[0]
    by_blur = by_blur + wider @ white @ turned[0]
    slopes = across * np.stack([along.reshape(flat), down.reshape(flat)], axis=1)
    return pattern.reshape(flat), slopes, by_blur.reshape(flat)


def _in_image(slopes: Array, corners: Array) -> Array:
    """Turn slopes along the unit square's sides into slopes per pixel (n, 2, m)."""
    first, second, third, fourth = np.moveaxis(corners, 1, 0)
    right, down = (second - first + third - fourth) / 2, (fourth - first + third - second) / 2
    image_from_unit = np.stack([right, down], axis=1)
    per_px: Array = np.linalg.inv(image_from_unit) @ slopes
    return per_px
