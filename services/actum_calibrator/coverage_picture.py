"""A picture of a calibration: image coverage, residuals of the corners, each view's error and tilt."""

import io
import math
from collections.abc import Sequence

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from actum.arrays import Array
from actum_calibrator.board_views import View
from actum_calibrator.intrinsics import Intrinsics
from actum_calibrator.view_set import CELLS

WIDTH = 900  # px, width of the drawn image
PANEL = 400  # px, width of the column of figures beside it
EDGE = 28  # px around both
TOP = 64  # px kept free for the title
ARROW = 22.0  # px: about the drawn length of a large residual, the 95th percentile
FINE = 2  # oversampling in each direction, which makes lines smooth
MOST_ROWS = 24  # views listed; the worst stand first
INK = "#1c2833"
FAINT = "#7f8c8d"
ARROWS = "#c0392b"
CORNER = "#2471a3"
COVERED = "#dff0e4"
EMPTY = "#f7e4e1"
OUTLINE = "#a9b7c0"
BAR = "#7fb3d5"


class Drawing:
    """An oversampled canvas, which makes lines smooth; coordinates are pixels of the result."""

    def __init__(self, width: int, height: int) -> None:
        self._image = Image.new("RGB", (width * FINE, height * FINE), "white")
        self._draw = ImageDraw.Draw(self._image)
        self._size = (width, height)

    def line(self, points: Sequence[tuple[float, float]], colour: str, thickness: float = 1.0) -> None:
        """Draw a polyline."""
        self._draw.line(
            [(x * FINE, y * FINE) for x, y in points],
            fill=colour,
            width=max(1, round(thickness * FINE)),
        )

    def box(self, left: float, top: float, right: float, bottom: float, colour: str) -> None:
        """Fill a rectangle."""
        self._draw.rectangle((left * FINE, top * FINE, right * FINE, bottom * FINE), fill=colour)

    def dot(self, x: float, y: float, radius: float, colour: str) -> None:
        """Fill a circle."""
        fine = [(value) * FINE for value in (x - radius, y - radius, x + radius, y + radius)]
        self._draw.ellipse(fine, fill=colour)

    def text(self, x: float, y: float, text: str, size: int = 14, colour: str = INK, anchor: str = "la") -> None:
        """Write one line; the anchor is Pillow's."""
        self._draw.text((x * FINE, y * FINE), text, colour, ImageFont.load_default(size * FINE), anchor)

    def png(self) -> bytes:
        """Encode the picture."""
        file = io.BytesIO()
        self._image.resize(self._size, Image.Resampling.LANCZOS).save(file, "PNG", optimize=True)
        return file.getvalue()


def coverage_picture(intrinsics: Intrinsics, views: Sequence[View]) -> bytes:
    """Draw a calibration as PNG."""
    scale = WIDTH / intrinsics.size[0]
    height = round(intrinsics.size[1] * scale)
    drawing = Drawing(WIDTH + PANEL + 2 * EDGE, max(height + TOP + 64, TOP + 276 + 20 * min(len(views), MOST_ROWS)))
    drawing.text(EDGE, 18, "Camera calibration", 22)
    drawing.text(
        EDGE,
        45,
        f"{intrinsics.size[0]}x{intrinsics.size[1]} image, where the board was and how its corners fit",
        14,
        FAINT,
    )
    columns, rows = CELLS
    for row, column in np.ndindex(rows, columns):
        left, top = EDGE + column * WIDTH / columns, TOP + row * height / rows
        colour = COVERED if intrinsics.covered[row, column] else EMPTY
        drawing.box(left, top, left + WIDTH / columns - 1, top + height / rows - 1, colour)
    _draw_views(drawing, views, scale)
    magnification = _magnification(intrinsics.residuals_px)
    _draw_residuals(drawing, intrinsics.residuals_px, views, scale, magnification)
    _draw_legend(drawing, height + TOP + 14, magnification)
    _draw_figures(drawing, intrinsics, views, WIDTH + 2 * EDGE)
    return drawing.png()


def _draw_views(drawing: Drawing, views: Sequence[View], scale: float) -> None:
    for view in views:
        hull = cv2.convexHull(view.corners_px.astype(np.float32)).reshape(-1, 2)
        outline = [(EDGE + float(x) * scale, TOP + float(y) * scale) for x, y in [*hull, hull[0]]]
        drawing.line(outline, OUTLINE, 0.5)


def _draw_residuals(
    drawing: Drawing, residuals_px: Sequence[Array], views: Sequence[View], scale: float, magnification: float
) -> None:
    for view, residuals in zip(views, residuals_px, strict=True):
        for corner, residual in zip(view.corners_px, residuals, strict=True):
            x, y = EDGE + corner[0] * scale, TOP + corner[1] * scale
            dx, dy = residual * magnification * scale
            drawing.line([(x, y), (x + dx, y + dy)], ARROWS, 1.0)
            drawing.dot(x, y, 1.7, CORNER)


