"""The picture of the confusion matrix."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.arrays import Indices
from actum_model_inspector.style import (
    FAINT,
    INK,
    PAPER,
    draw_squares,
    figure_with_layout,
    hide_axes,
    in_house_style,
)
from actum_model_inspector.text_layout import wrapped
from actum_model_trainer.evaluation import Evaluation, wilson_interval

CELL_IN = 0.42  # side of a cell: room for three digits
NAME_COLUMNS = 24  # width of a line of an action's name, in small letters
SHADES = mpl.colormaps["Blues"]
_DARKEST = 0.85  # of the colour map: beyond, black ink could not be distinguished from the ground
_WHITE_INK_FROM = 0.55  # share of the row from which on a count is written in white


@in_house_style()
def confusion_picture(evaluation: Evaluation) -> Figure:
    """Draw counts by action done (rows) and answered (columns), shaded by their share of the row."""
    counts, names = _counts(evaluation)
    rows, cols = counts.shape
    low, high = wilson_interval(evaluation.correct, evaluation.n)
    interval = f"95 % interval {low:.0%}–{high:.0%}"
    title = f"{evaluation.accuracy:.1%} recognised: {evaluation.correct} of {evaluation.n} ({interval})"
    figure = figure_with_layout(max(CELL_IN * cols + 3.2, 7.0), CELL_IN * rows + 2.6, title)
    axes = figure.add_subplot()
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1)
    draw_squares(axes, SHADES(_DARKEST * shares)[..., :3])
    for (row, col), count in np.ndenumerate(counts):
        if count:
            colour = PAPER if shares[row, col] > _WHITE_INK_FROM else INK
            axes.text(col, row, str(count), ha="center", va="center", color=colour)
    _name_rows_and_columns(axes, evaluation, names)
    axes.set_title(
        "row: what was done; column: what it was taken for; diagonal: right; shade: share of the row", wrap=True
    )
    return figure


def _counts(evaluation: Evaluation) -> tuple[Indices, list[str]]:
    """Return the confusion matrix, with a column for rejections where there are any, and the columns' names."""
    rejected = [score.rejected for score in evaluation.per_class.values()]
    counts = np.array(evaluation.confusion, dtype=np.intp)
    if not any(rejected):
        return counts, evaluation.labels
    return np.column_stack([counts, rejected]), [*evaluation.labels, "(rejected)"]


def _name_rows_and_columns(axes: Axes, evaluation: Evaluation, names: list[str]) -> None:
    hide_axes(axes)
    rows = range(len(evaluation.labels))
    axes.set_xticks(
        range(len(names)),
        [wrapped(name, NAME_COLUMNS) for name in names],
        rotation=50,
        ha="right",
        rotation_mode="anchor",
    )
    axes.set_yticks(rows, [wrapped(label, NAME_COLUMNS) for label in evaluation.labels])
    axes.tick_params(length=0, labelcolor=INK)
    for row, score in zip(rows, evaluation.per_class.values(), strict=True):
        share = f"{score.accuracy:.0%}" if score.n else "not done"
        axes.text(len(names) - 0.35, row, share, va="center", color=FAINT)
    for edge in range(len(names) + 1):
        axes.axvline(edge - 0.5, color="#e8e8e8", linewidth=0.6)
    for edge in range(len(rows) + 1):
        axes.axhline(edge - 0.5, color="#e8e8e8", linewidth=0.6)
