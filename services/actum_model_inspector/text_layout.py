"""Breaking and shortening of names of any length and script to the width there is for them."""

import re
from unicodedata import category

from rich.cells import cell_len
from rich.console import Console
from rich.text import Text

MAX_COLUMNS = 24  # of a name on one line, unless said otherwise; an ideograph takes two
_MARK = re.compile(r"(?<=[_/-])(?=\S)")
"""Where a name without spaces is broken rather than within a word."""


def on_one_line(text: str) -> str:
    """Return the text with control characters and runs of white space replaced by single spaces."""
    return " ".join("".join(" " if category(letter) == "Cc" else letter for letter in text).split())


def shortened(text: str, width: int = MAX_COLUMNS) -> str:
    """Return a name on one line, its end replaced by an ellipsis where it is wider than `width` columns."""
    line = Text(on_one_line(text))
    line.truncate(width, overflow="ellipsis")
    return line.plain


def wrapped(text: str, width: int, lines: int = 2) -> str:
    """Break a name into at most `lines` lines of `width` columns, its end cut off where it does not fit."""
    line = on_one_line(text)
    if cell_len(line) <= width:
        return line
    broken = Text(_MARK.sub(" ", line)).wrap(Console(), width, overflow="fold")
    names = [re.sub(r"(?<=[_/-]) ", "", each.plain.rstrip()) for each in broken]
    if len(names) > lines:
        names[lines - 1 :] = [shortened("".join(names[lines - 1 :]), width)]
    return "\n".join(names)
