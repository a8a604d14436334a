"""How a board is bent: taken for flat, a millimetre of bend in A4 changes the focal length found by more than 1 %."""

from collections.abc import Callable

import numpy as np

from actum.arrays import Array
from actum_calibrator.board import Board

Deformation = Array
"""A quadratic surface: heights (3,) in m by u^2, u v and v^2, u and v from the middle in halves of the diagonal."""

Residuals = Callable[[Deformation], Array]
"""Corners as found minus as projected (2n), px, of the camera that fits a board with this deformation best."""

FLAT: Deformation = np.zeros(3)
STEP_M = 5e-4  # of the differences: well above the noise of corners, well below the bends that matter
ITERATIONS = 2  # the residuals are almost linear in the deformation
LEAST_CHI_SQUARED = 30.0  # with three degrees of freedom, noise alone exceeds it once in a million times


def deformed_corners_m(board: Board, deformation: Deformation) -> Array:
    """Return the board's inner corners (n, 3), m, with the heights of a deformation (3,)."""
    corners = board.corners_m.copy()
    half = np.array([board.width_m, board.height_m]) / 2
    u, v = ((corners[:, :2] - half) / np.linalg.norm(half)).T
    corners[:, 2] = np.stack([u * u, u * v, v * v], axis=1) @ deformation
    return corners


def estimate_deformation(residuals_of: Residuals, unknowns: int) -> Deformation:
    """Find the deformation (3,) that fits best, by Gauss-Newton with numerical differences.

    Return `FLAT` where it is not significant beside the noise of the corners, by a chi-squared test. `unknowns` is
    how many other parameters are fitted to the same corners.
    """
    deformation = FLAT
    for _ in range(ITERATIONS):
        residuals = residuals_of(deformation)
        differences = [residuals_of(deformation + STEP_M * axis) - residuals for axis in np.eye(3)]
        jacobian = np.stack([difference / STEP_M for difference in differences], axis=1)
        deformation = deformation - np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
    variance = float(residuals @ residuals) / max(1, len(residuals) - unknowns - len(deformation))
    is_significant = float(np.square(jacobian @ deformation).sum()) >= LEAST_CHI_SQUARED * variance
    return deformation if is_significant else FLAT
