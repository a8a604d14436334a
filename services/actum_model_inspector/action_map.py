"""The picture of the second map: its regions of actions, and the winners of segments on it."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from actum.arrays import Floats, Indices
from actum.som import Som
from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.label_placement import LabelSpace, text_size
from actum_model_inspector.regions import Regions, innermost_unit, largest_component, regions
from actum_model_inspector.style import (
    HALO,
    INK,
    PAPER,
    action_colours,
    draw_squares,
    figure_with_layout,
    hide_axes,
    in_house_style,
    mixed_with_white,
)
from actum_model_inspector.text_layout import wrapped
from som_classifier.model_maps import ModelMaps

SIDE_IN = 10.0  # inches of the map's longer side: names of 25 actions find room
PALEST = 0.15  # share of a unit's colour, the rest white, where two actions answer alike: still a hint of colour
NAME_PT = 10.0  # letters of an action's name: readable on a screen
MISTAKE_PT = 6.5  # letters of the names at wrong answers: smaller, as there may be many
BOLD = 1.15  # width of bold letters in units of plain ones


@in_house_style
def action_map(maps: ModelMaps, segments: Sequence[AnsweredSegment] = ()) -> Figure:
    """Colour each unit by the action whose neuron is most active for it, and put a dot on each segment's winner."""
    som, labels = maps.actions, maps.model.labels
    map_regions = regions(maps.unit_cosines(), som.grid)
    longest = max(som.rows, som.cols)
    size = max(SIDE_IN * som.cols / longest, 6.0), max(SIDE_IN * som.rows / longest, 3.0) + 0.85
    figure = figure_with_layout(*size, f"The map of actions: {som.rows} × {som.cols} units, {len(labels)} actions")
    axes = figure.add_subplot()
    _draw_regions(axes, map_regions, len(labels))
    dots = [segment for segment in segments if segment.action_unit is not None]
    space = LabelSpace((-0.5, -0.5, som.cols - 0.5, som.rows - 0.5))
    _name_regions(axes, map_regions, labels, space)
    _draw_dots(axes, som, dots, space)
    axes.set_title(_legend(dots))
    without_region = [label for index, label in enumerate(labels) if not (map_regions.actions == index).any()]
    if without_region:
        axes.set_xlabel(f"without a place of their own: {wrapped(', '.join(without_region), 110)}", loc="left")
    return figure


def borders(actions: Indices) -> list[Floats]:
    """Return the edges between neighbouring units of different actions, each as two points (x, y), shape (2, 2).

    Args:
        actions: (rows, cols), the action of each unit.
    """
    rows, cols = np.nonzero(actions[:, 1:] != actions[:, :-1])
    upright = [np.array([[col + 0.5, row - 0.5], [col + 0.5, row + 0.5]]) for row, col in zip(rows, cols, strict=True)]
    rows, cols = np.nonzero(actions[1:] != actions[:-1])
    level = [np.array([[col - 0.5, row + 0.5], [col + 0.5, row + 0.5]]) for row, col in zip(rows, cols, strict=True)]
    return upright + level


def spread_on_unit(units: Indices) -> Floats:
    """Return an offset (x, y) for the dot on each of some units (n,), so that those on one unit lie apart, (n, 2).

    They lie on a sunflower spiral: each a golden angle further, the radius rising with the root of the number.
    """
    offsets = np.zeros((len(units), 2))
    for unit in np.unique(units):
        same = np.flatnonzero(units == unit)
        angle = np.arange(len(same)) * np.pi * (3 - np.sqrt(5))
        radius = 0.42 * np.sqrt(np.arange(len(same)) / max(len(same) - 1, 1))
        offsets[same] = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return offsets


def _draw_regions(axes: Axes, map_regions: Regions, actions: int) -> None:
    strength = PALEST + (1 - PALEST) * map_regions.margins
    draw_squares(axes, mixed_with_white(action_colours(actions)[map_regions.actions], strength))
    axes.add_collection(LineCollection(borders(map_regions.actions), colors=PAPER, linewidths=2.0))
    hide_axes(axes)


def _name_regions(axes: Axes, map_regions: Regions, labels: Sequence[str], space: LabelSpace) -> None:
    """Write each action's name into the largest connected component of its region."""
    for index, label in enumerate(labels):
        component = largest_component(map_regions.actions == index)
        if not len(component):
            continue
        row, col = innermost_unit(component)
        name = wrapped(label, 14)
        width, height = text_size(name, BOLD * _in_units(NAME_PT, map_regions.actions.shape))
        x, y = space.moved_inside(col, row, width, height)
        x, y = space.place(((x, y + shift * height) for shift in (0, -0.5, 0.5, -1, 1)), width, height) or (x, y)
        axes.text(
            x, y, name, ha="center", va="center", weight="bold", path_effects=HALO, fontsize=NAME_PT, linespacing=0.95,
            zorder=5, in_layout=False,
        )  # fmt: skip


def _draw_dots(axes: Axes, som: Som, dots: Sequence[AnsweredSegment], space: LabelSpace) -> None:
    """Draw a dot per segment; one with a wrong answer gets a ring and the name of the action that was really done."""
    units = np.array([dot.action_unit for dot in dots], dtype=np.intp)
    places = som.coordinates[units][:, ::-1] + spread_on_unit(units)
    wrong = np.array([dot.label is not None and not dot.correct for dot in dots], dtype=bool)
    x, y = places.T
    axes.scatter(x, y, s=13, c=INK, edgecolors=PAPER, linewidths=0.6, zorder=3)
    axes.scatter(x[wrong], y[wrong], s=80, facecolors="none", edgecolors=INK, zorder=3)
    for unit in np.unique(units[wrong]):
        done = Counter(dot.label or "" for dot in dots if dot.action_unit == unit and dot.label and not dot.correct)
        _name_mistakes(axes, som, int(unit), done, space)


def _name_mistakes(axes: Axes, som: Som, unit: int, done: Counter[str], space: LabelSpace) -> None:
    """Write beside a unit the actions really done in its wrongly answered segments, unless there is no room."""
    text = "\n".join(wrapped(label, 18, 1) + (f" × {n}" if n > 1 else "") for label, n in done.most_common())
    row, col = som.coordinates[unit]
    width, height = text_size(text, _in_units(MISTAKE_PT, (som.rows, som.cols)))
    middles = [
        (col + right * (0.45 + width / 2), row + down * (0.2 + height / 2)) for right in (1, -1) for down in (-1, 1)
    ]
    place = space.place([*middles, (col, row - 0.45 - height / 2), (col, row + 0.45 + height / 2)], width, height)
    if place is not None:
        axes.text(
            *place, text, fontsize=MISTAKE_PT, ha="center", va="center", path_effects=HALO, zorder=4, in_layout=False
        )  # fmt: skip


def _in_units(points: float, shape: tuple[int, ...]) -> float:
    """Convert a size in typographic points into units of a map (rows, cols)."""
    return points * max(shape) / (72 * SIDE_IN)


def _legend(dots: Sequence[AnsweredSegment]) -> str:
    colours = "each unit in the colour of the action that answers most there; pale: hardly more than the next one"
    if not dots:
        return colours
    wrong = sum(dot.label is not None and not dot.correct for dot in dots)
    ringed = f", {wrong} of them ringed: taken for another action than the one named beside them" if wrong else ""
    return f"{colours}\n{len(dots)} dots: the segments{ringed}"
