"""Small markers that go on as before are found by aligning them from where they were, and only as long as they do."""

import cv2
import numpy as np
import pytest

from marker_tracker.detection.decoding import MAX_COVERED_CLEAR, read_in_place
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.families import family

FAMILY = "DICT_4X4_50"
SIDE_PX, FINE = 24, 8
PAPER, WALL = 235, 120


def drawn(x_px, y_px, number=3, finger=0.0):
    """A marker with its top left corner at a place, a finger over the first part of its width."""
    side, quiet = SIDE_PX * FINE, SIDE_PX * FINE // 6
    printed = np.maximum(cv2.aruco.generateImageMarker(family(FAMILY).dictionary, number, side), 25)
    sheet = np.pad(printed, quiet, constant_values=PAPER)
    sheet[:, : round(finger * side) + quiet] = WALL if finger else PAPER
    fine = np.full((96 * FINE, 128 * FINE), WALL, dtype=np.uint8)
    left, top = round(x_px * FINE) - quiet, round(y_px * FINE) - quiet
    fine[top : top + len(sheet), left : left + len(sheet)] = sheet
    image = cv2.GaussianBlur(cv2.resize(fine, (128, 96), interpolation=cv2.INTER_AREA), (0, 0), 0.6)
    noisy = image + np.random.default_rng(round(x_px * 64)).normal(0.0, 2.0, image.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def corners_px(x_px, y_px):
    return np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * SIDE_PX + (x_px - 0.5, y_px - 0.5)


@pytest.fixture
def first():
    (marker,) = MarkerDetector({FAMILY: (3,)}).search(drawn(40, 30))
    return marker


@pytest.mark.parametrize("step_px", [0.0, 0.25, 0.5, 1.0])
def test_what_goes_on_steadily_is_found_in_every_image(first, step_px) -> None:
    marker = first
    for i in range(1, 30):
        (marker,) = read_in_place(drawn(40 + step_px * i, 30), [marker], [family(FAMILY)])
        assert np.linalg.norm(marker.corners_px - corners_px(40 + step_px * i, 30), axis=1).max() < 0.25


def test_what_speeds_up_soon_goes_many_pixels_at_once(first) -> None:
    marker, x_px = first, 40.0
    for i in range(8):
        x_px += i
        (marker,) = read_in_place(drawn(x_px, 30), [marker], [family(FAMILY)])
    assert np.linalg.norm(marker.corners_px - corners_px(x_px, 30), axis=1).max() < 0.25


def test_what_stays_is_found_where_it_was_and_does_not_creep(first) -> None:
    marker = first
    for _ in range(50):
        (marker,) = read_in_place(drawn(40, 30), [marker], [family(FAMILY)])
    assert np.abs(marker.corners_px - first.corners_px).max() < 0.05


@pytest.mark.parametrize(
    "image",
    [drawn(48, 30), drawn(40, 30, number=7), drawn(40, 30, finger=0.15), np.full((96, 128), WALL, dtype=np.uint8)],
    ids=["elsewhere", "another", "under a finger", "gone"],
)
def test_what_does_not_is_left_to_the_search(first, image) -> None:
    assert read_in_place(image, [first], [family(FAMILY)]) == []


def test_what_is_covered_in_part_has_no_place_to_begin_from() -> None:
    (marker,) = MarkerDetector({FAMILY: (3,)}).search(drawn(40, 30, finger=0.06))
    assert marker.covered > MAX_COVERED_CLEAR
    assert marker.start is None
