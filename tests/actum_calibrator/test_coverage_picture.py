import cv2
import numpy as np
import pytest

from actum_calibrator.board_views import View
from actum_calibrator.coverage_picture import COVERED, EDGE, EMPTY, TOP, WIDTH, coverage_picture
from actum_calibrator.intrinsics import estimate_intrinsics
from actum_calibrator.view_set import CELLS


def colour(code: str) -> list[int]:
    return [int(code[start : start + 2], 16) for start in (5, 3, 1)]


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
