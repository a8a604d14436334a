"""The style of all pictures (fonts, colours for the colour-blind), parts that they share, and how they are saved."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font, get_font_names
from matplotlib.patheffects import withStroke

from actum.arrays import Floats
from actum_model_inspector.text_layout import on_one_line, wrapped

INK = "#222222"  # text and lines
FAINT = "#767676"  # secondary text and lines: contrast 4.5:1 on the paper
PAPER = "#ffffff"
RIGHT = "#d55e00"  # the actor's right on every figure; the colour-blind can distinguish it from the left
LEFT = "#0072b2"  # the actor's left
ACCENT = "#0072b2"
"""The data of a diagram."""

_HUES = (
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
    "#882255", "#999933", "#332288", "#44aa99", "#b8705c", "#6f6f6f",
)  # fmt: skip
"""Six of the Okabe-Ito palette, four of Tol's muted one, two more: the colour-blind can distinguish most of them."""
_LIGHTER = 0.45  # share of white in a colour that comes a second time
_TITLE_CHARACTERS_PER_IN = 8.5  # letters of a title
_WIDER_SCRIPTS = (
    "Noto Sans CJK JP", "Noto Sans CJK SC", "Noto Sans Arabic", "Noto Sans Devanagari", "Noto Sans Thai", "Noto Emoji",
    "WenQuanYi Zen Hei", "Droid Sans Fallback", "Unifont", "Arial Unicode MS", "Hiragino Sans", "Apple SD Gothic Neo",
    "Yu Gothic", "Microsoft YaHei", "Malgun Gothic", "Nirmala UI", "Leelawadee UI",
)  # fmt: skip

STYLE: Any = {
    "font.family": ["DejaVu Sans", *(name for name in _WIDER_SCRIPTS if name in get_font_names())],
    "font.size": 9,
    "text.color": INK,
    "text.parse_math": False,
    "axes.edgecolor": FAINT,
    "axes.labelcolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlesize": 9,
    "axes.titlelocation": "left",
    "axes.titlecolor": FAINT,
    "axes.titlepad": 8,
    "figure.facecolor": PAPER,
    "figure.titlesize": 13,
    "figure.titleweight": "bold",
    "xtick.color": FAINT,
    "ytick.color": FAINT,
    "svg.fonttype": "none",
    "svg.hashsalt": "actum",
}
"""Matplotlib's parameters while a picture is made and while it is saved."""


@contextmanager
def in_house_style() -> Iterator[None]:
    """Return a context, or a decorator, in which pictures are made with `STYLE`, whatever parameters are in force.

    Letters that no font has are drawn as boxes; `missing_glyphs` names them.
    """
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph .* missing from font")
        yield


HALO = [withStroke(linewidth=2.5, foreground=PAPER)]
"""A white rim, so that letters can be read on any ground."""
DOTS_PER_INCH = 130  # a map of 10.5 inches is as wide as a usual screen


def figure_with_layout(width_in: float, height_in: float, title: str) -> Figure:
    """Return a new picture on which Matplotlib arranges the axes (constrained layout)."""
    return _titled(Figure(figsize=(width_in, height_in), layout="constrained"), title)


def figure_without_layout(width_in: float, height_in: float, title: str) -> Figure:
    """Return a new picture whose axes are placed with `axes_at`."""
    return _titled(Figure(figsize=(width_in, height_in)), title)


def _titled(figure: Figure, title: str) -> Figure:
    broken = wrapped(title, int(figure.get_figwidth() * _TITLE_CHARACTERS_PER_IN), lines=3)
    figure.suptitle(broken, x=0.005, ha="left")
    return figure


def axes_at(figure: Figure, left_in: float, bottom_in: float, width_in: float, height_in: float) -> Axes:
    """Add axes to a picture without layout, their frame at these inches."""
    width, height = figure.get_size_inches()
    return figure.add_axes((left_in / width, bottom_in / height, width_in / width, height_in / height))


def save(figure: Figure, path: Path) -> None:
    """Write a picture in the format that the file's ending names; the same picture makes the same file.

    Raises:
        OSError: the file cannot be written.
    """
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    with in_house_style():
        figure.savefig(path, dpi=DOTS_PER_INCH, metadata=metadata)


def missing_glyphs(text: str) -> str:
    """Return the letters that no font of this computer has, each once, sorted."""
    fonts = [get_font(findfont(family)) for family in STYLE["font.family"]]
    letters = sorted(set(on_one_line(text)))
    return "".join(letter for letter in letters if not any(font.get_char_index(ord(letter)) for font in fonts))


def draw_squares(axes: Axes, colours: Floats) -> None:
    """Draw a map's cells as squares, the first row on top.

    Args:
        axes: afterwards in units of the map, x the column and y, going down, the row.
        colours: (rows, cols, 3), RGB, 0 to 1.
    """
    rows, cols = colours.shape[:2]
    axes.pcolormesh(np.arange(cols + 1) - 0.5, np.arange(rows + 1) - 0.5, colours, edgecolors="face", linewidth=0.3)
    axes.set_xlim(-0.5, cols - 0.5)
    axes.set_ylim(rows - 0.5, -0.5)
    axes.set_aspect("equal")


def hide_axes(axes: Axes) -> None:
    """Remove frame and ticks."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)


def action_colours(actions: int) -> Floats:
    """Return one colour (RGB, 0 to 1) per action, shape (actions, 3); after the twelfth they repeat, lighter.

    Nobody can distinguish twenty colours, so a name stands beside every use of them.
    """
    hues = np.array([to_rgb(hue) for hue in _HUES])
    rounds, index = np.divmod(np.arange(actions), len(hues))
    return mixed_with_white(hues[index], np.where(rounds % 2, 1 - _LIGHTER, 1.0))


def mixed_with_white(colours: Floats, strength: Floats) -> Floats:
    """Mix colours (…, 3) with white: strength (…) 1 leaves them, 0 gives white. Shape (…, 3)."""
    mixed: Floats = 1 - np.asarray(strength)[..., None] * (1 - colours)
    return mixed
