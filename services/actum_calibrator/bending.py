"""How far a board is from flat: a bent one passes for another focal length, a millimetre of A4 for more than 1 %."""

from collections.abc import Callable

import numpy as np

from actum_calibrator.board import Array, Board

Bend = Array
"""Heights (3,) in m by u^2, u v and v^2, with u and v from the board's middle in halves of its diagonal."""

Fit = Callable[[Bend], Array]
"""Corners as found minus as projected, flat, of the camera that suits a bend best."""

FLAT: Bend = np.zeros(3)
STEP_M = 5e-4
ROUNDS = 2
LEAST_CHI_SQUARED = 30.0
"""With three degrees of freedom; corners of a flat board exceed it once in a million times."""


def bent_corners_m(board: Board, bend: Bend) -> Array:
    """Return the board's inner corners (n, 3) with their heights."""
    corners = board.corners_m.copy()
    half = np.array([board.width_m, board.height_m]) / 2
    u, v = ((corners[:, :2] - half) / np.linalg.norm(half)).T
    corners[:, 2] = np.stack([u * u, u * v, v * v], axis=1) @ bend
    return corners


def bend_of(fit: Fit, unknowns: int) -> Bend:
    """Find the bend that fits best (Gauss-Newton, differences); `FLAT` where it is not told from the corners' noise."""
    bend = FLAT
    for _ in range(ROUNDS):
        residuals = fit(bend)
        jacobian = np.stack([(fit(bend + STEP_M * axis) - residuals) / STEP_M for axis in np.eye(3)], axis=1)
        bend = bend - np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
    variance = float(residuals @ residuals) / max(1, len(residuals) - unknowns - len(bend))
    told = float(np.square(jacobian @ bend).sum()) >= LEAST_CHI_SQUARED * variance
    return bend if told else FLAT
