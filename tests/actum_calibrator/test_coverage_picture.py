import cv2
import numpy as np
import pytest

from actum_calibrator.board import Board
from actum_calibrator.board_views import View
from actum_calibrator.coverage_picture import (
    ARROWS,
    CORNER,
    COVERED,
    EDGE,
    EMPTY,
    OUTLINE,
    TOP,
    WIDTH,
    Drawing,
    coverage_picture,
)
from actum_calibrator.intrinsics import Intrinsics, estimate_intrinsics
from actum_calibrator.view_set import CELLS


def colour(code: str) -> list[int]:
    return [int(code[start : start + 2], 16) for start in (5, 3, 1)]


def estimated(size: tuple[int, int], residuals_px: np.ndarray) -> Intrinsics:
    matrix = np.array([[600.0, 0.0, 320.0], [0.0, 600.0, 240.0], [0.0, 0.0, 1.0]])
    uncovered = np.zeros(CELLS[::-1], dtype=bool)
    return Intrinsics(size, matrix, np.zeros(5), 0.5, np.ones(4), [residuals_px], [20.0], uncovered)


@pytest.mark.parametrize(
    ("draw", "bounds"),
    [
        (lambda drawing: drawing.box(40, 30, 80, 50, CORNER), (40, 30, 80, 50)),
        (lambda drawing: drawing.dot(60, 40, 8, CORNER), (52, 32, 68, 48)),
        (lambda drawing: drawing.line([(40, 30), (80, 50)], CORNER), (40, 30, 80, 50)),
        (lambda drawing: drawing.text(40, 30, "H" * 10, 20, CORNER), (41, 33, 183, 49)),
    ],
    ids=["box", "dot", "line", "text"],
)
def test_what_is_drawn_lies_within_its_pixels(draw, bounds: tuple[int, ...]) -> None:
    drawing = Drawing(200, 100)
    draw(drawing)
    picture = cv2.imdecode(np.frombuffer(drawing.png(), dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    rows, columns = np.nonzero(picture < 200)
    assert (columns.min(), rows.min(), columns.max(), rows.max()) == pytest.approx(bounds, abs=2)


@pytest.mark.parametrize(("residual_px", "magnification"), [(0.5, 20), (0.21, 100), (11.1, 1), (0.05, 200)])
def test_each_corner_is_drawn_where_it_was_seen_with_its_residual_as_an_arrow(
    residual_px: float, magnification: float
) -> None:
    size, corners_px = (450, 300), np.array([[100.0, 50.0], [350.0, 60.0], [340.0, 250.0], [90.0, 200.0]])
    residuals_px = residual_px * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    view = View("board", size, Board(), [0, 1, 2, 3], corners_px, 0.0)
    png = coverage_picture(estimated(size, residuals_px), [view])
    picture = cv2.imdecode(np.frombuffer(png, dtype=np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    scale = WIDTH / size[0]

    def shown(place_px: np.ndarray, code: str) -> bool:
        x, y = np.floor(np.array([EDGE, TOP]) + scale * place_px).astype(int)
        blended = np.linalg.norm(picture[y - 1 : y + 2, x - 1 : x + 2] - np.array(colour(code)), axis=-1)
        return bool(blended.min() < 0.7 * np.linalg.norm(np.subtract(colour(EMPTY), colour(code))))

    ends_px = corners_px + magnification * residuals_px
    assert all(shown(corner, CORNER) for corner in corners_px)
    assert all(shown(0.2 * corner + 0.8 * end, ARROWS) for corner, end in zip(corners_px, ends_px, strict=True))
    assert not any(shown(1.2 * end - 0.2 * corner, ARROWS) for corner, end in zip(corners_px, ends_px, strict=True))
    assert all(shown(middle, OUTLINE) for middle in (corners_px + np.roll(corners_px, 1, axis=0)) / 2)


@pytest.mark.thorough
def test_the_picture_shows_where_the_board_was_and_where_never(good_views: list[View]) -> None:
    found = estimate_intrinsics(good_views)
    picture = cv2.imdecode(np.frombuffer(coverage_picture(found, good_views), dtype=np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    height = WIDTH * found.size[1] / found.size[0]
    for (row, column), covered in np.ndenumerate(found.covered):
        left, top = EDGE + column * WIDTH / CELLS[0], TOP + row * height / CELLS[1]
        cell = picture[round(top + 3) : round(top + height / CELLS[1] - 3), round(left + 3) : round(left + 40)]
        share = (cell == colour(COVERED if covered else EMPTY)).all(axis=-1).mean()
        assert share > 0.2, (row, column)
