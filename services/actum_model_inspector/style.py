"""How all pictures look: type, colours that do not rest on telling red from green, and how they are saved."""

import textwrap
import warnings
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any, ParamSpec

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.font_manager import findfont, get_font, get_font_names
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from actum_model_inspector.text_layout import lines_of, on_one_line

Floats = NDArray[Any]

INK, FAINT, PAPER = "#222222", "#767676", "#ffffff"
RIGHT, LEFT = "#d55e00", "#0072b2"
"""The actor's right and left, on every figure."""
ACCENT = "#0072b2"

_HUES = (
    "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
    "#882255", "#999933", "#332288", "#44aa99", "#b8705c", "#6f6f6f",
)  # fmt: skip
_LIGHTER = 0.45
_CHARACTERS_PER_IN, _TITLE_CHARACTERS_PER_IN = 14.0, 8.5
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

Arguments = ParamSpec("Arguments")


def in_house_style(make: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
    """Make pictures with these parameters, whatever others are in force."""

    @wraps(make)
    def made(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Figure:
        with mpl.rc_context(STYLE):
            return make(*args, **kwargs)

    return made


HALO = [withStroke(linewidth=2.5, foreground=PAPER)]
DOTS_PER_INCH = 130


def canvas(width_in: float, height_in: float, title: str) -> Figure:
    """Begin a picture that lays out its axes by itself."""
    return _titled(Figure(figsize=(width_in, height_in), layout="constrained"), title)


def board(width_in: float, height_in: float, title: str) -> Figure:
    """Begin a picture whose axes are put where they are to be, with `axes_at`."""
    return _titled(Figure(figsize=(width_in, height_in)), title)


def _titled(figure: Figure, title: str) -> Figure:
    broken = lines_of(title, figure.get_figwidth() * _TITLE_CHARACTERS_PER_IN, lines=3)
    figure.suptitle(broken, x=0.005, ha="left")
    return figure


def axes_at(figure: Figure, left_in: float, bottom_in: float, width_in: float, height_in: float) -> Axes:
    """Add axes whose frame lies at these inches of a picture that is not laid out by itself."""
    width, height = figure.get_size_inches()
    return figure.add_axes((left_in / width, bottom_in / height, width_in / width, height_in / height))


def save(figure: Figure, path: Path) -> None:
    """Write a picture in the format that the file's name says; the same picture makes the same file.

    Boxes stand for letters that no font has; `unwritable` names those.

    Raises:
        OSError: the file cannot be written.
    """
    metadata = {"Date": None} if path.suffix == ".svg" else {"Software": None}
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph .* missing from font")
        figure.savefig(path, dpi=DOTS_PER_INCH, metadata=metadata)


def unwritable(text: str) -> str:
    """Return the letters that no font of this computer has, each once; they are drawn as boxes."""
    fonts = [get_font(findfont(family)) for family in STYLE["font.family"]]
    letters = sorted(set(on_one_line(text)))
    return "".join(letter for letter in letters if not any(font.get_char_index(ord(letter)) for font in fonts))


def explain(axes: Axes, text: str, width_in: float) -> None:
    """Write above the axes how to read them."""
    axes.set_title("\n".join(textwrap.wrap(text, int(width_in * _CHARACTERS_PER_IN))))


def tiles(axes: Axes, colours: Floats) -> None:
    """Draw a square about each unit (column, row), first row on top, in its colour of (rows, cols, 3)."""
    rows, cols = colours.shape[:2]
    axes.pcolormesh(np.arange(cols + 1) - 0.5, np.arange(rows + 1) - 0.5, colours, edgecolors="face", linewidth=0.3)
    axes.set_xlim(-0.5, cols - 0.5)
    axes.set_ylim(rows - 0.5, -0.5)
    axes.set_aspect("equal")


def bare(axes: Axes) -> None:
    """Take frame and ticks off."""
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_visible(False)


def action_colours(actions: int) -> Floats:
    """Return one colour per action, shape (actions, 3); after the twelfth they come again, lighter.

    Nobody tells twenty colours apart: names stand beside them wherever they are used.
    """
    hues = np.array([to_rgb(hue) for hue in _HUES])
    rounds, index = np.divmod(np.arange(actions), len(hues))
    return paler(hues[index], np.where(rounds % 2, 1 - _LIGHTER, 1.0))


def paler(colours: Floats, strength: Floats) -> Floats:
    """Mix colours (…, 3) with white: at strength 1 as they are, at 0 white."""
    mixed: Floats = 1 - np.asarray(strength)[..., None] * (1 - colours)
    return mixed
