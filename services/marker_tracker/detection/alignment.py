"""Photometric alignment: refine the corners of small markers by fitting their known pattern to the grey levels.

A small marker's sides are too short and its cells too narrow to locate edges one by one, and a finger across an edge
would shift the located edge.
"""

import math
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np

from actum.arrays import Array, Mask, Pixels
from marker_tracker.detection.families import Cells

SAMPLES_PER_CELL = 3
"""Along each side of a cell: the fewest samples that locate an edge within the cell."""
QUIET_ZONE_CELLS = 0.5
"""Cells of the white around the black border that are sampled, for the border's outer edge."""
MAX_ITERATIONS = 3
"""Gauss-Newton steps: initial corners are within a pixel, where the steps converge quadratically."""
SUFFICIENT_STEP_PX = 0.05
"""Pixels: iteration stops after a smaller step of the corners, as the next one would be below the noise."""
CONVERGED_STEP_PX = 0.15
"""Pixels: an alignment has converged if its last step of the corners is at most this."""
INITIAL_BLUR_PX = 0.8
"""Standard deviation in pixels: a usual lens with a usual sensor."""
BLUR_RANGE_PX = np.array([0.35, 2.5])
"""Standard deviations in pixels: from the blur of a pixel's own area to one that erases small cells."""
CAUCHY_SCALE = 0.12
"""Scale of residuals, as a share of the contrast: larger ones come from what covers the marker and weigh little."""
MAX_CORNER_MOTION_PX = 1.5
"""Pixels in each axis: initial corners are off by less, so a corner that moves further has diverged."""
MIN_CONTRAST = 10.0
"""Grey levels between black and white: below it noise would be taken for cells."""
OUTLIER_WEIGHT = 0.2
"""Robust weight below which a grey level counts as covered: its residual is twice the Cauchy scale."""
RELATIVE_DAMPING = 1e-3
"""Damping of the normal matrix, as a share of its diagonal (Levenberg-Marquardt)."""
ABSOLUTE_DAMPING = 1e-3
"""Added to the diagonal, which keeps the normal matrix of a flat image invertible."""
TANH_SLOPE = math.sqrt(2 / math.pi)
"""With `TANH_CUBIC`: the normal distribution function is (1 + tanh(slope x (1 + cubic x²))) / 2 to 3e-4."""
TANH_CUBIC = 0.044715
"""See `TANH_SLOPE`."""
_UNIT_SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=np.float32)
"""Corners (4, 2) of the unit square, in the order of a marker's."""


@dataclass(frozen=True)
class Alignment:
    """Markers aligned with an image.

    Attributes:
        corners_px: (n, 4, 2), clockwise from each marker's own top left.
        covered: (n,) share of each marker, 0 to 1, whose grey levels are not of its pattern.
        photometric: (n, 3) blur (standard deviation in cells), black level and contrast (grey levels) of each.
        converged: (n,) whether the last step was small and the corners did not diverge.
    """

    corners_px: Array
    covered: Array
    photometric: Array
    converged: Mask


def align(pixels: Pixels, corners_px: Array, patterns: Cells, photometric: Array | None = None) -> Alignment:
    """Align markers of one family with a grey image (height, width) by moving each corner freely.

    Robust Gauss-Newton steps decrease sum rho(I(H u) - black - contrast T(u)) over points u of the marker, where H maps
    the unit square to the corners, T is the pattern blurred like the image, and rho is Cauchy's. Corners that move
    further than `MAX_CORNER_MOTION_PX` keep their initial values.

    Args:
        pixels: (height, width).
        corners_px: (n, 4, 2), initial corners.
        patterns: (n, across, across), the cells of each marker with its border.
        photometric: (n, 3), initial photometric parameters; by default estimated from the image.
    """
    return _align(pixels, corners_px, patterns, None, photometric)


def align_by_similarity(pixels: Pixels, corners_px: Array, patterns: Cells) -> Alignment:
    """Align as `align` does, but by shift, rotation and scale alone, which half of a marker suffices to determine."""
    around = corners_px - corners_px.mean(axis=1, keepdims=True)
    turned = np.stack([-around[..., 1], around[..., 0]], axis=-1)
    across, down = np.broadcast_to([1.0, 0.0], around.shape), np.broadcast_to([0.0, 1.0], around.shape)
    sides_px = _mean_sides_px(corners_px)[:, None, None]
    directions = np.stack([across, down, around / sides_px, turned / sides_px])
    return _align(pixels, corners_px, patterns, np.moveaxis(directions.reshape(4, -1, 8), 0, 2))


