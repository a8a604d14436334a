"""Estimates a board's bend: assumed to be flat, an A4 board bent by 1 mm biases the focal length by more than 1 %."""

from collections.abc import Callable

import numpy as np

from actum.arrays import Array
from actum_calibrator.board import Board

Deformation = Array
"""Coefficients (3,) in m of a quadratic surface: z = a u^2 + b u v + c v^2, with u and v from the middle in half
diagonals."""

Residuals = Callable[[Deformation], Array]
"""Returns the residuals (2n,) in px, detected minus projected, of the camera that best fits a board so deformed."""

FLAT: Deformation = np.zeros(3)
STEP_M = 5e-4  # of the numerical differences: well above the noise of corners, well below relevant bends
ITERATIONS = 2  # the residuals are almost linear in the deformation
LEAST_CHI_SQUARED = 30.0  # with three degrees of freedom, noise alone exceeds it with a probability of 1e-6


def deformed_corners_m(board: Board, deformation: Deformation) -> Array:
    """Return the board's inner corners (n, 3) in metres, with the z of a deformation (3,)."""
    corners = board.corners_m.copy()
    half = np.array([board.width_m, board.height_m]) / 2
    u, v = ((corners[:, :2] - half) / np.linalg.norm(half)).T
    corners[:, 2] = np.stack([u * u, u * v, v * v], axis=1) @ deformation
    return corners


def estimate_deformation(residuals_of: Residuals, unknowns: int) -> Deformation:
    """Estimate the deformation (3,) by Gauss-Newton with numerical differences.

    Return `FLAT` if it is not significant against the noise of the corners, by a chi-squared test. `unknowns` is the
    number of other parameters that are fitted to the same corners.
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
