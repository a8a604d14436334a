"""A waterfall chart: the terms of a sum as bars, each beginning where the one before ends, explained in words."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from actum_model_inspector.style import FAINT, INK, hide_axes

POSITIVE = "#4d9221"  # green
NEGATIVE = "#9a4fa8"  # purple, which the colour-blind can tell from green
TERM_IN = 0.22  # height of a row: a line of text with some air
NAMES_IN = 1.0  # width of the terms' names
BARS_IN = 3.2  # width of the bars
VALUES_IN = 0.55  # width of the values: a sign and four characters


@dataclass(frozen=True)
class Term:
    """A term of a sum.

    Attributes:
        name: in a word or two.
        value: the amount that it adds.
        meaning: a sentence that explains it.
    """

    name: str
    value: float
    meaning: str


def draw_waterfall(axes: Axes, terms: Sequence[Term], total: Term) -> None:
    """Draw the terms as bars, row beneath row, and their sum beneath; the axes' unit is an inch."""
    ends = np.cumsum([term.value for term in terms])
    starts = np.concatenate([[0.0], ends[:-1], [0.0]])
    least, most = min(0.0, float(ends.min())), max(0.0, float(ends.max()))
    in_per_score = BARS_IN / max(most - least, 1e-9)
    zero_in = NAMES_IN - least * in_per_score
    for row, (term, start) in enumerate(zip([*terms, total], starts, strict=True)):
        middle = (row + 0.5) * TERM_IN
        corner = zero_in + start * in_per_score, (row + 0.15) * TERM_IN
        colour = POSITIVE if term.value >= 0 else NEGATIVE
        axes.add_patch(Rectangle(corner, term.value * in_per_score, 0.7 * TERM_IN, facecolor=colour))
        weight = "bold" if term is total else "normal"
        axes.text(0.0, middle, term.name, va="center", weight=weight)
        values_end = NAMES_IN + BARS_IN + VALUES_IN
        axes.text(values_end, middle, f"{term.value:+.2f}", va="center", ha="right", weight=weight)
        axes.text(values_end + 0.2, middle, term.meaning, va="center", color=FAINT)
    bottom = (len(terms) + 1) * TERM_IN
    axes.plot([zero_in, zero_in], [0.0, bottom], color=INK, linewidth=0.8)
    axes.set_ylim(bottom, 0.0)
    hide_axes(axes)