def sample_squares(pixels: Pixels, corners_px: Array, unit_points: Array) -> Array:
    """Sample grey levels (n, m) of squares (n, 4, 2) at points (m, 2) of the unit square, mapped projectively."""
    quads = corners_px.astype(np.float32)
    image_from_unit = np.array([cv2.getPerspectiveTransform(_UNIT_SQUARE, quad) for quad in quads]).reshape(-1, 3, 3)
    mapped = image_from_unit[:, :, :2] @ unit_points.T + image_from_unit[:, :, 2:]
    x, y = ((mapped[:, axis] / mapped[:, 2]).astype(np.float32) for axis in (0, 1))
    sampled = cv2.remap(pixels, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return np.asarray(sampled, dtype=np.float64)


def _align(
    pixels: Pixels, corners_px: Array, patterns: Cells, directions: Array | None, photometric: Array | None = None
) -> Alignment:
    """Align along k directions (n, 8, k): each column is a motion of the corners' coordinates x0, y0, ... y3.

    Without directions, each coordinate moves freely.
    """
    white = np.ones((len(patterns), patterns.shape[1] + 2, patterns.shape[2] + 2))
    white[:, 1:-1, 1:-1] = patterns
    initial = _initial_photometric(pixels, corners_px, white) if photometric is None else photometric
    aligned_px, photometric = corners_px.copy(), initial.copy()
    blurs = BLUR_RANGE_PX / (_mean_sides_px(corners_px) / patterns.shape[1])[:, None]
    covered, last_step_px = np.zeros(len(aligned_px)), np.full(len(aligned_px), np.inf)
    for _ in range(MAX_ITERATIONS):
        (active,) = np.nonzero(last_step_px > SUFFICIENT_STEP_PX)
        if not len(active):
            break
        along = None if directions is None else directions[active]
        step, change, weight = _step(pixels, aligned_px[active], white[active], photometric[active], along)
        aligned_px[active] += np.clip(step, -MAX_CORNER_MOTION_PX, MAX_CORNER_MOTION_PX)
        blur, black, contrast = (photometric[active] + change).T
        blur = np.clip(blur, blurs[active, 0], blurs[active, 1])
        photometric[active] = np.stack([blur, black, np.maximum(contrast, MIN_CONTRAST)], axis=1)
        covered[active], last_step_px[active] = (weight < OUTLIER_WEIGHT).mean(axis=1), np.abs(step).max(axis=(1, 2))
    diverged = np.abs(aligned_px - corners_px).max(axis=(1, 2)) > MAX_CORNER_MOTION_PX
    aligned_px[diverged] = corners_px[diverged]
    return Alignment(aligned_px, covered, photometric, (last_step_px <= CONVERGED_STEP_PX) & ~diverged)


def _mean_sides_px(corners_px: Array) -> Array:
    """Return the mean side (n,) of squares (n, 4, 2)."""
    sides: Array = np.linalg.norm(corners_px - corners_px[:, [3, 0, 1, 2]], axis=2).mean(axis=1)
    return sides


def _initial_photometric(pixels: Pixels, corners_px: Array, white: Array) -> Array:
    """Estimate blur, black level and contrast (n, 3) by the medians where the pattern is darkest and lightest."""
    across = white.shape[1] - 2
    blur = INITIAL_BLUR_PX / (_mean_sides_px(corners_px) / across)
    levels, blurred = sample_squares(pixels, corners_px, _sample_points(across)), _blurred(white, blur, across)[0]
    darkest, lightest = np.quantile(blurred, (0.25, 0.75), axis=1, keepdims=True)
    dark, light = _medians(levels, blurred <= darkest), _medians(levels, blurred >= lightest)
    return np.stack([blur, dark, np.maximum(light - dark, MIN_CONTRAST)], axis=1)


def _medians(levels: Array, chosen: Mask) -> Array:
    """Return the median (n,) of each row's chosen levels (n, m); every row has at least one."""
    ordered, count = np.sort(np.where(chosen, levels, np.inf), axis=1), np.count_nonzero(chosen, axis=1)
    rows = np.arange(len(ordered))
    medians: Array = (ordered[rows, (count - 1) // 2] + ordered[rows, count // 2]) / 2
    return medians


def _step(
    pixels: Pixels, corners_px: Array, white: Array, photometric: Array, directions: Array | None
) -> tuple[Array, Array, Array]:
    """Take one Gauss-Newton step.

    Returns:
        The steps of the corners (n, 4, 2) in px and of the photometric parameters (n, 3), and the weight of each grey
        level (n, m).
    """
    across = white.shape[1] - 2
    blur, black, contrast = photometric.T[:, :, None]
    levels = sample_squares(pixels, corners_px, _sample_points(across))
    blurred, slopes, by_blur = _blurred(white, blur[:, 0], across)
    residual = levels - black - contrast * blurred
    weight = 1 / (1 + (residual / (CAUCHY_SCALE * contrast)) ** 2)
    jacobian = np.empty((len(levels), 8 + 3, levels.shape[1]))
    by_corner = jacobian[:, :-3].reshape(len(levels), 4, 2, -1)
    np.multiply(_corner_weights(across)[:, None], _gradient(corners_px, contrast, slopes)[:, None], out=by_corner)
    jacobian[:, -3], jacobian[:, -2], jacobian[:, -1] = -contrast * by_blur, -1.0, -blurred
    if directions is not None:
        jacobian = np.concatenate([np.swapaxes(directions, 1, 2) @ jacobian[:, :-3], jacobian[:, -3:]], axis=1)
    step = _solved(jacobian, weight, residual)
    corners = step[:, :-3] if directions is None else directions @ step[:, :-3]
    return corners.reshape(-1, 4, 2), step[:, -3:, 0], weight


def _gradient(corners_px: Array, contrast: Array, slopes: Array) -> Array:
    """Return how grey levels change with a motion of the marker (n, 2, m), in grey levels per px."""
    first, second, third, fourth = np.moveaxis(corners_px, 1, 0)
    right, down = (second - first + third - fourth) / 2, (fourth - first + third - second) / 2
    image_from_unit = np.stack([right, down], axis=1)
    per_px: Array = np.linalg.inv(image_from_unit) @ slopes
    return contrast[..., None] * per_px


def _solved(jacobian: Array, weight: Array, residual: Array) -> Array:
    """Solve the damped normal equations for a step (n, k, 1); jacobian (n, k, m), weights and residuals (n, m)."""
    weighted = jacobian * weight[:, None]
    normal = weighted @ np.swapaxes(jacobian, 1, 2)
    diagonal = np.einsum("nii->ni", normal)
    diagonal += RELATIVE_DAMPING * diagonal + ABSOLUTE_DAMPING
    return np.asarray(-np.linalg.solve(normal, weighted @ residual[..., None]), dtype=np.float64)


@cache
def _sample_points(across: int) -> Array:
    """Points (m, 2) of the unit square and of the white around it, row by row."""
    ticks = _ticks(across) / across
    return np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)


def _ticks(across: int) -> Array:
    """Sampled positions along a side, in cells from the border's outer edge."""
    count = round((across + 2 * QUIET_ZONE_CELLS) * SAMPLES_PER_CELL)
    return (np.arange(count) + 0.5) / SAMPLES_PER_CELL - QUIET_ZONE_CELLS


@cache
def _corner_weights(across: int) -> Array:
    """Bilinear weights (4, m) of the corners at the sampled points."""
    u, v = _sample_points(across).T
    return np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v])


