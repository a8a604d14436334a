"""Printed sheets rendered back to an image: every marker is found, in true size."""

import cv2
import numpy as np
import pypdfium2
import pytest

from actum_calibrator.board import Board, PatternError, dictionary_of
from actum_calibrator.board_sheet import board_sheet
from actum_calibrator.marker_sheet import marker_sheet
from actum_calibrator.sheet_sizes import SheetSize

DOTS_PER_INCH = 300
MM_PER_PX = 25.4 / DOTS_PER_INCH


def pages(pdf: bytes) -> list[np.ndarray]:
    with pypdfium2.PdfDocument(pdf) as document:
        rendered = [page.render(scale=DOTS_PER_INCH / 72, grayscale=True).to_numpy() for page in document]
    return [np.ascontiguousarray(page.reshape(page.shape[:2])) for page in rendered]


def texts(pdf: bytes) -> list[str]:
    with pypdfium2.PdfDocument(pdf) as document:
        return [page.get_textpage().get_text_range() for page in document]


def sides_mm(page: np.ndarray, family: str) -> dict[int, float]:
    """Each marker's mean side."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary_of(family), parameters).detectMarkers(page)
    quads = [np.reshape(quad, (4, 2)) for quad in corners]
    lengths = [np.linalg.norm(quad - np.roll(quad, 1, axis=0), axis=1).mean() * MM_PER_PX for quad in quads]
    return dict(zip(np.ravel(ids).tolist(), map(float, lengths), strict=True))


CASES = [
    ("DICT_4X4_50", [1, 2, 3], 80.0, SheetSize.A4, 1),
    ("DICT_4X4_50", range(6), 80.0, SheetSize.LETTER, 2),
    ("DICT_APRILTAG_36h11", [0, 17, 586], 40.0, SheetSize.A4, 1),
    ("DICT_6X6_250", range(12), 20.0, SheetSize.LETTER, 1),
    ("DICT_5X5_100", [99], 150.0, SheetSize.A4, 1),
]


@pytest.mark.parametrize(("family", "ids", "size_mm", "paper", "count"), CASES)
def test_every_marker_is_found_in_true_size(family, ids, size_mm, paper, count) -> None:
    rendered = pages(marker_sheet(family, ids, size_mm, paper))
    found = {number: side for page in rendered for number, side in sides_mm(page, family).items()}
    assert len(rendered) == count
    assert sorted(found) == sorted(ids)
    assert list(found.values()) == pytest.approx([size_mm] * len(found), rel=0.005)


def test_every_marker_says_its_id_family_and_size() -> None:
    (text,) = texts(marker_sheet("DICT_4X4_50", [7, 23], 60.0, SheetSize.A4))
    assert {"id 7", "id 23"} <= set(text.splitlines())
    assert text.splitlines().count("DICT_4X4_50, 60 mm") == 2


@pytest.mark.parametrize("paper", list(SheetSize))
def test_pages_have_the_paper_s_size_and_ask_not_to_be_scaled(paper: SheetSize) -> None:
    pdf = marker_sheet("DICT_4X4_50", [1], 80.0, paper)
    with pypdfium2.PdfDocument(pdf) as document:
        size_mm = [points * 25.4 / 72 for points in document[0].get_size()]
    assert size_mm == pytest.approx({SheetSize.A4: (210, 297), SheetSize.LETTER: (215.9, 279.4)}[paper], abs=0.1)
    assert b"/PrintScaling /None" in pdf


@pytest.mark.parametrize(
    "pdf", [marker_sheet("DICT_4X4_50", range(9), 80.0, SheetSize.A4), board_sheet(Board(), SheetSize.A4)]
)
def test_every_page_has_a_ruler_of_100_mm_and_the_advice(pdf: bytes) -> None:
    for page, text in zip(pages(pdf), texts(pdf), strict=True):
        assert "Measure this: 100 mm" in text
        assert "100 %" in text
        runs = [row for row in page if longest_run(row) * MM_PER_PX == pytest.approx(100, abs=0.3)]
        assert runs, "no line of 100 mm"


def longest_run(row: np.ndarray) -> int:
    edges = np.flatnonzero(np.diff(np.r_[False, row < 128, False].astype(int)))
    return int((edges[1::2] - edges[::2]).max(initial=0))


@pytest.mark.parametrize("paper", list(SheetSize))
def test_the_board_is_found_whole_in_true_size(paper: SheetSize) -> None:
    board = Board()
    (page,) = pages(board_sheet(board, paper))
    corners, ids, _, _ = cv2.aruco.CharucoDetector(board.opencv).detectBoard(page)
    assert np.ravel(ids).tolist() == list(range(24))
    found_m = np.reshape(corners, (-1, 2)) * MM_PER_PX / 1000
    true_m = board.corners_m[:, :2]
    assert found_m - found_m[0] == pytest.approx(true_m - true_m[0], abs=0.1e-3)


def test_a_family_may_be_named_for_short() -> None:
    short, whole = (marker_sheet(name, [5], 50.0, SheetSize.A4) for name in ("apriltag_36h11", "DICT_APRILTAG_36h11"))
    assert short == whole


def test_the_same_sheet_is_the_same_file() -> None:
    assert marker_sheet("DICT_4X4_50", [1], 80.0, SheetSize.A4) == marker_sheet("DICT_4X4_50", [1], 80.0, SheetSize.A4)


REFUSED = [
    ("DICT_4X4_51", [1], 80.0, "not a marker family: use one of DICT_4X4_100"),
    ("DICT_4X4_50", [50], 80.0, "no marker 50: use ids from 0 to 49"),
    ("DICT_4X4_50", [], 80.0, "no marker ids"),
    ("DICT_4X4_50", [1], 170.0, "use markers of 10 to 160 mm"),
    ("DICT_4X4_50", [1], 5.0, "use markers of 10 to 160 mm"),
    ("DICT_4X4_50", [1], float("nan"), "use markers of 10 to 160 mm"),
    ("DICT_4X4_50", [1], float("inf"), "use markers of 10 to 160 mm"),
]


@pytest.mark.parametrize(("family", "ids", "size_mm", "reason"), REFUSED)
def test_what_cannot_be_printed_is_refused_with_what_can(family, ids, size_mm, reason) -> None:
    with pytest.raises(PatternError, match=reason):
        marker_sheet(family, ids, size_mm, SheetSize.A4)


def test_a_board_too_large_for_the_paper_is_refused() -> None:
    with pytest.raises(PatternError, match="does not fit on a4"):
        board_sheet(Board(square_m=0.045), SheetSize.A4)


@pytest.mark.parametrize(
    ("measures", "reason"),
    [
        ({"columns": 2}, "2x5 squares"),
        ({"marker_m": 0.04}, "smaller than the squares"),
        ({"family": "DICT_5X5"}, "not a marker family"),
        ({"columns": 20, "rows": 20}, "needs 200 markers"),
    ],
)
def test_an_impossible_board_is_refused(measures, reason) -> None:
    with pytest.raises(PatternError, match=reason):
        Board(**measures)
