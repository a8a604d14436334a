"""Corners of black squares to a fraction of a pixel.

Small squares: the crossings of lines fitted to the four edges, which have no bias. Large ones: where the grey levels'
gradients around each corner meet, for lens and paper bend long sides by more than that method's bias.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from marker_tracker.detection.images import Pixels

Array = NDArray[np.float64]

NEXT, BEFORE = [1, 2, 3, 0], [3, 0, 1, 2]
SAMPLES = 16
"""Profiles across each side."""
STEPS = 9
"""Grey levels of a profile, from inside to outside."""
ALONG, ACROSS = np.linspace(-1, 1, SAMPLES), np.linspace(-1, 1, STEPS)
MARGIN_PX, MARGIN = 2.0, 0.2
"""Left out at both ends of a side, in pixels and at most in parts of its length: there the next side blurs in."""
CELLS = 8
"""Cells along a side where they are smallest: the black border is one cell wide."""
REACH_PX = (1.5, 4.0)
"""Least and greatest reach of a profile to either side; half a cell between them."""
FITS = (1, 1, 2)
"""Profiles are centred anew on the edge found before, so many times; then lines are fitted, the last time robustly."""
NOISE_PX = 0.15
"""Of the edge in one profile; what lies much further from the fitted line counts little."""
BOW_PER_PX = 1e-5
"""Standard deviation of a side's bow, in parts of its squared length: lenses bend long sides, and no short ones."""
FURTHEST = 0.2
"""How far a corner may move, in parts of the shortest side and at least 2 pixels; beyond it the fit has diverged."""
LARGE_PX = (140.0, 180.0)
"""Sides between which the weight passes from edges to gradients, which are biased by less than 0.2 pixels."""
WINDOW_PX = 5
GRADIENTS_AGREE_PX = 1.0
STOP = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, 0.01)


def refine(pixels: Pixels, corners_px: Array) -> Array:
    """Refine the corners (n, 4, 2), clockwise, of black squares on white; ones that would run away stay as they are."""
    if not len(corners_px):
        return corners_px
    allowed = np.maximum(2.0, FURTHEST * _lengths(corners_px).min(axis=1))[:, None, None]
    refined = corners_px
    for fits in FITS:
        moved = _round(pixels, refined, fits)
        stays = (np.abs(moved - corners_px) <= allowed).all(axis=(1, 2), keepdims=True)
        refined = np.where(stays, moved, refined)
    return _by_gradients_where_large(pixels, refined)


def _by_gradients_where_large(pixels: Pixels, corners: Array) -> Array:
    shortest = _lengths(corners).min(axis=1)
    share = np.clip((shortest - LARGE_PX[0]) / (LARGE_PX[1] - LARGE_PX[0]), 0.0, 1.0)
    limits = np.array(pixels.shape[::-1]) - 1
    large = (share > 0) & ((corners >= 0) & (corners <= limits)).all(axis=(1, 2))
    if not large.any():
        return corners
    start = corners[large].reshape(-1, 1, 2).astype(np.float32)
    local = cv2.cornerSubPix(pixels, start, (WINDOW_PX, WINDOW_PX), (-1, -1), STOP).reshape(-1, 4, 2)
    step = local.astype(np.float64) - corners[large]
    agrees = np.linalg.norm(step, axis=2, keepdims=True) < GRADIENTS_AGREE_PX
    moved = corners.copy()
    moved[large] += np.where(agrees, step, 0.0) * share[large, None, None]
    return moved