def _blurred(white: Array, blur: Array, across: int) -> tuple[Array, Array, Array]:
    """Blur patterns (n, across + 2, across + 2), with a ring of white, by Gaussians of deviation (n,) in cells.

    Returns:
        T (n, m) at the sampled points, its gradient (n, 2, m) along the unit square's sides, and its derivative (n, m)
        with respect to the blur.
    """
    x = (_ticks(across)[:, None] - np.arange(-1, across + 2))[None] / blur[:, None, None]
    squared = x * x
    below = np.tanh(TANH_SLOPE * x * (1 + TANH_CUBIC * squared)) / 2
    density = (1 - 4 * below**2) / 2 * TANH_SLOPE * (1 + 3 * TANH_CUBIC * squared)
    cells = below[..., :-1] - below[..., 1:]
    steep = (density[..., :-1] - density[..., 1:]) / blur[:, None, None]
    moment = x * density
    wider = (moment[..., 1:] - moment[..., :-1]) / blur[:, None, None]
    turned = [np.swapaxes(part, 1, 2) for part in (cells, steep, wider)]
    rows = cells @ white
    flat = (len(white), -1)
    blurred, along, by_blur = (rows @ part for part in turned)
    down = steep @ white @ turned[0]
    by_blur = by_blur + wider @ white @ turned[0]
    slopes = across * np.stack([along.reshape(flat), down.reshape(flat)], axis=1)
    return blurred.reshape(flat), slopes, by_blur.reshape(flat)
