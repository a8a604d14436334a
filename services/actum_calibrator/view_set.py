"""Checks of a set of views before calibration: number, image size, coverage of the image, tilt."""

import math
from collections.abc import Sequence

import cv2
import numpy as np

from actum.arrays import Array, Mask
from actum_calibrator.board_views import View

FEWEST_VIEWS = 8  # with fewer, one bad view dominates
TILT_DEG = 15.0  # least tilt with which foreshortening determines the focal length; a frontal view does not
FEWEST_TILTED = 3  # one for tilt about each axis, and one to check them
CELLS = (16, 12)  # columns and rows of the grid of coverage: as fine as a board's squares
LEAST_COVERAGE = 0.3  # share of the image; with less, the distortion is extrapolated over most of it
GOOD_COVERAGE = 0.6  # share of the image; the rest is the margin, where a board is not wholly visible


class PoorSetError(ValueError):
    """A set of pictures that does not suffice for calibration: `reasons`, each with what to do."""

    def __init__(self, reasons: Sequence[str]) -> None:
        super().__init__("\n".join(reasons))
        self.reasons = tuple(reasons)


def shortcomings(views: Sequence[View]) -> list[str]:
    """List what a set lacks for calibration: views, a common size, coverage; empty if nothing."""
    sizes = sorted({view.size for view in views})
    if len(sizes) > 1:
        listed = ", ".join(f"{width}x{height}" for width, height in sizes)
        return [f"pictures of several sizes ({listed}): calibrate each size separately"]
    reasons = []
    if len(views) < FEWEST_VIEWS:
        reasons.append(
            f"too few views: {len(views)} are usable, at least {FEWEST_VIEWS} are needed, 15 to 20 are good; take more"
        )
    if views and (share := float(covered_cells(views).mean())) < LEAST_COVERAGE:
        reasons.append(
            f"too little coverage: the board covered {share:.0%} of the image, at least {LEAST_COVERAGE:.0%} are "
            "needed; show the board near every edge and corner of the image, and closer"
        )
    return reasons


def covered_cells(views: Sequence[View]) -> Mask:
    """Return a mask (rows, columns) of the image's cells that lie within the corners of some view."""
    columns, rows = CELLS
    cells = np.zeros((rows, columns), dtype=bool)
    for view in views:
        width, height = view.size
        hull = cv2.convexHull(view.corners_px.astype(np.float32))
        for row, column in np.argwhere(~cells):
            middle = (float((column + 0.5) * width / columns), float((row + 0.5) * height / rows))
            cells[row, column] = cv2.pointPolygonTest(hull, middle, False) >= 0
    return cells


def nominal_tilts_deg(views: Sequence[View]) -> list[float]:
    """Estimate each view's tilt before calibration.

    The focal length is assumed to be the image's longer side, as with an ordinary lens; the tilt hardly depends on it.
    """
    tilts = []
    for view in views:
        width, height = view.size
        focal = float(max(width, height))
        matrix = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]])
        _, rotation, _ = cv2.solvePnP(view.corners_m, view.corners_px, matrix, None, flags=cv2.SOLVEPNP_IPPE)
        tilts.append(tilt_deg(np.asarray(rotation)))
    return tilts


def tilt_deg(rotation: Array) -> float:
    """Return the angle between the board and the image plane, from the board's rotation vector (3,)."""
    return math.degrees(math.acos(min(1.0, abs(float(cv2.Rodrigues(rotation)[0][2, 2])))))


def tilt_shortcomings(tilts_deg: Sequence[float]) -> list[str]:
    """Return a complaint if too few views are tilted to determine the focal length; empty if enough are."""
    tilted = sum(tilt >= TILT_DEG for tilt in tilts_deg)
    if tilted >= FEWEST_TILTED or not tilts_deg:
        return []
    return [
        f"too little tilt: {tilted} of {len(tilts_deg)} views are tilted by {TILT_DEG:g} deg or more, at least "
        f"{FEWEST_TILTED} are needed, because frontal views do not determine the focal length; turn the board by "
        "about 30 deg to the left, right, top and bottom"
    ]
