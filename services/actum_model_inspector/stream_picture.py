"""The picture of a stream: how fast people move, which segments are marked, and what was answered."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from rich.cells import cell_len

from actum.arrays import Array
from actum_model_inspector.style import (
    FAINT,
    HALO,
    INK,
    action_colours,
    axes_at,
    figure_without_layout,
    in_house_style,
)
from actum_model_inspector.text_layout import shortened

WIDTH_IN = 10.5  # of the picture, as of the others
LEFT_IN, RIGHT_IN = 0.75, 0.2  # beside the axes: room for the numbers and for the last time
TITLE_IN, FOOT_IN = 0.55, 0.5  # above the first and beneath the last row
NAMES_IN = 0.25  # above the first row, where there are several people
GAP_IN = 0.4  # between two rows: room for the times
SPEED_IN = 1.0  # height of a row's speeds
LANE_IN = 0.28  # height of a row's answers, beneath
ROW_S = 40.0  # seconds in a row: a segment of a second has room for a short name
MOST_ROWS = 15  # of a longer stream, the rows hold more
LETTER_IN = 0.058  # width of a small letter of a name
LEAST_ROOM = 3  # letters of a name: fewer say nothing
HEADROOM = 1.45  # height of the axes of speeds over the largest: room for the names


@dataclass(frozen=True)
class Span:
    """A stretch of the stream with what is said about it: start and end (s), a label, and a note that follows it."""

    start_s: float
    end_s: float
    label: str | None
    note: str = ""


@dataclass(frozen=True)
class Lane:
    """Answers in a row beneath the speeds: a short name beside it, and the answers."""

    name: str
    answers: Sequence[Span]


@dataclass(frozen=True, eq=False)
class SpeedLine:
    """How fast one person's joints move: times (n,) in s, speeds (n,) in m/s, root mean square over
    the joints, NaN where nobody saw them."""

    name: str
    times_s: Array
    speeds_mps: Array


@in_house_style()
def stream_picture(
    title: str, speeds: Sequence[SpeedLine], marked: Sequence[Span], lanes: Sequence[Lane], answers_of: str
) -> Figure:
    """Draw speeds, the first person's stronger, segments as bands (their notes are numbers), and lanes of answers.

    `answers_of` says in words who answered, where there are lanes.
    """
    end_s = max([1.0, *(float(line.times_s[-1]) for line in speeds), *(span.end_s for span in marked)])
    rows = min(math.ceil(end_s / ROW_S), MOST_ROWS)
    row_s, lanes_in = end_s / rows, LANE_IN * len(lanes)
    row_in = SPEED_IN + lanes_in + GAP_IN
    above_in = TITLE_IN + (NAMES_IN if len(speeds) > 1 else 0)
    figure = figure_without_layout(WIDTH_IN, above_in + rows * row_in - GAP_IN + FOOT_IN, title)
    labels = sorted({span.label for span in chain(marked, *(lane.answers for lane in lanes)) if span.label})
    colours = dict(zip(labels, action_colours(len(labels)), strict=True))
    tallest = HEADROOM * max([0.1, *(float(np.nanmax(line.speeds_mps)) for line in speeds)])
    for row in range(rows):
        shown_s = row * row_s, (row + 1) * row_s
        bottom_in = FOOT_IN + (rows - 1 - row) * row_in
        axes = _axes(figure, bottom_in + lanes_in, SPEED_IN, shown_s)
        _draw_speeds(axes, speeds, tallest)
        _draw_marked(axes, marked, colours, tallest)
        if row == 0:
            _name_people(axes, speeds)
        for below, lane in enumerate(lanes, start=1):
            axes.tick_params(labelbottom=False, bottom=False)
            axes = _axes(figure, bottom_in + lanes_in - below * LANE_IN, LANE_IN, shown_s)
            _draw_answers(axes, lane, colours)
    axes.set_xlabel("time since the start (s)" + (f"; strips: {answers_of}" if lanes else ""))
    return figure


def _axes(figure: Figure, bottom_in: float, height_in: float, shown_s: tuple[float, float]) -> Axes:
    axes = axes_at(figure, LEFT_IN, bottom_in, WIDTH_IN - LEFT_IN - RIGHT_IN, height_in)
    axes.set_xlim(*shown_s)
    return axes


def _draw_speeds(axes: Axes, speeds: Sequence[SpeedLine], tallest: float) -> None:
    for rank, line in enumerate(speeds):
        colour, width = (INK, 1.0) if rank == 0 else (FAINT, 0.6)
        axes.plot(line.times_s, line.speeds_mps, color=colour, linewidth=width)
    axes.set_ylim(0, tallest)
    axes.set_ylabel("speed (m/s)")
    axes.locator_params(axis="y", nbins=3)


def _draw_marked(axes: Axes, marked: Sequence[Span], colours: dict[str, Array], tallest: float) -> None:
    """Draw each segment as a band in its label's colour, with its number and as much of its label as there is room."""
    for span in marked:
        colour = colours[span.label] if span.label else to_rgba(FAINT)[:3]
        axes.axvspan(span.start_s, span.end_s, color=colour, alpha=0.3, linewidth=0)
        axes.vlines([span.start_s, span.end_s], 0, tallest, color=colour, linewidth=1.0)
        room = _room(axes, span)
        name = f"{span.note}\n{shortened(span.label or '(no label)', room)}" if room >= LEAST_ROOM else span.note
        _write(axes, span, 0.98 * tallest, name, "top")


def _draw_answers(axes: Axes, lane: Lane, colours: dict[str, Array]) -> None:
    """Draw each answer as a strip in its action's colour; what was rejected is an empty strip."""
    for span in lane.answers:
        colour = colours[span.label] if span.label else np.ones(3)
        axes.barh(0.5, span.end_s - span.start_s, 1.0, span.start_s, color=colour, edgecolor=FAINT, linewidth=0.6)
        name = f"{span.label} {span.note}".strip() if span.label else span.note
        room = _room(axes, span)
        if room >= LEAST_ROOM:
            _write(axes, span, 0.5, name if cell_len(name) <= room else shortened(span.label or name, room), "center")
    axes.set_ylim(0, 1)
    axes.set_yticks([0.5], [lane.name])
    axes.tick_params(axis="y", length=0)


def _write(axes: Axes, span: Span, height: float, text: str, align: str) -> None:
    """Write a text in the middle of the part of a span that the axes show."""
    start_s, end_s = np.clip([span.start_s, span.end_s], *axes.get_xlim())
    if start_s < end_s:
        middle_s = (start_s + end_s) / 2
        axes.text(middle_s, height, text, ha="center", va=align, fontsize=7, path_effects=HALO, clip_on=True)


def _room(axes: Axes, span: Span) -> int:
    """Return how many small letters fit beside one another into the part of a span that the axes show."""
    low, high = axes.get_xlim()
    shown_s = float(np.diff(np.clip([span.start_s, span.end_s], low, high))[0])
    return int(shown_s / (high - low) * (WIDTH_IN - LEFT_IN - RIGHT_IN) / LETTER_IN)


def _name_people(axes: Axes, speeds: Sequence[SpeedLine]) -> None:
    """Say above the first row which line is whose, where there are several people."""
    if len(speeds) > 1:
        lines = [Line2D([], [], color=INK if rank == 0 else FAINT) for rank in range(2)]
        others = ", ".join(line.name for line in speeds[1:])
        axes.legend(lines, [speeds[0].name, others], loc="lower left", bbox_to_anchor=(0, 1), ncols=2, frameon=False)