def _magnification(residuals_px: Sequence[Array]) -> float:
    """Choose the magnification of residuals (n, 2): 1, 2 or 5 times a power of ten."""
    large = float(np.percentile(np.linalg.norm(np.vstack(residuals_px), axis=1), 95))
    wanted = ARROW / max(large, 1e-6)
    power = 10.0 ** math.floor(math.log10(wanted))
    return float(max(step * power for step in (1, 2, 5) if step * power <= wanted))


def _draw_legend(drawing: Drawing, top: float, magnification: float) -> None:
    drawing.box(EDGE, top, EDGE + 16, top + 12, COVERED)
    drawing.text(EDGE + 22, top - 2, "board was here", 13)
    drawing.box(EDGE + 140, top, EDGE + 156, top + 12, EMPTY)
    drawing.text(EDGE + 162, top - 2, "never here", 13)
    drawing.dot(EDGE + 262, top + 6, 2.5, CORNER)
    drawing.text(EDGE + 271, top - 2, "corner found", 13)
    drawing.line([(EDGE + 374, top + 6), (EDGE + 394, top + 6)], ARROWS, 1.5)
    drawing.text(EDGE + 401, top - 2, f"its residual, {magnification:g} times as long", 13)
    advice = (
        "Good: arrows of all directions. Bad: arrows in one sense over an area (board not flat, or another lens model)."
    )
    drawing.text(EDGE, top + 22, advice, 13, FAINT)


def _draw_figures(drawing: Drawing, intrinsics: Intrinsics, views: Sequence[View], left: float) -> None:
    fx, cx, fy, cy = intrinsics.matrix[0, 0], intrinsics.matrix[0, 2], intrinsics.matrix[1, 1], intrinsics.matrix[1, 2]
    deviations = intrinsics.deviations_px
    rows = [
        ("RMS", f"{intrinsics.rms_px:.3f} px", f"{len(views)} views, {sum(len(v.ids) for v in views)} corners"),
        ("fx", f"{fx:.1f} ± {deviations[0]:.1f} px", f"{deviations[0] / fx:.2%}"),
        ("fy", f"{fy:.1f} ± {deviations[1]:.1f} px", f"{deviations[1] / fy:.2%}"),
        ("cx", f"{cx:.1f} ± {deviations[2]:.1f} px", ""),
        ("cy", f"{cy:.1f} ± {deviations[3]:.1f} px", ""),
        ("coverage", f"{intrinsics.coverage:.0%}", "of the image"),
    ]
    for row, (name, value, remark) in enumerate(rows):
        y = TOP + 24 * row
        drawing.text(left, y, name, 15, FAINT)
        drawing.text(left + 80, y, value, 15)
        drawing.text(left + 236, y, remark, 13, FAINT)
    drawing.text(left, TOP + 152, "distortion k1 k2 p1 p2 k3", 13, FAINT)
    drawing.text(left, TOP + 170, "  ".join(f"{value:.4f}" for value in intrinsics.distortion), 14)
    _draw_view_bars(drawing, intrinsics, views, left, TOP + 212)


def _draw_view_bars(drawing: Drawing, intrinsics: Intrinsics, views: Sequence[View], left: float, top: float) -> None:
    """List each view with its RMS error and tilt, the worst first."""
    drawing.text(left, top, "view", 13, FAINT)
    drawing.text(left + 180, top, "RMS (px)", 13, FAINT)
    drawing.text(left + PANEL - 20, top, "tilt (deg)", 13, FAINT, "ra")
    rows = sorted(zip(intrinsics.rms_of_views_px(), views, intrinsics.tilts_deg, strict=True), key=lambda row: -row[0])
    longest = max(rows[0][0], 1e-9)
    for row, (error, view, tilt) in enumerate(rows[:MOST_ROWS]):
        y = top + 22 + 20 * row
        drawing.text(left, y, view.name if len(view.name) <= 24 else f"{view.name[:11]}…{view.name[-12:]}", 13)
        drawing.box(left + 180, y + 2, left + 180 + 90 * error / longest, y + 14, BAR)
        drawing.text(left + 276, y, f"{error:.3f}", 13)
        drawing.text(left + PANEL - 20, y, f"{tilt:.0f}", 13, INK, "ra")
    if len(rows) > MOST_ROWS:
        drawing.text(left, top + 22 + 20 * MOST_ROWS, f"and {len(rows) - MOST_ROWS} more", 13, FAINT)