def _round(pixels: Pixels, corners: Array, fits: int) -> Array:
    """Fit each side t(s) = c0 + c1 s + c2 s², s from -1 to 1 along it, t outwards; cross its tangents at the ends."""
    length = np.maximum(_lengths(corners), 1e-6)
    along = (corners[:, NEXT] - corners) / length[..., None]
    outward = np.stack([along[..., 1], -along[..., 0]], axis=-1)
    inner = 1 - 2 * np.minimum(MARGIN, MARGIN_PX / length)
    s = inner[..., None] * ALONG
    middle = (corners[:, NEXT] + corners) / 2
    feet = middle[:, :, None] + (s * length[..., None] / 2)[..., None] * along[:, :, None]
    offset, weight = _edge_offsets(pixels, feet, outward, np.clip(length / CELLS / 2, *REACH_PX))
    fitted = _fitted(s, offset, weight, length, fits)
    return _crossings(middle, along, outward, length, fitted)


def _edge_offsets(pixels: Pixels, feet: Array, outward: Array, reach: Array) -> tuple[Array, Array]:
    """Find the edge in each profile, as the centroid of the squared rise; (n, 4, SAMPLES) offsets in px and weights."""
    t = reach[..., None] * ACROSS
    points = (feet[..., None, :] + t[:, :, None, :, None] * outward[:, :, None, None]).astype(np.float32)
    flat = points.reshape(-1, STEPS, 2)
    levels = _sampled(pixels, flat).reshape(points.shape[:-1])
    rise = np.maximum(levels[..., 1:] - levels[..., :-1], 0.0) ** 2
    total = rise.sum(axis=-1)
    between = (t[..., 1:] + t[..., :-1]) / 2
    offset = np.einsum("nskt,nst->nsk", rise, between) / np.maximum(total, 1e-9)
    contrast = levels[..., -1] - levels[..., 0]
    return offset, np.where(contrast > 0, np.minimum(contrast, 64.0), 0.0)


def _sampled(pixels: Pixels, points: NDArray[np.float32]) -> Array:
    sampled = cv2.remap(pixels, points[..., 0], points[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return sampled.astype(np.float64)


def _fitted(s: Array, offset: Array, weight: Array, length: Array, fits: int) -> Array:
    """Fit by weighted least squares, the bow held near 0, then again with outliers weighed down (Cauchy)."""
    powers = np.stack([np.ones_like(s), s, s * s], axis=-1)
    prior = np.zeros((*length.shape, 3, 3))
    prior[..., 2, 2] = (NOISE_PX / (BOW_PER_PX * length**2)) ** 2
    prior += 1e-6 * np.eye(3)
    relative = weight / np.maximum(weight.mean(axis=-1, keepdims=True), 1e-9)
    robust = relative
    for _ in range(fits):
        weighted = powers * robust[..., None]
        normal = np.swapaxes(weighted, -1, -2) @ powers + prior
        fitted = np.linalg.solve(normal, (np.swapaxes(weighted, -1, -2) @ offset[..., None]))[..., 0]
        residual = offset - (powers @ fitted[..., None])[..., 0]
        robust = relative / (1 + (residual / (2 * NOISE_PX)) ** 2)
    return np.asarray(fitted, dtype=np.float64)


def _crossings(middle: Array, along: Array, outward: Array, length: Array, fitted: Array) -> Array:
    """Cross each side's tangent at its start with the one of the side before at its end."""
    half = length[..., None] / 2
    first, last = (
        (
            middle + sign * half * along + (fitted @ [1, sign, 1])[..., None] * outward,
            along + ((fitted @ [0, 1, 2 * sign]) / half[..., 0])[..., None] * outward,
        )
        for sign in (-1, 1)
    )
    point, direction = first
    other, towards = (part[:, BEFORE] for part in last)
    cross = direction[..., 0] * towards[..., 1] - direction[..., 1] * towards[..., 0]
    gap = other - point
    reach = (gap[..., 0] * towards[..., 1] - gap[..., 1] * towards[..., 0]) / np.where(
        np.abs(cross) < 1e-6, np.nan, cross
    )
    crossed: Array = point + reach[..., None] * direction
    return crossed


def _lengths(corners: Array) -> Array:
    lengths: Array = np.sqrt(((corners[:, NEXT] - corners) ** 2).sum(axis=2))
    return lengths
