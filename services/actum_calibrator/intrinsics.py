"""Estimates a camera's intrinsics from views of the board (Zhang 2000), and refuses unreliable results."""

import datetime
import math
from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from actum.arrays import Array, Mask
from actum.calibration import Calibration, IntrinsicsQuality
from actum_calibrator.board_deformation import FLAT, Deformation, deformed_corners_m, estimate_deformation
from actum_calibrator.board_views import View
from actum_calibrator.view_set import (
    PoorSetError,
    covered_cells,
    nominal_tilts_deg,
    shortcomings,
    tilt_deg,
    tilt_shortcomings,
)

MOST_FOCAL_DEVIATION = 0.005  # relative standard deviation of the focal length: 10 mm at 2 m
MOST_RMS_OF_DIAGONAL = 1e-3  # 0.8 px in 640x480; sharp views of a flat board have a quarter of that
SIGNIFICANT_DEVIATIONS = 4.0  # standard deviations from which two focal lengths differ significantly
MOST_BEND_OF_DIAGONAL = 0.01  # share of the board's diagonal: a larger bend is no quadratic surface
CAMERA_UNKNOWNS = 9  # fx, fy, cx, cy, k1, k2, p1, p2, k3
POSE_UNKNOWNS = 6  # of each view: a rotation and a translation


@dataclass(frozen=True)
class Intrinsics:
    """A camera's intrinsics estimated from views.

    Attributes:
        size: the image's width and height in px.
        matrix: K (3, 3), in px.
        distortion: (5,) k1, k2, p1, p2, k3.
        rms_px: the root mean square reprojection error over all views.
        deviations_px: (4,), the standard deviations of fx, fy, cx and cy.
        residuals_px: each view's detected minus projected corners (n, 2).
        tilts_deg: each view's angle between the board and the image plane.
        covered: (rows, columns), the cells of the image that the board has covered.
        bend_mm: height difference between the board's lowest and highest corner; the estimate allows for it.
    """

    size: tuple[int, int]
    matrix: Array
    distortion: Array
    rms_px: float
    deviations_px: Array
    residuals_px: list[Array]
    tilts_deg: list[float]
    covered: Mask
    bend_mm: float = 0.0

    @property
    def coverage(self) -> float:
        """Share of the image that the board has covered."""
        return float(self.covered.mean())

    def rms_of_views_px(self) -> list[float]:
        """Return each view's root mean square reprojection error."""
        return [math.sqrt(float((residuals**2).sum(axis=1).mean())) for residuals in self.residuals_px]


def estimate_intrinsics(views: Sequence[View]) -> Intrinsics:
    """Calibrate one camera (Zhang 2000), allowing for the board's deformation if it is significant.

    Raises:
        PoorSetError: the views do not determine the camera, or contradict each other.
    """
    if reasons := shortcomings(views):
        raise PoorSetError([*reasons, *tilt_shortcomings(nominal_tilts_deg(views))])
    intrinsics = _calibrated(views)
    if reasons := [*tilt_shortcomings(intrinsics.tilts_deg), *_ill_fitting(intrinsics, views)] or _contradiction(
        intrinsics, views
    ):
        raise PoorSetError(reasons)
    intrinsics = _with_deformation(intrinsics, views)
    if reasons := _bent(intrinsics, views) or _undetermined(intrinsics):
        raise PoorSetError(reasons)
    return intrinsics


def _with_deformation(flat: Intrinsics, views: Sequence[View]) -> Intrinsics:
    """Calibrate again with the board's deformation if it is significant; else return `flat`."""

    def residuals_of(deformation: Deformation) -> Array:
        return np.concatenate(_calibrated(views, deformation, flat).residuals_px).ravel()

    deformation = estimate_deformation(residuals_of, CAMERA_UNKNOWNS + POSE_UNKNOWNS * len(views))
    return flat if deformation is FLAT else _calibrated(views, deformation, flat)


