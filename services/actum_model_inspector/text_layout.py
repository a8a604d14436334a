"""Breaking and shortening of names of any length and script to the width there is for them."""

from itertools import accumulate
from unicodedata import category, east_asian_width

MAX_COLUMNS = 24  # of a name on one line, unless said otherwise
_WIDE = 2.0  # columns of an ideograph: East Asian fonts are twice as wide
_CAPITAL = 1.25  # columns of a capital, about
_BREAK_AFTER = "_-/"
"""Where a name without spaces is broken rather than within a word."""


def columns(text: str) -> float:
    """Return about how wide a line is, in columns: the width of a small Latin letter."""
    return sum(map(_columns_of, text))


def on_one_line(text: str) -> str:
    """Return the text with control characters and runs of white space replaced by single spaces."""
    return " ".join("".join(" " if category(letter) == "Cc" else letter for letter in text).split())


def shortened(text: str, width: float = MAX_COLUMNS) -> str:
    """Return a name on one line, its end replaced by an ellipsis where it is wider than `width` columns."""
    line = on_one_line(text)
    return line if columns(line) <= width else _start(line, width - 1).rstrip() + "…"


def wrapped(text: str, width: float, lines: int = 2) -> str:
    """Break a name into at most `lines` lines of `width` columns, its end cut off where it does not fit."""
    full_lines: list[str] = []
    rest = on_one_line(text)
    while columns(rest) > width and len(full_lines) < lines - 1:
        end = _end_of_line(rest, width)
        full_lines.append(rest[:end].rstrip())
        rest = rest[end:].lstrip()
    return "\n".join([*full_lines, shortened(rest, width)])


def _end_of_line(text: str, width: float) -> int:
    """Return where to break a text that is too wide: between words, else within one."""
    fitting = len(_start(text, width))
    between = text.rfind(" ", 0, fitting + 1)
    within = max(text.rfind(mark, 0, fitting) for mark in _BREAK_AFTER)
    return max(between, within + 1) if max(between, within) > 0 else max(fitting, 1)


def _start(text: str, width: float) -> str:
    """Return as many letters as fit into a width."""
    reached = accumulate(map(_columns_of, text))
    return "".join(letter for letter, so_far in zip(text, reached, strict=True) if so_far <= width)


def _columns_of(letter: str) -> float:
    if category(letter) in ("Mn", "Me", "Cf"):
        return 0.0
    if east_asian_width(letter) in "WF":
        return _WIDE
    return _CAPITAL if letter.isupper() else 1.0
