"""A camera's intrinsics from rendered boards: as they truly are, or refused with the reason."""

import datetime
from dataclasses import replace

import cv2
import numpy as np
import pytest

from actum_calibrator.board import Board
from actum_calibrator.board_views import BoardFinder, View
from actum_calibrator.grey_images import BlurredError, UnusablePictureError, complaints
from actum_calibrator.intrinsics import calibration_of, estimate_intrinsics
from actum_calibrator.view_set import PoorSetError
from boards import PLACES, Lens, facing, good_poses, photograph

LENS = Lens()


def test_the_true_camera_is_found(good_views: list[View]) -> None:
    found = estimate_intrinsics(good_views)
    truth = LENS.intrinsics
    assert found.matrix[0, 0] == pytest.approx(truth[0, 0], rel=0.003)
    assert found.matrix[1, 1] == pytest.approx(truth[1, 1], rel=0.003)
    assert found.matrix[:2, 2] == pytest.approx(truth[:2, 2], abs=3)
    assert found.rms_px < 0.15


def test_pixels_where_the_board_was_see_in_the_true_direction(good_views: list[View]) -> None:
    found = estimate_intrinsics(good_views)
    corners = np.vstack([view.corners_px for view in good_views])
    seen = cv2.undistortPoints(corners, found.matrix, found.distortion).reshape(-1, 2)
    true = cv2.undistortPoints(corners, LENS.intrinsics, np.array(LENS.distortion)).reshape(-1, 2)
    away_from_centre = (seen - seen.mean(axis=0)) - (true - true.mean(axis=0))
    assert np.abs(away_from_centre).max() < 0.002


def test_the_true_focal_length_lies_within_its_standard_deviations(good_views: list[View]) -> None:
    found = estimate_intrinsics(good_views)
    errors = np.abs(np.diag(found.matrix)[:2] - np.diag(LENS.intrinsics)[:2])
    assert (errors < 4 * found.deviations_px[:2]).all()
    assert (found.deviations_px[:2] < 2).all()


def test_the_calibration_says_how_it_was_made(good_views: list[View]) -> None:
    found = estimate_intrinsics(good_views)
    made = calibration_of(found, datetime.date(2026, 3, 1))
    assert made.image_size == LENS.size
    assert made.matrix == pytest.approx(found.matrix, abs=1e-3)
    assert made.intrinsics is not None
    assert made.intrinsics.views == len(good_views)
    assert made.skeleton_from_image is None


def reasons(views: list[View]) -> str:
    with pytest.raises(PoorSetError) as refused:
        estimate_intrinsics(views)
    return "\n".join(refused.value.reasons)


def test_too_few_views_are_refused(good_views: list[View]) -> None:
    assert "too few views: 5 are usable, at least 8" in reasons(good_views[:5])
    assert "too few views: 0 are usable" in reasons([])


@pytest.fixture(scope="module")
def frontal_views(board: Board, finder: BoardFinder) -> list[View]:
    places = [facing(board, (x, y, 0.45 + 0.03 * n), (2 * (-1) ** n, n % 3, 10 * n)) for n, (x, y) in enumerate(PLACES)]
    return [finder.find(photograph(LENS, board, pose, seed=n), f"frontal {n}") for n, pose in enumerate(places)]


def test_frontal_views_are_refused(frontal_views: list[View]) -> None:
    said = reasons(frontal_views)
    assert "too little tilt: 0 of 8 views" in said
    assert "focal length" in said


def test_one_place_in_the_image_is_refused(board: Board, finder: BoardFinder) -> None:
    turns = [(angle, 0, 0) for angle in (-40, -30, 30, 40)] + [(0, angle, 0) for angle in (-40, -30, 30, 40)]
    poses = [facing(board, (-0.12, -0.08, 0.6), turn) for turn in turns]
    views = [finder.find(photograph(LENS, board, pose, seed=n), str(n)) for n, pose in enumerate(poses)]
    assert "too little coverage" in reasons(views)


def test_corners_that_do_not_fit_are_refused_and_the_worst_named(good_views: list[View]) -> None:
    bent = good_views[3]
    bulge = 0.02 * (bent.corners_px - bent.corners_px.mean(axis=0)) ** 2 / 10
    shaken = View("bent.png", bent.size, bent.board, bent.ids, bent.corners_px + bulge, bent.blur_px)
    said = reasons([*good_views[:3], shaken, *good_views[4:]])
    assert "corners do not fit" in said
    assert "worst pictures: bent.png" in said


@pytest.mark.parametrize("zoom", [1.05, 1.3])
@pytest.mark.parametrize("place", [0, 3])
def test_one_picture_at_another_zoom_is_refused_and_named(good_views: list[View], zoom: float, place: int) -> None:
    view, centre_px = good_views[place], np.array([320.0, 240.0])
    zoomed = replace(view, corners_px=centre_px + zoom * (view.corners_px - centre_px))
    views = [*good_views[:place], zoomed, *good_views[place + 1 :]]
    with pytest.raises(PoorSetError, match=f"one picture contradicts the others: with view {place} "):
        estimate_intrinsics(views)


def test_pictures_of_several_sizes_are_refused(good_views: list[View]) -> None:
    first = good_views[0]
    other = View("large.png", (1280, 960), first.board, first.ids, first.corners_px, first.blur_px)
    assert "several sizes (640x480, 1280x960)" in reasons([other, *good_views[1:]])


@pytest.mark.parametrize("blur_px", [2.0, 4.0, 8.0])
def test_a_blurred_picture_is_called_so(board: Board, finder: BoardFinder, blur_px: float) -> None:
    with pytest.raises(BlurredError, match="blurred by about"):
        finder.find(photograph(LENS, board, good_poses(board)[0], blur_px=blur_px), "a.png")


def test_blur_is_measured_where_the_board_is_found(board: Board, finder: BoardFinder) -> None:
    near = facing(board, (0, 0, 0.33), (10, 20, 0))
    for blur_px in (0.8, 1.2, 1.6):
        assert finder.find(photograph(LENS, board, near, blur_px=blur_px), "a").blur_px == pytest.approx(
            blur_px, abs=0.25
        )


def test_motion_across_is_blur_too(board: Board, finder: BoardFinder) -> None:
    sharp = photograph(LENS, board, facing(board, (0, 0, 0.33), (10, 20, 0)), blur_px=0.5)
    with pytest.raises(BlurredError):
        finder.find(cv2.blur(sharp, (11, 1)), "moving.png")


def test_pictures_without_a_board_are_called_so(finder: BoardFinder) -> None:
    with pytest.raises(UnusablePictureError, match="too dark, too bright or empty"):
        finder.find(np.zeros((480, 640), dtype=np.uint8), "black.png")
    squares = np.kron(np.indices((12, 16)).sum(axis=0) % 2 * 255, np.ones((40, 40))).astype(np.uint8)
    with pytest.raises(UnusablePictureError, match="no board was found"):
        finder.find(squares, "chess.png")


def test_complaints_tell_what_to_do() -> None:
    said = complaints(
        [BlurredError("a", "blurred"), BlurredError("b", "blurred"), UnusablePictureError("c", "no board")]
    )
    assert said[0].startswith("2 pictures are blurred: hold the board still")
    assert said[1].startswith("1 picture is without a usable board")
    assert complaints([]) == []
