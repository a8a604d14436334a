"""The picture of the second map: its regions of actions, and the winners of segments on it."""

from collections import Counter
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox, BboxBase

from actum.arrays import Floats, Indices
from actum.som import Som
from actum_model_inspector.answered import AnsweredSegment
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

Place = tuple[float, float, str, str]
"""How far a name lies to the right of its unit and beneath it, units of the map, and how it is aligned there."""
ON_UNIT: tuple[Place, ...] = (
    (0.0, 0.0, "center", "center"),
    (0.0, 0.0, "center", "bottom"),
    (0.0, 0.0, "center", "top"),
)
"""Places for the name of a region on its innermost unit, the best first."""
BESIDE_UNIT: tuple[Place, ...] = (
    (0.45, -0.2, "left", "bottom"), (0.45, 0.2, "left", "top"), (-0.45, -0.2, "right", "bottom"),
    (-0.45, 0.2, "right", "top"), (0.0, -0.45, "center", "bottom"), (0.0, 0.45, "center", "top"),
)  # fmt: skip
"""Places for a name beside its unit, the best first."""


@in_house_style()
def action_map(maps: ModelMaps, segments: Sequence[AnsweredSegment] = ()) -> Figure:
    """Colour each unit by the action whose neuron is most active for it, and put a dot on each segment's winner."""
    som, labels = maps.actions, maps.model.labels
    map_regions = regions(maps.unit_cosines(), som.rows, som.cols)
    longest = max(som.rows, som.cols)
    size = max(SIDE_IN * som.cols / longest, 6.0), max(SIDE_IN * som.rows / longest, 3.0) + 0.85
    figure = figure_with_layout(*size, f"The map of actions: {som.rows} × {som.cols} units, {len(labels)} actions")
    axes = figure.add_subplot()
    strength = PALEST + (1 - PALEST) * map_regions.margins
    draw_squares(axes, mixed_with_white(action_colours(len(labels))[map_regions.actions], strength))
    axes.add_collection(LineCollection(borders(map_regions.actions), colors=PAPER, linewidths=2.0))
    hide_axes(axes)
    dots = [segment for segment in segments if segment.action_unit is not None]
    names = _name_regions(axes, map_regions, labels)
    units = np.array([dot.action_unit for dot in dots], dtype=np.intp)
    x, y = (som.coordinates[units][:, ::-1] + spread_on_unit(units)).T
    wrong = np.array([_is_mistake(dot) for dot in dots], dtype=bool)
    axes.scatter(x, y, s=13, c=INK, edgecolors=PAPER, linewidths=0.6, zorder=3)
    axes.scatter(x[wrong], y[wrong], s=80, facecolors="none", edgecolors=INK, zorder=3)
    axes.set_title(_legend(dots))
    without_region = [label for index, label in enumerate(labels) if not (map_regions.actions == index).any()]
    if without_region:
        axes.set_xlabel(f"without a place of their own: {wrapped(', '.join(without_region), 110)}", loc="left")
    _place_names(figure, names, _name_mistakes(axes, som, dots))
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


def _name_regions(axes: Axes, map_regions: Regions, labels: Sequence[str]) -> list[Text]:
    """Write each action's name into the largest connected component of its region."""
    components = (largest_component(map_regions.actions == index) for index in range(len(labels)))
    middles = {label: innermost_unit(units) for label, units in zip(labels, components, strict=True) if len(units)}
    return [
        axes.text(
            col, row, wrapped(label, 14), ha="center", va="center", weight="bold", path_effects=HALO, fontsize=NAME_PT,
            linespacing=0.95, zorder=5,
        )
        for label, (row, col) in middles.items()
    ]  # fmt: skip


def _name_mistakes(axes: Axes, som: Som, dots: Sequence[AnsweredSegment]) -> list[Text]:
    """Write at each unit with wrong answers the actions really done there."""
    done: dict[int, Counter[str]] = {}
    for dot in filter(_is_mistake, dots):
        done.setdefault(dot.action_unit or 0, Counter())[dot.label or ""] += 1
    return [
        axes.text(
            unit % som.cols, unit // som.cols,
            "\n".join(wrapped(label, 18, 1) + (f" × {n}" if n > 1 else "") for label, n in labels.most_common()),
            fontsize=MISTAKE_PT, path_effects=HALO, zorder=4, in_layout=False,
        )
        for unit, labels in done.items()
    ]  # fmt: skip


def _place_names(figure: Figure, regions: Sequence[Text], mistakes: Sequence[Text]) -> None:
    """Move names to where they overlap no other; one of a mistake is left out where there is no room on the page."""
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    taken: list[Bbox] = []
    for name in regions:
        if not _placed(name, ON_UNIT, figure.bbox, taken):
            name.set_verticalalignment("center")
    for name in mistakes:
        if not _placed(name, BESIDE_UNIT, figure.bbox, taken):
            name.remove()


def _placed(name: Text, places: Sequence[Place], page: BboxBase, taken: list[Bbox]) -> bool:
    """Move a name by the first offset at which it is on the page and overlaps no box taken so far.

    Return whether there is such an offset; its box is taken then.
    """
    x, y = name.get_position()
    for right, down, ha, va in places:
        name.set(position=(x + right, y + down), ha=ha, va=va)
        box = name.get_window_extent()
        if not box.count_overlaps(taken) and page.contains(*box.min) and page.contains(*box.max):
            taken.append(box)
            return True
    return False


def _is_mistake(dot: AnsweredSegment) -> bool:
    return dot.label is not None and not dot.correct


def _legend(dots: Sequence[AnsweredSegment]) -> str:
    colours = "each unit in the colour of the action that answers most there; pale: hardly more than the next one"
    if not dots:
        return colours
    wrong = sum(map(_is_mistake, dots))
    ringed = f", {wrong} of them ringed: taken for another action than the one named beside them" if wrong else ""
    return f"{colours}\n{len(dots)} dots: the segments{ringed}"
