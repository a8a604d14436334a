"""The second map as a country of actions, and where on it segments come to lie."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from numpy.typing import NDArray

from actum.som import Som
from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.label_placement import LabelSpace, text_size
from actum_model_inspector.model_maps import Floats, ModelMaps
from actum_model_inspector.regions import Regions, centre, largest_component, regions
from actum_model_inspector.style import HALO, INK, PAPER, action_colours, bare, canvas, in_house_style, paler, tiles
from actum_model_inspector.text_layout import lines_of

SIDE_IN = 10.0
PALEST = 0.15
NAME_PT, MISTAKE_PT = 10.0, 6.5
BOLD = 1.15


@in_house_style
def action_map(maps: ModelMaps, segments: Sequence[AnsweredSegment] = ()) -> Figure:
    """Colour each unit by the action whose neuron answers most there, and put a dot where each segment fell."""
    som, labels = maps.actions, maps.model.labels
    found = regions(maps.answers(), som.grid)
    longest = max(som.rows, som.cols)
    size = max(SIDE_IN * som.cols / longest, 6.0), max(SIDE_IN * som.rows / longest, 3.0) + 0.85
    figure = canvas(*size, f"The map of actions: {som.rows} × {som.cols} units, {len(labels)} actions")
    axes = figure.add_subplot()
    _draw_regions(axes, found, len(labels))
    dots = [segment for segment in segments if segment.place is not None]
    room = LabelSpace((-0.5, -0.5, som.cols - 0.5, som.rows - 0.5))
    _name_regions(axes, found, labels, room)
    _draw_dots(axes, som, dots, room)
    axes.set_title(_legend(dots))
    homeless = [label for index, label in enumerate(labels) if not (found.actions == index).any()]
    if homeless:
        axes.set_xlabel(f"without a place of their own: {lines_of(', '.join(homeless), 110)}", loc="left")
    return figure


def borders(actions: NDArray[np.intp]) -> list[Floats]:
    """Return the edges, each two points (x, y), between neighbouring units (rows, cols) of different actions."""
    rows, cols = np.nonzero(actions[:, 1:] != actions[:, :-1])
    upright = [np.array([[col + 0.5, row - 0.5], [col + 0.5, row + 0.5]]) for row, col in zip(rows, cols, strict=True)]
    rows, cols = np.nonzero(actions[1:] != actions[:-1])
    level = [np.array([[col - 0.5, row + 0.5], [col + 0.5, row + 0.5]]) for row, col in zip(rows, cols, strict=True)]
    return upright + level


def beside_each_other(units: NDArray[np.intp]) -> Floats:
    """Return how far aside (x, y) to put each dot so that those on the same unit do not hide one another, (n, 2)."""
    aside = np.zeros((len(units), 2))
    for unit in np.unique(units):
        same = np.flatnonzero(units == unit)
        turn = np.arange(len(same)) * np.pi * (3 - np.sqrt(5))
        radius = 0.42 * np.sqrt(np.arange(len(same)) / max(len(same) - 1, 1))
        aside[same] = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=1)
    return aside


def _draw_regions(axes: Axes, found: Regions, actions: int) -> None:
    strength = PALEST + (1 - PALEST) * found.decided
    tiles(axes, paler(action_colours(actions)[found.actions], strength))
    axes.add_collection(LineCollection(borders(found.actions), colors=PAPER, linewidths=2.0))
    bare(axes)


def _name_regions(axes: Axes, found: Regions, labels: Sequence[str], room: LabelSpace) -> None:
    """Write each action's name into its largest patch."""
    for index, label in enumerate(labels):
        patch = largest_component(found.actions == index)
        if not len(patch):
            continue
        row, col = centre(patch)
        name = lines_of(label, 14)
        width, height = text_size(name, BOLD * _in_units(NAME_PT, found.actions.shape))
        x, y = room.within(col, row, width, height)
        x, y = room.place(((x, y + shift * height) for shift in (0, -0.5, 0.5, -1, 1)), width, height) or (x, y)
        axes.text(
            x, y, name, ha="center", va="center", weight="bold", path_effects=HALO, fontsize=NAME_PT, linespacing=0.95,
            zorder=5, in_layout=False,
        )  # fmt: skip


def _draw_dots(axes: Axes, som: Som, dots: Sequence[AnsweredSegment], room: LabelSpace) -> None:
    """Draw a dot per segment, those on one unit side by side, the wrong ones ringed and named."""
    units = np.array([dot.place for dot in dots], dtype=np.intp)
    places = som.coordinates[units][:, ::-1] + beside_each_other(units)
    wrong = np.array([dot.label is not None and not dot.correct for dot in dots], dtype=bool)
    x, y = places.T
    axes.scatter(x, y, s=13, c=INK, edgecolors=PAPER, linewidths=0.6, zorder=3)
    axes.scatter(x[wrong], y[wrong], s=80, facecolors="none", edgecolors=INK, zorder=3)
    for unit in np.unique(units[wrong]):
        done = Counter(dot.label or "" for dot in dots if dot.place == unit and dot.label and not dot.correct)
        _name_mistakes(axes, som, int(unit), done, room)


def _name_mistakes(axes: Axes, som: Som, unit: int, done: Counter[str], room: LabelSpace) -> None:
    """Write beside a unit what was really done there, if there is room."""
    text = "\n".join(lines_of(label, 18, 1) + (f" × {n}" if n > 1 else "") for label, n in done.most_common())
    row, col = som.coordinates[unit]
    width, height = text_size(text, _in_units(MISTAKE_PT, (som.rows, som.cols)))
    middles = [
        (col + right * (0.45 + width / 2), row + down * (0.2 + height / 2)) for right in (1, -1) for down in (-1, 1)
    ]
    place = room.place([*middles, (col, row - 0.45 - height / 2), (col, row + 0.45 + height / 2)], width, height)
    if place is not None:
        axes.text(
            *place, text, fontsize=MISTAKE_PT, ha="center", va="center", path_effects=HALO, zorder=4, in_layout=False
        )  # fmt: skip


def _in_units(points: float, shape: tuple[int, ...]) -> float:
    return points * max(shape) / (72 * SIDE_IN)


def _legend(dots: Sequence[AnsweredSegment]) -> str:
    ground = "each unit in the colour of the action that answers most there; pale: hardly more than the next one"
    if not dots:
        return ground
    wrong = sum(dot.label is not None and not dot.correct for dot in dots)
    ringed = f", {wrong} of them ringed: taken for another action than the one named beside them" if wrong else ""
    return f"{ground}\n{len(dots)} dots: the segments{ringed}"