def _calibrated(views: Sequence[View], deformation: Deformation = FLAT, start: Intrinsics | None = None) -> Intrinsics:
    """Calibrate with a board of a deformation (3,); one that is not flat needs initial intrinsics (`start`)."""
    board_m = deformed_corners_m(views[0].board, deformation)
    objects = [board_m[view.ids].astype(np.float32) for view in views]
    images = [view.corners_px.astype(np.float32) for view in views]
    guess = (np.eye(3), np.zeros(5)) if start is None else (start.matrix.copy(), start.distortion.copy())
    try:
        error, matrix, distortion, rotations, positions, deviations, _, _ = cv2.calibrateCameraExtended(
            objects, images, views[0].size, *guess, flags=0 if start is None else cv2.CALIB_USE_INTRINSIC_GUESS
        )
    except cv2.error:
        raise PoorSetError(
            ["no camera model fits these views: tilt the board more, and differently in each view"]
        ) from None
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
        tilts_deg=[tilt_deg(np.asarray(rotation)) for rotation in rotations],
        covered=covered_cells(views),
        bend_mm=1000 * float(np.ptp(board_m[:, 2])),
    )


def _contradiction(intrinsics: Intrinsics, views: Sequence[View]) -> list[str]:
    """Complain about the worst view if without it the focal length changes significantly, or is determined at all."""
    worst = int(np.argmax(intrinsics.rms_of_views_px()))
    without = _calibrated([view for i, view in enumerate(views) if i != worst])
    focal, others, deviations = np.diag(intrinsics.matrix)[:2], np.diag(without.matrix)[:2], without.deviations_px[:2]
    limits = np.maximum(SIGNIFICANT_DEVIATIONS * deviations, MOST_FOCAL_DEVIATION * others)
    only_without = _focal_deviation(without) <= MOST_FOCAL_DEVIATION < _focal_deviation(intrinsics)
    if not only_without and (np.abs(focal - others) <= limits).all():
        return []
    return [
        f"one picture contradicts the others: with {views[worst].name} the focal length is {focal[0]:.1f} x "
        f"{focal[1]:.1f} px, without it {others[0]:.1f} x {others[1]:.1f} px; leave this picture out, or take it "
        "again with the same zoom, focus and board"
    ]


def _focal_deviation(intrinsics: Intrinsics) -> float:
    """Return the relative standard deviation of the focal length, the larger one of both axes."""
    return max(
        float(intrinsics.deviations_px[axis] / intrinsics.matrix[axis, axis])
        if intrinsics.matrix[axis, axis] > 0
        else math.inf
        for axis in (0, 1)
    )


def _bent(intrinsics: Intrinsics, views: Sequence[View]) -> list[str]:
    board = views[0].board
    limit_mm = 1000 * MOST_BEND_OF_DIAGONAL * math.hypot(board.width_m, board.height_m)
    if intrinsics.bend_mm <= limit_mm:
        return []
    return [
        f"the board is bent by {intrinsics.bend_mm:.1f} mm, at most {limit_mm:.1f} mm are accepted: glue it to a "
        "flat, stiff surface and take the pictures again"
    ]


def _undetermined(intrinsics: Intrinsics) -> list[str]:
    share = _focal_deviation(intrinsics)
    if share <= MOST_FOCAL_DEVIATION:
        return []
    return [
        f"the focal length is not determined: its standard deviation is {share:.1%}, at most "
        f"{MOST_FOCAL_DEVIATION:.1%} is accepted; add views with the board tilted by about 30 deg to the left, "
        "right, top and bottom, and close enough to fill half the image"
    ]


def _ill_fitting(intrinsics: Intrinsics, views: Sequence[View]) -> list[str]:
    limit_px = MOST_RMS_OF_DIAGONAL * views[0].diagonal_px
    if intrinsics.rms_px <= limit_px:
        return []
    order = sorted(zip(intrinsics.rms_of_views_px(), (view.name for view in views), strict=True), reverse=True)
    worst = ", ".join(f"{name} {error:.1f} px" for error, name in order[:3])
    return [
        f"the corners do not fit: RMS {intrinsics.rms_px:.2f} px, at most {limit_px:.2f} px are accepted; worst "
        f"pictures: {worst}. Check that the print is flat, that the options describe this board, that the board "
        "was held still, and that zoom and focus did not change; then leave the worst pictures out or take them "
        "again"
    ]


def calibration_of(intrinsics: Intrinsics, date: datetime.date) -> Calibration:
    """Build the calibration that services read."""
    return Calibration(
        image_size=intrinsics.size,
        K=[round(float(value), 4) for value in intrinsics.matrix.ravel()],
        distortion=[round(float(value), 7) for value in intrinsics.distortion],
        intrinsics=IntrinsicsQuality(
            date=date,
            views=len(intrinsics.residuals_px),
            rms_px=round(intrinsics.rms_px, 4),
            standard_deviations_px=[round(float(value), 3) for value in intrinsics.deviations_px],
            coverage=round(intrinsics.coverage, 3),
        ),
    )
