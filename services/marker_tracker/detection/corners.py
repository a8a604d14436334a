"""Sub-pixel refinement of the corners of black squares.

Corners of small squares are the intersections of lines fitted to the four sides, which are unbiased. Corners of large
squares come from the gradients around them (OpenCV's `cornerSubPix`), since lens and paper bend long sides by more than
its bias.
"""

import cv2
import numpy as np

from actum.arrays import Array, Pixels

NEXT = [1, 2, 3, 0]
"""For each corner, the index of the next one, clockwise: side i runs from corner i to corner `NEXT[i]`."""
PREVIOUS = [3, 0, 1, 2]
"""For each side, the index of the previous one, which ends where the side begins."""
PROFILES = 16
"""Intensity profiles across each side: a line fitted to 16 edge points has about a quarter of the error of one."""
PROFILE_SAMPLES = 9
"""Grey levels of a profile, from inside to outside: about one per pixel of the longest."""
ALONG_SIDE = np.linspace(-1, 1, PROFILES)
"""Positions of the profiles along a side, -1 at its first and 1 at its last margin."""
ACROSS_SIDE = np.linspace(-1, 1, PROFILE_SAMPLES)
"""Positions of the samples in a profile, as shares of its half length, from inside to outside."""
MARGIN_PX = 2.0
"""Pixels left out at both ends of a side: the blur of the neighbouring sides reaches that far."""
MAX_MARGIN_SHARE = 0.2
"""Largest share of a side left out at each end: short sides keep three fifths."""
SMALLEST_CELLS = 8
"""Cells along a side of a 6x6 marker with its border: a profile reaches half a cell to either side of the edge."""
MIN_REACH_PX = 1.5
"""Smallest half length of a profile, in pixels: the blur of an edge."""
MAX_REACH_PX = 4.0
"""Largest half length of a profile, in pixels: rough corners are off by less."""
FITS_PER_ROUND = (1, 1, 2)
"""Line fits in each round. Each round centres the profiles on the lines of the previous one; the last fit is robust."""
EDGE_NOISE_PX = 0.15
"""Standard deviation in pixels of the edge in one profile; edges much further from the line weigh little."""
BOW_PER_PX = 1e-5
"""Prior standard deviation of a side's bow c2 over its squared length, in 1/pixel: lenses bend long sides only."""
MAX_CONTRAST_WEIGHT = 64.0
"""Grey levels of contrast beyond which an edge is located no better, so that its weight grows no further."""
MIN_MOTION_PX = 2.0
"""Pixels by which any corner may move: the error of rough initial corners."""
MAX_MOTION_SHARE = 0.2
"""Share of the shortest side by which a corner may move, if that is more; beyond it the fit has diverged."""
EDGES_ONLY_PX = 140.0
"""Shortest side in pixels up to which only the fitted lines are used."""
GRADIENTS_ONLY_PX = 180.0
"""Shortest side in pixels from which only gradients are used: their bias is below 0.2 pixels. Blended in between."""
GRADIENT_WINDOW_PX = 5
"""Half the width in pixels of the window around a corner: within the border of a large marker."""
MAX_DISAGREEMENT_PX = 1.0
"""Pixels between the corners of both methods: further apart, the gradients belong to something else."""
GRADIENT_STOP = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 0.01)
"""Iterations and pixels at which `cornerSubPix` stops: a tenth of the accuracy wanted."""
SINGULAR = 1e-6
"""Sine of the angle below which two sides are parallel, and pixels below which one has no length."""
_RIDGE_3 = 1e-6 * np.eye(3)
"""Added to the normal matrix (3, 3), which stays invertible where no profile has an edge."""


def refine(pixels: Pixels, corners_px: Array) -> Array:
    """Refine the corners of black squares on white; squares whose corners would diverge stay as they are.

    Args:
        pixels: grey image (height, width).
        corners_px: (n, 4, 2), clockwise; the result has the same shape.
    """
    if not len(corners_px):
        return corners_px
    allowed = np.maximum(MIN_MOTION_PX, MAX_MOTION_SHARE * _sides_px(corners_px).min(axis=1))[:, None, None]
    refined = corners_px
    for fits in FITS_PER_ROUND:
        moved = _by_edges(pixels, refined, fits)
        plausible = (np.abs(moved - corners_px) <= allowed).all(axis=(1, 2), keepdims=True)
        refined = np.where(plausible, moved, refined)
    return _by_gradients_if_large(pixels, refined)


def _by_gradients_if_large(pixels: Pixels, corners: Array) -> Array:
    shortest = _sides_px(corners).min(axis=1)
    share = np.clip((shortest - EDGES_ONLY_PX) / (GRADIENTS_ONLY_PX - EDGES_ONLY_PX), 0.0, 1.0)
    limits = np.array(pixels.shape[::-1]) - 1
    large = (share > 0) & ((corners >= 0) & (corners <= limits)).all(axis=(1, 2))
    if not large.any():
        return corners
    start = corners[large].reshape(-1, 1, 2).astype(np.float32)
    window = (GRADIENT_WINDOW_PX, GRADIENT_WINDOW_PX)
    local = cv2.cornerSubPix(pixels, start, window, (-1, -1), GRADIENT_STOP).reshape(-1, 4, 2)
    step = local.astype(np.float64) - corners[large]
    agrees = np.linalg.norm(step, axis=2, keepdims=True) < MAX_DISAGREEMENT_PX
    moved = corners.copy()
    moved[large] += np.where(agrees, step, 0.0) * share[large, None, None]
    return moved


