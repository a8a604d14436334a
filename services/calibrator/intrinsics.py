"""One camera's intrinsics from views of the board (Zhang 2000), and what speaks against a set of views."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.calibration import Calibration, IntrinsicsQuality
from calibrator.board import Array
from calibrator.views import View

FEWEST_VIEWS = 8
TILT_DEG, FEWEST_TILTED = 15.0, 3
CELLS = (16, 12)
LEAST_COVERAGE, GOOD_COVERAGE = 0.3, 0.6
MOST_FOCAL_DEVIATION = 0.005
MOST_RMS_OF_DIAGONAL = 1e-3


class PoorSetError(ValueError):
    """A set of pictures that cannot calibrate: all `reasons`, each with what to do."""

    def __init__(self, reasons: Sequence[str]) -> None:
        super().__init__("\n".join(reasons))
        self.reasons = tuple(reasons)


@dataclass(frozen=True)
class Intrinsics:
    """A camera found from views.

    `deviations_px` are the standard deviations of fx, fy, cx and cy; `residuals_px` holds each view's corners as found
    minus as projected (n, 2), `tilts_deg` its angle between the board and the image plane. `covered` is by cells of
    the image, (rows, columns).
    """

    size: tuple[int, int]
    matrix: Array
    distortion: Array
    rms_px: float
    deviations_px: Array
    residuals_px: list[Array]
    tilts_deg: list[float]
    covered: NDArray[np.bool_]

    @property
    def coverage(self) -> float:
        """Share of the image in which the board has been."""
        return float(self.covered.mean())

    def rms_of_views_px(self) -> list[float]:
        """Each view's root mean square reprojection error."""
        return [rms(residuals) for residuals in self.residuals_px]


def rms(residuals_px: Array) -> float:
    """Root mean square length of residuals (n, 2)."""
    return math.sqrt(float((residuals_px**2).sum(axis=1).mean()))


def find_intrinsics(views: Sequence[View]) -> Intrinsics:
    """Calibrate one camera.

    Raises:
        PoorSetError: the views do not determine it.
    """
    if reasons := shortcomings(views):
        raise PoorSetError([*reasons, *_untilted(nominal_tilts_deg(views))])
    found = _solved(views)
    if reasons := [*_untilted(found.tilts_deg), *_undetermined(found), *_inexact(found, views)]:
        raise PoorSetError(reasons)
    return found


def shortcomings(views: Sequence[View]) -> list[str]:
    """Say what a set lacks before any camera is known: views, one size, coverage."""
    sizes = sorted({view.size for view in views})
    if len(sizes) > 1:
        listed = ", ".join(f"{width}x{height}" for width, height in sizes)
        return [f"pictures of several sizes ({listed}): calibrate each size by itself"]
    reasons = []
    if len(views) < FEWEST_VIEWS:
        reasons.append(
            f"too few views: {len(views)} usable, at least {FEWEST_VIEWS} are needed; 15 to 20 are good: take more"
        )
    if views and (share := float(covered_cells(views).mean())) < LEAST_COVERAGE:
        reasons.append(
            f"too little coverage: the board was in {share:.0%} of the image, at least {LEAST_COVERAGE:.0%} are "
            "needed: show it near every edge and corner of the image, and closer"
        )
    return reasons


def covered_cells(views: Sequence[View]) -> NDArray[np.bool_]:
    """Tell which cells of the image some view's corners enclose: (rows, columns)."""
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
    """Estimate each view's tilt with an ordinary lens, as wide as its distance: foreshortening hardly depends on it."""
    tilts = []
    for view in views:
        width, height = view.size
        focal = float(max(width, height))
        matrix = np.array([[focal, 0, width / 2], [0, focal, height / 2], [0, 0, 1]])
        _, rotation, _ = cv2.solvePnP(view.corners_m, view.corners_px, matrix, None, flags=cv2.SOLVEPNP_IPPE)
        tilts.append(_tilt_deg(np.asarray(rotation)))
    return tilts


def _solved(views: Sequence[View]) -> Intrinsics:
    objects = [view.corners_m.astype(np.float32) for view in views]
    images = [view.corners_px.astype(np.float32) for view in views]
    try:
        error, matrix, distortion, rotations, positions, deviations, _, _ = cv2.calibrateCameraExtended(
            objects, images, views[0].size, np.eye(3), np.zeros(5)
        )
    except cv2.error:
        raise PoorSetError(["no camera fits these views: tilt the board more, and differently in each view"]) from None
    residuals = []
    for view, rotation, position in zip(views, rotations, positions, strict=True):
        projected, _ = cv2.projectPoints(view.corners_m, rotation, position, matrix, distortion)
        residuals.append(view.corners_px - projected.reshape(-1, 2))
    return Intrinsics(
        size=views[0].size,
        matrix=np.asarray(matrix),
        distortion=np.ravel(distortion),
        rms_px=float(error),
        deviations_px=np.ravel(deviations)[:4].astype(np.float64),
        residuals_px=residuals,
        tilts_deg=[_tilt_deg(np.asarray(rotation)) for rotation in rotations],
        covered=covered_cells(views),
    )


def _tilt_deg(rotation: Array) -> float:
    return math.degrees(math.acos(min(1.0, abs(float(cv2.Rodrigues(rotation)[0][2, 2])))))


def _untilted(tilts_deg: Sequence[float]) -> list[str]:
    tilted = sum(tilt >= TILT_DEG for tilt in tilts_deg)
    if tilted >= FEWEST_TILTED or not tilts_deg:
        return []
    return [
        f"too little tilt: {tilted} of {len(tilts_deg)} views are tilted by {TILT_DEG:g} deg or more, at least "
        f"{FEWEST_TILTED} are needed; frontal views do not determine the focal length: turn the board by about 30 deg, "
        "left, right, up and down"
    ]


def _undetermined(found: Intrinsics) -> list[str]:
    share = max(
        found.deviations_px[axis] / found.matrix[axis, axis] if found.matrix[axis, axis] > 0 else math.inf
        for axis in (0, 1)
    )
    if share <= MOST_FOCAL_DEVIATION:
        return []
    return [
        f"focal length not determined: its standard deviation is {share:.1%}, at most {MOST_FOCAL_DEVIATION:.1%}: "
        "add views with the board tilted by about 30 deg, left, right, up and down, and near enough to fill half the "
        "image"
    ]


def _inexact(found: Intrinsics, views: Sequence[View]) -> list[str]:
    limit_px = MOST_RMS_OF_DIAGONAL * views[0].diagonal_px
    if found.rms_px <= limit_px:
        return []
    order = sorted(zip(found.rms_of_views_px(), (view.name for view in views), strict=True), reverse=True)
    worst = ", ".join(f"{name} {error:.1f} px" for error, name in order[:3])
    return [
        f"corners do not fit: RMS {found.rms_px:.2f} px, at most {limit_px:.2f}; worst {worst}: is the print flat, "
        "is it the board that the options name, was it held still, was zoom and focus fixed? Leave the worst out or "
        "take them again"
    ]


def calibration_of(found: Intrinsics, date: datetime.date) -> Calibration:
    """Write a camera down as services read it."""
    return Calibration(
        image_size=found.size,
        K=[round(float(value), 4) for value in found.matrix.ravel()],
        distortion=[round(float(value), 7) for value in found.distortion],
        intrinsics=IntrinsicsQuality(
            date=date,
            views=len(found.residuals_px),
            rms_px=round(found.rms_px, 4),
            standard_deviations_px=[round(float(value), 3) for value in found.deviations_px],
            coverage=round(found.coverage, 3),
        ),
    )
