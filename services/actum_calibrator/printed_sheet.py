"""Drawing on printed sheets: text, a ruler to check the scale, cells as vector rectangles. Lengths are in mm."""

import io
from collections.abc import Callable, Sequence

import numpy as np
from reportlab.lib.units import mm
from reportlab.pdfbase.pdfmetrics import stringWidth
from reportlab.pdfgen.canvas import Canvas

from actum.arrays import Mask

EDGE_MM = 5.0  # margin that common printers cannot reach
RULER_MM = 100  # half a millimetre, which is visible, is half a per cent of it
ADVICE = ("Print at 100 % (“actual size”),", "without “fit to page”.")
REGULAR = "Helvetica"  # one of the fonts that every PDF viewer has
BOLD = "Helvetica-Bold"
TICK_MM = 0.1  # thickness of the ruler's lines


class Sheet:
    """One page to draw on; y points up from the paper's lower edge."""

    def __init__(self, canvas: Canvas, width_mm: float, height_mm: float) -> None:
        self._canvas = canvas
        self.width_mm = width_mm
        self.height_mm = height_mm

    def line(self, start: tuple[float, float], end: tuple[float, float], thickness: float) -> None:
        """Draw a straight line."""
        self._canvas.setLineWidth(thickness * mm)
        self._canvas.line(start[0] * mm, start[1] * mm, end[0] * mm, end[1] * mm)

    def text(self, text: str, left: float, bottom: float, points: float, font: str = REGULAR) -> None:
        """Write one line."""
        self._canvas.setFont(font, points)
        self._canvas.drawString(left * mm, bottom * mm, text)

    def centred(self, text: str, middle: float, bottom: float, points: float) -> None:
        """Write one line, centred at a horizontal position."""
        self._canvas.setFont(REGULAR, points)
        self._canvas.drawCentredString(middle * mm, bottom * mm, text)

    def cells(self, black: Mask, left: float, top: float, cell: float) -> None:
        """Fill the black cells (rows, columns) as one path, so that no renderer leaves hair lines between them."""
        path = self._canvas.beginPath()
        for row, blacks in enumerate(black.tolist()):
            edges = np.flatnonzero(np.diff([False, *blacks, False])).tolist()
            for start, end in zip(edges[::2], edges[1::2], strict=True):
                bottom = (top - (row + 1) * cell) * mm
                path.rect((left + start * cell) * mm, bottom, (end - start) * cell * mm, cell * mm)
        self._canvas.drawPath(path, stroke=0, fill=1)

    def ruler(self, left: float, bottom: float) -> None:
        """Draw a ruler of 100 mm, numbered below, with advice on printing to its right."""
        for tick in range(RULER_MM + 1):
            height = 4.0 if tick % 10 == 0 else 2.8 if tick % 5 == 0 else 1.8
            self.line((left + tick, bottom), (left + tick, bottom + height), TICK_MM)
            if tick % 10 == 0:
                self.centred(str(tick), left + tick, bottom - 2.6, 6)
        ends = TICK_MM / 2
        self.line((left - ends, bottom), (left + RULER_MM + ends, bottom), 2 * TICK_MM)
        beside = left + RULER_MM + 7
        self.text("Measure this: 100 mm", beside, bottom + 2.2, 9, BOLD)
        for row, advice in enumerate(ADVICE):
            self.text(advice, beside, bottom - 1.6 - 3.4 * row, 8)


def document(size_mm: tuple[float, float], title: str, drawers: Sequence[Callable[[Sheet], None]]) -> bytes:
    """Write a PDF, one page for each drawer; viewers are asked not to scale it. The output is reproducible."""
    file = io.BytesIO()
    canvas = Canvas(file, pagesize=(size_mm[0] * mm, size_mm[1] * mm), invariant=1)
    canvas.setTitle(title)
    canvas.setAuthor("actum")
    canvas.setViewerPreference("PrintScaling", "None")
    for draw in drawers:
        draw(Sheet(canvas, *size_mm))
        canvas.showPage()
    canvas.save()
    return file.getvalue()


def points_that_fit(text: str, width_mm: float, font: str, largest: float) -> float:
    """Return the font size, at most `largest`, at which a text is at most `width_mm` wide."""
    return float(min(largest, largest * width_mm * mm / stringWidth(text, font, largest)))
