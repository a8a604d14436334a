"""A board that is not flat: the true focal length is found all the same, and what is bent too far is refused."""

import cv2
import numpy as np
import pytest

from actum_calibrator.board import Board
from actum_calibrator.board_deformation import deformed_corners_m
from actum_calibrator.board_views import View
from actum_calibrator.intrinsics import estimate_intrinsics
from actum_calibrator.view_set import PoorSetError
from boards import Lens, good_poses

LENS = Lens()
NOISE_PX = 0.1
FOCAL_PX = LENS.matrix[:2]


def views_of(board: Board, heights_m: tuple[float, float, float], seed: int = 0) -> list[View]:
    """Corners of a bent board as a camera sees them, with noise; those outside of the image are left out."""
    rng, corners_m = np.random.default_rng(seed), deformed_corners_m(board, np.array(heights_m))
    views = []
    for n, pose in enumerate(good_poses(board, 14)):
        turn = cv2.Rodrigues(pose[:3, :3])[0]
        exact, _ = cv2.projectPoints(corners_m, turn, pose[:3, 3], LENS.intrinsics, np.array(LENS.distortion))
        seen_px = exact[:, 0] + rng.normal(0, NOISE_PX, (len(corners_m), 2))
        inside = np.flatnonzero(((seen_px > 0) & (seen_px < np.array(LENS.size) - 1)).all(axis=1))
        views.append(View(f"view {n}", LENS.size, board, inside.tolist(), seen_px[inside], 0.7))
    return views


@pytest.mark.thorough
@pytest.mark.parametrize("heights_m", [(0.0016, 0.0, 0.0), (0.0, 0.0, -0.0025), (0.0012, 0.001, 0.0012)])
@pytest.mark.parametrize("seed", range(3))
def test_a_bent_board_tells_the_true_focal_length(board: Board, heights_m, seed: int) -> None:
    found = estimate_intrinsics(views_of(board, heights_m, seed))
    assert np.diag(found.matrix)[:2] == pytest.approx(FOCAL_PX, rel=0.005)
    true_mm = 1000 * np.ptp(deformed_corners_m(board, np.array(heights_m))[:, 2])
    assert found.bend_mm == pytest.approx(true_mm, abs=0.25)


@pytest.mark.parametrize("seed", range(5))
def test_a_flat_board_is_taken_for_flat(board: Board, seed: int) -> None:
    assert estimate_intrinsics(views_of(board, (0.0, 0.0, 0.0), seed)).bend_mm == 0.0


def test_a_board_bent_too_far_is_refused(board: Board) -> None:
    with pytest.raises(PoorSetError, match=r"the board is bent by \d\.\d mm, at most 3\.0 mm are accepted: glue it"):
        estimate_intrinsics(views_of(board, (0.0095, 0.0, 0.0)))
