"""The printable sheet of the calibration board."""

import numpy as np

from actum_calibrator.board import Board, PatternError, black_cells
from actum_calibrator.printed_sheet import BOLD, EDGE_MM, Sheet, document
from actum_calibrator.sheet_sizes import SheetSize

STRIP_MM = 15.0  # kept free below the board for the ruler
RULER_BOTTOM_MM = 8.5  # leaves room for the ruler's numbers above the edge that printers cannot reach
BESIDE_RULER_MM = 158.0  # from the ruler's left end to the text at its right, beyond the ruler's own text


def board_sheet(board: Board, sheet_size: SheetSize) -> bytes:
    """Write a PDF of the board in true size, on paper in landscape format.

    Raises:
        PatternError: the board does not fit the paper.
    """
    height, width = sheet_size.portrait_mm
    board_width, board_height = board.width_m * 1000, board.height_m * 1000
    if board_width > width - 2 * EDGE_MM or board_height > height - STRIP_MM - EDGE_MM:
        raise PatternError(
            f"a board of {board_width:g} x {board_height:g} mm does not fit on {sheet_size}: use smaller or fewer "
            "squares"
        )
    left, top = (width - board_width) / 2, height - (height - STRIP_MM - board_height + EDGE_MM) / 2

    def draw(sheet: Sheet) -> None:
        square, margin = board.square_m * 1000, board.margin_m * 1000
        rows, columns = np.indices((board.rows, board.columns))
        sheet.cells((rows + columns) % 2 == 0, left, top, square)
        white = [(row, column) for row in range(board.rows) for column in range(board.columns) if (row + column) % 2]
        for marker_id, (row, column) in enumerate(white):
            black = black_cells(board.family, marker_id)
            x, y = left + column * square + margin, top - row * square - margin
            sheet.cells(black, x, y, (square - 2 * margin) / len(black))
        _draw_foot(sheet, board, left)

    return document((width, height), f"actum calibration board, {board}", [draw])


def _draw_foot(sheet: Sheet, board: Board, left: float) -> None:
    sheet.ruler(left, RULER_BOTTOM_MM)
    beside = left + BESIDE_RULER_MM
    sheet.text(
        f"actum board: {board.columns}x{board.rows} squares of {board.square_m * 1000:g} mm", beside, 10.7, 9, BOLD
    )
    sheet.text(f"{board.family}, markers {board.marker_m * 1000:g} mm", beside, 6.9, 8)
    sheet.text("Glue it to something flat and stiff.", beside, 3.5, 8)
