"""Markers whose cells are a pixel or two wide, and ones whose paper ends a little beside them, are found and read."""

import cv2
import numpy as np
import pytest

from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.families import family

SIZE_PX, FINE, TEXELS = 96, 8, 24
INK, PAPER = 40, 220
NUMBERS = range(6)


def drawn(name, number, sides_px, blur_px, quiet_cells, wall):
    """A marker as wide and high as its sides, turned by its number, on paper that ends some cells beside it."""
    pattern = np.pad(family(name).patterns[number], 2, constant_values=True)
    sheet = np.kron(np.where(pattern, PAPER, INK), np.ones((TEXELS, TEXELS))).astype(np.float32)
    cut = round((2 - quiet_cells) * TEXELS)
    sheet = sheet[cut : len(sheet) - cut, cut : len(sheet) - cut]
    corners_px = turned(sides_px, 0.1 + 0.5 * number)
    low, high = round(quiet_cells * TEXELS) - 0.5, len(sheet) - round(quiet_cells * TEXELS) - 0.5
    flat = np.array([[low, low], [high, low], [high, high], [low, high]], dtype=np.float32)
    mapping = cv2.getPerspectiveTransform(flat, ((corners_px + 0.5) * FINE - 0.5).astype(np.float32))
    fine = cv2.warpPerspective(
        sheet, mapping, (SIZE_PX * FINE, SIZE_PX * FINE), borderMode=cv2.BORDER_CONSTANT, borderValue=wall
    )
    image = cv2.GaussianBlur(cv2.resize(fine, (SIZE_PX, SIZE_PX), interpolation=cv2.INTER_AREA), (0, 0), blur_px)
    noisy = image + np.random.default_rng(number).normal(0.0, 2.0, image.shape)
    return np.clip(noisy, 0, 255).astype(np.uint8)


def turned(sides_px, angle_rad):
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    upright = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) / 2 * sides_px
    return upright @ np.array([[cos, sin], [-sin, cos]]) + SIZE_PX / 2


def is_found(name, number, sides_px, blur_px, quiet_cells, wall):
    found = MarkerDetector({name: (number,)}).search(drawn(name, number, sides_px, blur_px, quiet_cells, wall))
    off_px = [np.abs(marker.corners_px - turned(sides_px, 0.1 + 0.5 * number)).max() for marker in found]
    return [marker.id for marker in found] == [number] and max(off_px) < 1.0


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("wall", [60, 120])
def test_a_marker_is_not_dropped_for_the_outline_of_its_paper(number, wall) -> None:
    assert is_found("DICT_APRILTAG_36H11", number, (40, 40), 0.9, 2, wall)


@pytest.mark.parametrize("number", NUMBERS)
def test_a_steep_marker_is_not_dropped_for_the_outline_of_its_paper(number) -> None:
    assert is_found("DICT_APRILTAG_36H11", number, (16, 60), 0.5, 2, 60)


@pytest.mark.parametrize("number", NUMBERS)
def test_a_blurred_marker_is_told_from_a_narrow_strip_of_paper(number) -> None:
    assert is_found("DICT_APRILTAG_36H11", number, (18, 50), 1.1, 0.5, 60)


@pytest.mark.parametrize("number", NUMBERS)
@pytest.mark.parametrize("wall", [60, 120])
def test_narrow_cells_that_blur_into_one_another_are_read(number, wall) -> None:
    assert is_found("DICT_4X4_50", number, (10, 40), 0.9, 2, wall)


@pytest.mark.parametrize("number", NUMBERS)
def test_a_tag_of_twenty_pixels_is_found_out_of_focus(number) -> None:
    assert is_found("DICT_APRILTAG_36H11", number, (20, 20), 1.3, 1, 60)