def _by_edges(pixels: Pixels, corners: Array, fits: int) -> Array:
    """Fit each side by t(s) = c0 + c1 s + c2 s², s from -1 to 1 along it, t outwards; intersect the end tangents.

    In each profile across a side, the edge is the centroid of the squared rise from inside to outside, weighted by
    contrast.
    """
    length = np.maximum(_sides_px(corners), SINGULAR)
    along = (corners[:, NEXT] - corners) / length[..., None]
    outward = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    inner = 1 - 2 * np.minimum(MAX_MARGIN_SHARE, MARGIN_PX / length)
    s = inner[..., None] * ALONG_SIDE
    middle = (corners[:, NEXT] + corners) / 2
    centres = middle[:, :, None] + (s * length[..., None] / 2)[..., None] * along[:, :, None]
    half_length = np.clip(length / SMALLEST_CELLS / 2, MIN_REACH_PX, MAX_REACH_PX)
    t = half_length[..., None] * ACROSS_SIDE
    x, y = (
        (centres[..., axis, None] + (t * outward[..., axis, None])[:, :, None]).astype(np.float32) for axis in (0, 1)
    )
    flat = (-1, PROFILE_SAMPLES)
    sampled = cv2.remap(pixels, x.reshape(flat), y.reshape(flat), cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    levels = sampled.astype(np.float64).reshape(x.shape)
    rise = np.maximum(levels[..., 1:] - levels[..., :-1], 0.0) ** 2
    between = (t[..., 1:] + t[..., :-1]) / 2
    moment, total = np.moveaxis(rise @ np.stack([between, np.ones_like(between)], axis=-1), -1, 0)
    offset = moment / np.maximum(total, 1e-9)
    contrast = levels[..., -1] - levels[..., 0]
    weight = np.where(contrast > 0, np.minimum(contrast, MAX_CONTRAST_WEIGHT), 0.0)
    fitted = _fitted(s, offset, weight, length, fits)
    return _intersections(middle, along, outward, length, fitted)


def _fitted(s: Array, offset: Array, weight: Array, length: Array, fits: int) -> Array:
    """Fit c (n, 4, 3) by weighted least squares, the bow c2 held near 0; later fits weigh outliers down (Cauchy)."""
    powers_and_offset = np.stack([np.ones_like(s), s, s * s, offset], axis=-1)
    powers = powers_and_offset[..., :3]
    prior = np.zeros((*length.shape, 3, 3))
    prior[..., 2, 2] = (EDGE_NOISE_PX / (BOW_PER_PX * length**2)) ** 2
    prior += _RIDGE_3
    relative = weight / np.maximum(weight.mean(axis=-1, keepdims=True), 1e-9)
    fitted = _least_squares(powers_and_offset, relative, prior)
    for _ in range(fits - 1):
        residual = offset - (powers @ fitted[..., None])[..., 0]
        robust = relative / (1 + (residual / (2 * EDGE_NOISE_PX)) ** 2)
        fitted = _least_squares(powers_and_offset, robust, prior)
    return fitted


def _least_squares(powers_and_offset: Array, weight: Array, prior: Array) -> Array:
    """Solve for c (n, 4, 3) from profiles (n, 4, k, 4), each with a weight (n, 4, k)."""
    weighted = powers_and_offset[..., :3] * weight[..., None]
    sums = np.swapaxes(weighted, -1, -2) @ powers_and_offset
    return np.asarray(np.linalg.solve(sums[..., :3] + prior, sums[..., 3:])[..., 0], dtype=np.float64)


def _intersections(middle: Array, along: Array, outward: Array, length: Array, fitted: Array) -> Array:
    """Intersect each side's tangent at its start with the previous side's tangent at its end: (n, 4, 2)."""
    half = length[..., None] / 2
    first, last = (
        (
            middle + sign * half * along + (fitted @ [1, sign, 1])[..., None] * outward,
            along + ((fitted @ [0, 1, 2 * sign]) / half[..., 0])[..., None] * outward,
        )
        for sign in (-1, 1)
    )
    point, direction = first
    previous_point, previous_direction = (part[:, PREVIOUS] for part in last)
    cross = direction[..., 0] * previous_direction[..., 1] - direction[..., 1] * previous_direction[..., 0]
    gap = previous_point - point
    distance = (gap[..., 0] * previous_direction[..., 1] - gap[..., 1] * previous_direction[..., 0]) / np.where(
        np.abs(cross) < SINGULAR, np.nan, cross
    )
    corners: Array = point + distance[..., None] * direction
    return corners


def _sides_px(corners: Array) -> Array:
    """Return the length of each side, (n, 4), of squares (n, 4, 2)."""
    sides: Array = np.sqrt(((corners[:, NEXT] - corners) ** 2).sum(axis=2))
    return sides
