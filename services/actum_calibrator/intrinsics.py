"""One camera's intrinsics from views of the board (Zhang 2000), and what speaks against a set of views."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from actum.calibration import Calibration, IntrinsicsQuality
from actum_calibrator.bending import FLAT, Bend, bend_of, bent_corners_m
from actum_calibrator.board import Array
from actum_calibrator.views import View

FEWEST_VIEWS = 8
TILT_DEG, FEWEST_TILTED = 15.0, 3
CELLS = (16, 12)
LEAST_COVERAGE, GOOD_COVERAGE = 0.3, 0.6
MOST_FOCAL_DEVIATION = 0.005
MOST_RMS_OF_DIAGONAL = 1e-3
SURE_DEVIATIONS = 4.0
MOST_BEND_OF_DIAGONAL = 0.01
LENS_UNKNOWNS, POSE_UNKNOWNS = 9, 6


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
    the image, (rows, columns). `bend_mm` is how far the board is from flat, which is allowed for.
    """

    size: tuple[int, int]
    matrix: Array
    distortion: Array
    rms_px: float
    deviations_px: Array
    residuals_px: list[Array]
    tilts_deg: list[float]
    covered: NDArray[np.bool_]
    bend_mm: float = 0.0

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
    if reasons := [*_untilted(found.tilts_deg), *_inexact(found, views)] or _contradiction(found, views):
        raise PoorSetError(reasons)
    found = _unbent(found, views)
    if reasons := _bent(found, views) or _undetermined(found):
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


def _unbent(flat: Intrinsics, views: Sequence[View]) -> Intrinsics:
    """Allow for the bend of the board, where the views tell one."""

    def fit(bend: Bend) -> Array:
        return np.concatenate(_solved(views, bend, flat).residuals_px).ravel()

    bend = bend_of(fit, LENS_UNKNOWNS + POSE_UNKNOWNS * len(views))
    return flat if bend is FLAT else _solved(views, bend, flat)


def _solved(views: Sequence[View], bend: Bend = FLAT, start: Intrinsics | None = None) -> Intrinsics:
    """Calibrate with a board bent in some way; only a flat one needs no camera to start from."""
    board_m = bent_corners_m(views[0].board, bend)
    objects = [board_m[view.ids].astype(np.float32) for view in views]
    images = [view.corners_px.astype(np.float32) for view in views]
    guess = (np.eye(3), np.zeros(5)) if start is None else (start.matrix.copy(), start.distortion.copy())
    try:
        error, matrix, distortion, rotations, positions, deviations, _, _ = cv2.calibrateCameraExtended(
            objects, images, views[0].size, *guess, flags=0 if start is None else cv2.CALIB_USE_INTRINSIC_GUESS
        )
    except cv2.error:
        raise PoorSetError(["no camera fits these views: tilt the board more, and differently in each view"]) from None
    residuals = []
    for view, rotation, position in zip(views, rotations, positions, strict=True):
        projected, _ = cv2.projectPoints(board_m[view.ids], rotation, position, matrix, distortion)
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
        bend_mm=1000 * float(np.ptp(board_m[:, 2])),
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


def _contradiction(found: Intrinsics, views: Sequence[View]) -> list[str]:
    """Name the view that fits worst where the others alone tell another focal length, or one where all tell none."""
    worst = int(np.argmax(found.rms_of_views_px()))
    without = _solved([view for place, view in enumerate(views) if place != worst])
    focal, others, deviations = np.diag(found.matrix)[:2], np.diag(without.matrix)[:2], without.deviations_px[:2]
    limits = np.maximum(SURE_DEVIATIONS * deviations, MOST_FOCAL_DEVIATION * others)
    told = _focal_deviation(without) <= MOST_FOCAL_DEVIATION < _focal_deviation(found)
    if not told and (np.abs(focal - others) <= limits).all():
        return []
    return [
        f"one picture contradicts the others: {views[worst].name}; with it the focal length is "
        f"{focal[0]:.1f} x {focal[1]:.1f} px, without it {others[0]:.1f} x {others[1]:.1f}: was the zoom, the focus or "
        "the board another? Leave it out or take it again"
    ]


def _focal_deviation(found: Intrinsics) -> float:
    """Standard deviation of the focal length, in parts of it, along the axis in which it is worse."""
    return max(
        float(found.deviations_px[axis] / found.matrix[axis, axis]) if found.matrix[axis, axis] > 0 else math.inf
        for axis in (0, 1)
    )


def _bent(found: Intrinsics, views: Sequence[View]) -> list[str]:
    board = views[0].board
    limit_mm = 1000 * MOST_BEND_OF_DIAGONAL * math.hypot(board.width_m, board.height_m)
    if found.bend_mm <= limit_mm:
        return []
    return [
        f"the board is bent by {found.bend_mm:.1f} mm, at most {limit_mm:.1f}: glue it to something flat and stiff, "
        "and take the pictures anew"
    ]


def _undetermined(found: Intrinsics) -> list[str]:
    share = _focal_deviation(found)
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
