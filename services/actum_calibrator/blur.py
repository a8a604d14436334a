"""Estimates an image's blur at the edges of the board's squares or, without a board, at the sharpest edges."""

import math

import cv2
import numpy as np

from actum.arrays import Array, Pixels
from actum_calibrator.board import Board

ALONG = np.linspace(0.3, 0.7, 9)  # positions along an edge, as shares of its length: clear of other edges
STEPS = 41  # samples across an edge: several per pixel at usual image sizes of a square
FAINTEST = 10.0  # least contrast in grey levels: a weaker edge is lost in noise
SMOOTHING_PX = 1.0  # standard deviation; removes noise that would look like a sharp edge; its own blur is subtracted
EXTREMES = (0.5, 99.5)  # percentiles of the grey levels that are taken for black and white
STEEPEST = 99.9  # percentile of the slopes that is taken for the slope of the sharpest edges


def blur_px(pixels: Pixels, board: Board, ids: list[int], corners_px: Array) -> float:
    """Estimate the standard deviation of the blur in px, along the board's axis with more blur, from corners (n, 2).

    An edge of contrast c blurred by a Gaussian of deviation sigma has the steepest slope c / (sigma sqrt(2 pi)).
    The median is taken over the edges of each direction; 0 where no edge can be measured.
    """
    at = dict(zip(ids, corners_px, strict=True))
    image_from_board = image_from_plane(board, ids, corners_px)
    across = board.columns - 1
    worst = 0.0
    for stride, normal in ((1, np.array([0.0, 1.0])), (across, np.array([1.0, 0.0]))):
        edges = [(a, a + stride) for a in ids if a + stride in at and (stride != 1 or (a + 1) % across)]
        blurs = [
            _edge_blur_px(pixels, at[a], at[b], _reach_px(image_from_board, board, a, b, normal)) for a, b in edges
        ]
        known = [value for value in blurs if value is not None]
        worst = max(worst, float(np.median(known)) if known else 0.0)
    return worst


def image_from_plane(board: Board, ids: list[int], corners_px: Array) -> Array:
    """Fit the homography (3, 3) from the board's plane (m) to the image (px)."""
    homography, _ = cv2.findHomography(board.corners_m[ids][:, :2], corners_px)
    return np.asarray(homography, dtype=np.float64)


def image_blur_px(pixels: Pixels) -> float | None:
    """Estimate the blur (standard deviation, px) at the sharpest edges of a whole image; None if there are no edges."""
    smooth = cv2.GaussianBlur(pixels, (0, 0), SMOOTHING_PX).astype(np.float32)
    dark, bright = np.percentile(smooth, EXTREMES)
    slopes = [float(np.percentile(np.abs(np.diff(smooth, axis=axis)), STEEPEST)) for axis in (0, 1)]
    if bright - dark < 2 * FAINTEST or min(slopes) <= 0:
        return None
    blurred = (bright - dark) / min(slopes) / math.sqrt(2 * math.pi)
    return math.sqrt(max(0.0, blurred**2 - SMOOTHING_PX**2))


def _reach_px(image_from_board: Array, board: Board, a: int, b: int, normal: Array) -> Array:
    """Return the vector (2,) in the image from the middle of an edge across the white margin beside a marker."""
    middle = (board.corners_m[a, :2] + board.corners_m[b, :2]) / 2
    ends = np.array([[middle, middle + board.margin_m * normal]])
    start, end = cv2.perspectiveTransform(ends, image_from_board)[0]
    reach: Array = end - start
    return reach


def _edge_blur_px(pixels: Pixels, a: Array, b: Array, reach: Array) -> float | None:
    """Measure the blur (px) of the edge from corner a to b, within `reach` (2,) on both sides; None if too faint."""
    along, length = b - a, float(np.linalg.norm(b - a))
    offsets = np.linspace(-1.0, 1.0, STEPS)
    points = (a + ALONG[:, None] * along)[:, None, :] + offsets[None, :, None] * reach
    sampled = cv2.remap(
        pixels, points[..., 0].astype(np.float32), points[..., 1].astype(np.float32), cv2.INTER_LINEAR
    ).astype(np.float64)
    profile = sampled.mean(axis=0)
    across_px = abs(float(along[0] * reach[1] - along[1] * reach[0])) / max(length, 1e-9)
    step_px = 2 * across_px / (STEPS - 1)
    lag = max(1, round(1.0 / max(step_px, 1e-9)))
    if lag >= STEPS // 2 or (contrast := float(np.ptp(profile))) < FAINTEST:
        return None
    slope = float(np.abs(profile[lag:] - profile[:-lag]).max()) / (lag * step_px)
    return contrast / slope / math.sqrt(2 * math.pi)
