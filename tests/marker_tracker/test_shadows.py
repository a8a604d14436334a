"""A shadow that lies across a marker hides it no more than it moves its corners."""

import cv2
import numpy as np
import pytest

from marker_tracker.detection.detector import MarkerDetector

WIDTH, HEIGHT = 240, 180
FINE = 4
DARK, PAPER, WALL = 25, 200, 110


def half_in_shadow(family: str, number: int, side_px: int, light: float, direction_deg: float) -> np.ndarray:
    """A marker in the image's middle; beyond a line through it, at a direction, so much of the light is left."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, family))
    edge = side_px // 7 * FINE
    printed = cv2.aruco.generateImageMarker(dictionary, number, side_px * FINE).astype(np.float64)
    printed = cv2.copyMakeBorder(printed, edge, edge, edge, edge, cv2.BORDER_CONSTANT, value=255)
    fine = np.full((HEIGHT * FINE, WIDTH * FINE), float(WALL))
    top, left = (HEIGHT * FINE - len(printed)) // 2, (WIDTH * FINE - len(printed)) // 2
    fine[top : top + len(printed), left : left + len(printed)] = np.where(printed > 0, PAPER, DARK)
    image = cv2.resize(fine, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA)
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    turn = np.radians(direction_deg)
    beyond = (x - (WIDTH - 1) / 2) * np.cos(turn) + (y - (HEIGHT - 1) / 2) * np.sin(turn)
    shaded = image * (light + (1 - light) / (1 + np.exp(-beyond / 2)))
    return cv2.GaussianBlur(shaded, (0, 0), 0.7).round().astype(np.uint8)


@pytest.mark.parametrize("light", [0.4, 0.5])
@pytest.mark.parametrize(("family", "side_px"), [("DICT_4X4_50", 60), ("DICT_APRILTAG_36h11", 32)])
def test_a_marker_half_in_a_shadow_is_found_from_eight_of_nine_sides(family, side_px, light) -> None:
    detector = MarkerDetector({family: (17,)})
    found = [
        [marker.id for marker in detector.search(half_in_shadow(family, 17, side_px, light, direction_deg))]
        for direction_deg in range(0, 360, 40)
    ]
    assert found.count([17]) >= 8
    assert all(ids in ([], [17]) for ids in found)


@pytest.mark.parametrize("direction_deg", range(0, 360, 40))
def test_its_corners_stay_where_they_are(direction_deg) -> None:
    (marker,) = MarkerDetector({"DICT_APRILTAG_36h11": (17,)}).search(
        half_in_shadow("DICT_APRILTAG_36h11", 17, 32, 0.4, direction_deg)
    )
    middle, half = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2]), 16.0
    corners = middle + half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    assert np.linalg.norm(marker.corners_px - corners, axis=1).max() < 0.5
