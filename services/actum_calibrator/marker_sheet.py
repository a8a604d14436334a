"""The printable sheets of single markers to cut out."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from actum.arrays import Mask
from actum_calibrator.board import PatternError, black_cells, canonical
from actum_calibrator.printed_sheet import BOLD, EDGE_MM, REGULAR, Sheet, document, points_that_fit
from actum_calibrator.sheet_sizes import SheetSize

SMALLEST_MM = 10.0  # side of a marker: smaller ones are detected at arm's length at best
WHITE_SHARE = 1 / 8  # width of the white margin, as a share of a marker's side: about a cell, needed for detection
LEAST_WHITE_MM = 3.0  # least width of the white margin: needed for cutting with scissors
LABEL_MM = 8.0  # height of the two lines below a marker
HEAD_MM = 13.0  # kept free above the markers, for the heading
FOOT_MM = 22.0  # kept free below the markers, for the ruler
RULER_BOTTOM_MM = 12.0  # leaves room for the ruler's numbers above the edge that printers cannot reach
LEFT_MM = 10.0  # left end of heading and ruler
CUT_MM = 2.5  # length of a cut mark
CUT_LINE_MM = 0.15  # its thickness: a hair line


@dataclass(frozen=True)
class Tile:
    """The piece to cut out: a marker with its white margin, and its label below."""

    size_mm: float

    @property
    def white_mm(self) -> float:
        """Width of the white margin around the marker, which detection needs."""
        return max(LEAST_WHITE_MM, self.size_mm * WHITE_SHARE)

    @property
    def width_mm(self) -> float:
        """Whole width."""
        return self.size_mm + 2 * self.white_mm

    @property
    def height_mm(self) -> float:
        """Whole height."""
        return self.width_mm + LABEL_MM

    def draw(self, sheet: Sheet, black: Mask, left: float, top: float, label: tuple[str, str]) -> None:
        """Draw marker, label and cut marks."""
        sheet.cells(black, left + self.white_mm, top - self.white_mm, self.size_mm / len(black))
        bottom, start = top - self.height_mm, left + self.white_mm
        inside = self.size_mm + self.white_mm - 1
        for text, font, largest, above in ((label[0], BOLD, 10, 5.6), (label[1], REGULAR, 8, 2.2)):
            sheet.text(text, start, bottom + above, points_that_fit(text, inside, font, largest), font)
        for x, inwards_x in ((left, CUT_MM), (left + self.width_mm, -CUT_MM)):
            for y, inwards_y in ((bottom, CUT_MM), (bottom + self.height_mm, -CUT_MM)):
                sheet.line((x, y), (x + inwards_x, y), CUT_LINE_MM)
                sheet.line((x, y), (x, y + inwards_y), CUT_LINE_MM)


def marker_sheet(family: str, ids: Sequence[int], size_mm: float, sheet_size: SheetSize) -> bytes:
    """Write a PDF of markers in true size; `size_mm` is the side of the black square.

    Raises:
        PatternError: the family or an id is unknown, or the markers do not fit the paper.
    """
    family = canonical(family)
    cells = {number: black_cells(family, number) for number in ids}
    if not cells:
        raise PatternError("no marker ids are given: give at least one id")
    tile = Tile(size_mm)
    columns, rows = _grid(tile, sheet_size)
    numbers, each = list(cells), columns * rows
    pages = [numbers[start : start + each] for start in range(0, len(numbers), each)]

    def draw_page(sheet: Sheet, page: int) -> None:
        _head_and_foot(sheet, f"{family}, {size_mm:g} mm", f"page {page + 1} of {len(pages)}")
        first_left = (sheet.width_mm - columns * tile.width_mm) / 2
        for place, number in enumerate(pages[page]):
            left = first_left + place % columns * tile.width_mm
            top = sheet.height_mm - HEAD_MM - place // columns * tile.height_mm
            tile.draw(sheet, cells[number], left, top, (f"id {number}", f"{family}, {size_mm:g} mm"))

    drawers = [lambda sheet, page=page: draw_page(sheet, page) for page in range(len(pages))]
    return document(sheet_size.portrait_mm, f"actum markers {family} {size_mm:g} mm", drawers)


def _grid(tile: Tile, sheet_size: SheetSize) -> tuple[int, int]:
    """Return the numbers of columns and rows of tiles on a sheet.

    Raises:
        PatternError: no tile fits the sheet, or the markers would be too small to be detected.
    """
    width, height = sheet_size.portrait_mm
    is_printable = math.isfinite(tile.size_mm) and tile.size_mm >= SMALLEST_MM
    columns = int((width - 2 * EDGE_MM) // tile.width_mm) if is_printable else 0
    rows = int((height - HEAD_MM - FOOT_MM) // tile.height_mm) if is_printable else 0
    if columns * rows == 0:
        largest = int((width - 2 * EDGE_MM) / (1 + 2 * WHITE_SHARE))
        raise PatternError(
            f"markers of {tile.size_mm:g} mm cannot be printed on {sheet_size}: use markers of {SMALLEST_MM:g} to "
            f"{largest} mm, which leaves room for a white margin around each marker"
        )
    return columns, rows


def _head_and_foot(sheet: Sheet, what: str, page: str) -> None:
    top = sheet.height_mm - 9
    sheet.text("actum markers", LEFT_MM, top, 10, BOLD)
    sheet.text(f"{what} (side of the black square). Cut along the marks, keep the white edge.", LEFT_MM + 28, top, 9)
    sheet.text(page, sheet.width_mm - LEFT_MM - 18, top, 8)
    sheet.ruler(LEFT_MM, RULER_BOTTOM_MM)
