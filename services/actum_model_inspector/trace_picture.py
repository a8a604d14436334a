"""The picture of a segment's trajectory over the posture map."""

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch

from actum.arrays import Floats, Indices
from actum.node import SECOND_NS
from actum.som import Som
from actum_model_inspector.answered import AnsweredSegment, encoded, headline
from actum_model_inspector.posture_map import draw_postures, draw_units, map_size, name_sides
from actum_model_inspector.style import HALO, PAPER, figure_with_layout, in_house_style
from som_classifier.handedness import mirrored
from som_classifier.map_activity import NO_WINNER
from som_classifier.model_maps import ModelMaps

PALE = 0.28  # opacity of the map beneath the trajectory
CARD = 0.94  # side of a visited unit's card, in units of the map
SHIFT = 0.07  # of steps to their right, in units of the map: steps there and back lie side by side
TIME_COLOURS = mpl.colormaps["plasma"].resampled(256)
_LATEST = 0.88  # of the colour scale, for the segment's end: its last part is too light for white paper


@in_house_style()
def trace_picture(maps: ModelMaps, answered: AnsweredSegment) -> Figure:
    """Draw the winners of a segment, joined in their order, over the pale posture map."""
    frames = encoded(maps.model, answered.frames)
    winners = maps.winners(frames)
    with_winner = np.flatnonzero(winners != NO_WINNER)
    units, first = stays(winners[with_winner])
    width, height = map_size(maps.postures)
    figure = figure_with_layout(width + 0.9, height, headline(answered))
    axes = figure.add_subplot()
    draw_postures(axes, maps, PALE)
    times = answered.relative_times[with_winner[first]]
    _draw_trajectory(axes, maps.postures.coordinates[units][:, ::-1], times)
    in_mirror = maps.is_mirrored(frames)
    points = mirrored(maps.unit_joints()) if in_mirror else maps.unit_joints()
    _draw_cards(axes, maps, points, units, times)
    mirror = "; the left arm acts: read in a mirror, drawn as it was" if in_mirror else ""
    axes.set_title(f"{len(units)} stays on {len(np.unique(units))} units, framed in the colour of the first{mirror}")
    name_sides(axes)
    seconds = (answered.frames[-1].stamp_ns - answered.frames[0].stamp_ns) / SECOND_NS
    colours = TIME_COLOURS(np.linspace(0, _LATEST, 256))
    scale = ScalarMappable(Normalize(0, max(seconds, 1e-3)), mpl.colors.ListedColormap(colours))
    bar = figure.colorbar(scale, ax=axes, shrink=0.5, aspect=30, pad=0.01)
    bar.set_label("time since the start (s)")
    bar.outline.set_visible(False)
    return figure


def stays(winners: Indices) -> tuple[Indices, Indices]:
    """Return the runs of equal winners (n,): the unit of each run, and the index of its first frame, both (runs,)."""
    begins = np.flatnonzero(np.concatenate([[True], winners[1:] != winners[:-1]]))
    return winners[begins], begins


def _draw_trajectory(axes: Axes, places: Floats, times: Floats) -> None:
    """Join places (n, 2), x and y, by lines in the colour of their time (n,), 0 to 1, long ones with an arrowhead."""
    colours = TIME_COLOURS(_LATEST * times)
    steps = shifted_right(np.stack([places[:-1], places[1:]], axis=1))
    axes.add_collection(LineCollection(list(steps), colors=PAPER, linewidths=4.5, capstyle="round", zorder=3))
    axes.add_collection(LineCollection(list(steps), colors=colours[:-1], linewidths=2.0, capstyle="round", zorder=3))
    for step, colour in zip(steps, colours, strict=False):
        if np.linalg.norm(step[1] - step[0]) >= 2.0:
            middle, ahead = step.mean(axis=0), (step[1] - step[0]) * 0.02
            arrow = {"arrowstyle": "-|>", "color": colour, "mutation_scale": 15, "lw": 0}
            axes.annotate("", middle + ahead, middle - ahead, arrowprops=arrow, zorder=3)


def shifted_right(steps: Floats) -> Floats:
    """Return each step (n, 2, 2), from and to x and y, moved to its right by `SHIFT`. Same shape."""
    ahead = steps[:, 1] - steps[:, 0]
    right = ahead[:, ::-1] * [-1.0, 1.0] / np.linalg.norm(ahead, axis=1, keepdims=True)
    moved: Floats = steps + SHIFT * right[:, None]
    return moved


def _draw_cards(axes: Axes, maps: ModelMaps, points: Floats, units: Indices, times: Floats) -> None:
    """Draw each visited unit on a white card, framed in the colour of its first visit, and name start and end."""
    visited, first = np.unique(units, return_index=True)
    places = maps.postures.coordinates[:, ::-1]
    for unit, colour in zip(visited, TIME_COLOURS(_LATEST * times[first]), strict=True):
        corner = places[unit] - 0.5 * CARD
        card = FancyBboxPatch(
            corner, CARD, CARD, boxstyle="round,pad=0,rounding_size=0.12", facecolor=PAPER, edgecolor=colour,
            linewidth=2.0, zorder=4,
        )  # fmt: skip
        axes.add_patch(card)
    draw_units(axes, maps, points, visited, CARD, zorder=5)
    start, end = units[0], units[-1]
    above, below = (free_side(maps.postures, unit, visited, side) for unit, side in ((start, -1), (end, 1)))
    if start == end:
        _name(axes, "start and end", places[start], above < 0)
    else:
        _name(axes, "start", places[start], above < 0)
        _name(axes, "end", places[end], below < 0)


def free_side(som: Som, unit: int, visited: Indices, preferred: int) -> int:
    """Return the side of a unit, −1 above or 1 below, where a name covers no visited unit, the preferred if both.

    Args:
        som: the map.
        unit: to be named.
        visited: (n,), units that the trajectory visits.
        preferred: −1 or 1.
    """
    rows = {side: unit // som.cols + side for side in (preferred, -preferred)}
    on_map = [side for side, row in rows.items() if 0 <= row < som.rows]
    free = [side for side in on_map if unit + side * som.cols not in visited]
    return next(iter(free or on_map), preferred)


def _name(axes: Axes, name: str, place: Floats, above: bool) -> None:
    x, y = place
    axes.annotate(
        name, (x, y - 0.5 if above else y + 0.5), (0, 2 if above else -2), textcoords="offset points", ha="center",
        va="bottom" if above else "top", weight="bold", path_effects=HALO, zorder=6, fontsize=11,
    ).set_in_layout(False)  # fmt: skip
