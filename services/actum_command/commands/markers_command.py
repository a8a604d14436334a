"""`actum markers`: sheets to print."""

from pathlib import Path
from typing import Annotated

import typer

from actum.atomic_file import write_whole
from actum_calibrator.board import Board, PatternError
from actum_calibrator.sheet_sizes import SheetSize
from actum_command.commands.terminal import failing_on, refuse_unwritable, say

MOST_IDS = 1000  # as many as the largest family has


def markers(
    output: Annotated[Path, typer.Option("-o", "--output", help="the PDF file to write")],
    family: Annotated[
        str,
        typer.Option(help="the marker family (OpenCV dictionary) to print, such as DICT_4X4_50; ignored with --board"),
    ] = "DICT_4X4_50",
    ids: Annotated[
        str, typer.Option(help="ids of the markers to print, such as 1,2,3 or 0-9; ignored with --board")
    ] = "0-3",
    size_mm: Annotated[
        float, typer.Option(help="side length of the black square of a marker (mm); ignored with --board")
    ] = 80.0,
    paper: Annotated[SheetSize, typer.Option(help="paper size of the sheets")] = SheetSize.A4,
    board: Annotated[
        bool, typer.Option("--board", help="print the board that 'actum calibrate' needs, instead of markers")
    ] = False,
) -> None:
    """Write a PDF to print: markers to put on objects or, with --board, the board for calibrating cameras.

    Print the PDF at 100 %, without fitting it to the page, so that the sizes are right.
    """
    from actum_calibrator.board_sheet import board_sheet  # the PDF library is needed here alone
    from actum_calibrator.marker_sheet import marker_sheet

    refuse_unwritable(output, ".pdf")
    with failing_on(PatternError, OSError):
        pdf = board_sheet(Board(), paper) if board else marker_sheet(family, _numbers(ids), size_mm, paper)
        output.parent.mkdir(parents=True, exist_ok=True)
        write_whole(output, pdf)
    say(f"written to {output}: print it at 100 % ('actual size') and check that the printed ruler is 100 mm long")
    if board:
        say(f"the board has {Board()}; glue it to a flat, stiff surface")


def _numbers(text: str) -> list[int]:
    """Read numbers such as `1,2,5-8`.

    Raises:
        PatternError: it is no such text, or names too many.
    """
    numbers: list[int] = []
    for part in text.split(","):
        first, _, last = part.partition("-")
        try:
            span = range(int(first), int(last or first) + 1)
        except ValueError:
            raise PatternError(
                f"--ids contains {part!r}, which is neither a number nor a range: write ids such as 1,2,3 or 0-9"
            ) from None
        if not span:
            raise PatternError(
                f"--ids contains the range {part!r}, which begins with the larger number: begin with the smaller "
                "number, as in 0-9"
            )
        if len(numbers) + len(span) > MOST_IDS:
            raise PatternError(f"--ids names more than {MOST_IDS} markers: name at most {MOST_IDS}")
        numbers += span
    return numbers
