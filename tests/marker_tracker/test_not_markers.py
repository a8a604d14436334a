"""What frames a marker, and what only looks like one."""

import cv2
import numpy as np
import pytest

from marker_tracker.detection.decoding import Candidates, decode
from marker_tracker.detection.detector import MarkerDetector
from marker_tracker.detection.families import family
from marker_tracker.detection.quads import OUTLINE_PX, inner_squares

SIDE, CELLS = 96, 6
DARK, PAPER = 30, 200


def cut_out(number: int, edge_px: int) -> np.ndarray:
    """A marker with a narrow white edge on something dark, a little turned."""
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    printed = np.where(cv2.aruco.generateImageMarker(dictionary, number, SIDE) > 0, PAPER, DARK).astype(np.uint8)
    printed = cv2.copyMakeBorder(printed, *[edge_px] * 4, cv2.BORDER_CONSTANT, value=PAPER)
    turned = cv2.getRotationMatrix2D((len(printed) / 2, len(printed) / 2), 25.0, 1.0)
    turned[:, 2] += (160 - len(printed) / 2, 120 - len(printed) / 2)
    return cv2.warpAffine(printed, turned, (320, 240), borderMode=cv2.BORDER_CONSTANT, borderValue=DARK)


@pytest.mark.parametrize("edge_px", [4, 5, 6, 7, 8, 12])
@pytest.mark.parametrize("number", [7, 21, 25, 28])
def test_a_marker_cut_out_with_hardly_any_white_is_found_on_a_dark_thing(number, edge_px) -> None:
    (marker,) = MarkerDetector({"DICT_4X4_50": (number,)}).search(cut_out(number, edge_px))
    assert marker.id == number
    assert marker.side_px == pytest.approx(SIDE, abs=1.0)


def mirrored(number: int) -> np.ndarray:
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_5X5_1000)
    printed = cv2.aruco.generateImageMarker(dictionary, number, 7 * 30)[:, ::-1]
    return cv2.copyMakeBorder(np.ascontiguousarray(printed), *[60] * 4, cv2.BORDER_CONSTANT, value=255)


@pytest.mark.parametrize("number", [1, 12, 25, 39, 47, 81, 83, 85, 92, 95, 101, 186])
def test_a_code_read_from_cells_that_do_not_show_it_is_no_marker(number) -> None:
    assert MarkerDetector({"DICT_4X4_1000": ()}).search(mirrored(number)) == []


@pytest.mark.parametrize("cells", [4, 5, 6, 7])
def test_a_marker_is_read_while_at_most_a_tenth_of_its_border_is_white(cells: int) -> None:
    candidate_family, cell_px, at = family(f"DICT_{cells}X{cells}_50"), 20, 20.0
    side_px, border_cells = (cells + 2) * cell_px, 4 * (cells + 1)
    corners_px = at - 0.5 + np.array([[[0, 0], [side_px, 0], [side_px, side_px], [0, side_px]]], dtype=float)
    read = []
    for white in range(5):
        pattern = candidate_family.patterns[3].copy()
        pattern[0, 1 : 1 + white] = True
        pixels = np.where(np.kron(pattern, np.ones((cell_px, cell_px))) > 0, PAPER, DARK).astype(np.uint8)
        pixels = cv2.copyMakeBorder(pixels, *[int(at)] * 4, cv2.BORDER_CONSTANT, value=PAPER)
        read.append([each.id for each in decode(pixels, [Candidates(candidate_family, corners_px, corners_px)])])
    assert read == [[3] if 10 * white <= border_cells else [] for white in range(5)]


@pytest.mark.parametrize("turn_deg", range(0, 90, 5))
def test_the_marker_on_a_card_is_found_where_the_cards_outline_extends_onto_what_is_behind_it(turn_deg: int) -> None:
    """It may extend twice as far as OpenCV's does."""
    turn = np.exp(1j * np.radians(turn_deg + np.array([45, 135, 225, 315]))) * np.sqrt(2)
    whole, inner, seen = (
        np.column_stack([100 + half_px * turn.real, 100 + half_px * turn.imag])
        for half_px in (70, 40, 70 + 2 * OUTLINE_PX)
    )
    pixels = np.full((200, 200), DARK, dtype=np.uint8)
    for corners_px, level in ((whole, PAPER), (inner, DARK)):
        cv2.fillConvexPoly(pixels, np.round(corners_px * 16).astype(np.int32), level, cv2.LINE_AA, 4)
    (marker,) = inner_squares(pixels, seen[None])
    distances = np.linalg.norm(marker[:, None] - inner[None], axis=2)
    assert distances.min(axis=1).max() < 2.5
    assert sorted(distances.argmin(axis=1)) == [0, 1, 2, 3]
