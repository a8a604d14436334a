"""The picture of the first map: a stick figure per unit, on the U-matrix (the distances between neighbours)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.arrays import Floats, Indices
from actum.som import Som
from actum_model_inspector.stick_figures import ONE_LIMB, WHOLE_BODY, Pen, draw_figures, standing
from actum_model_inspector.style import FAINT, LEFT, RIGHT, draw_squares, figure_with_layout, hide_axes, in_house_style
from som_classifier.model_maps import ModelMaps

MAX_FIGURES = 20  # along a side: more are too small to see
SIDE_IN = 10.5  # of the longer side: half an inch for each of 20 figures
FILLED = 0.96  # height of a figure in units of its place: neighbours do not touch
_DARKEST = 0.35  # grey level taken off white at the largest distance: figures stay visible on it


@in_house_style()
def posture_map(maps: ModelMaps) -> Figure:
    """Draw each unit's weights as a figure, on the U-matrix."""
    som = maps.postures
    figure = figure_with_layout(
        *map_size(som), f"The posture map: {som.rows} × {som.cols} units, each standing for a posture"
    )
    axes = figure.add_subplot()
    spacing = draw_postures(axes, maps)
    axes.set_title(f"{which_are_drawn(spacing)}neighbours are alike; dark ground: a border between unlike postures")
    name_sides(axes)
    return figure


def draw_postures(axes: Axes, maps: ModelMaps, strength: float = 1.0) -> int:
    """Draw the map and return its figures' spacing in units."""
    som = maps.postures
    draw_ground(axes, som, strength)
    units, spacing = drawn_units(som)
    draw_units(axes, maps, maps.unit_joints(), units, spacing, strength)
    return spacing


def draw_units(
    axes: Axes,
    maps: ModelMaps,
    points: Floats,
    units: Indices,
    size: float,
    strength: float = 1.0,
    zorder: float = 2.0,
) -> None:
    """Draw the figures of some units; where a figure is only a limb, over the faint figure of somebody who stands.

    Args:
        axes: whose y goes down.
        maps: of the model.
        points: (all units, joints, 3), metres from the torso.
        units: (n,), which are drawn.
        size: height of a figure's place, in units of the map.
        strength: opacity, 0 to 1.
        zorder: Matplotlib's: the larger is drawn above.
    """
    places = maps.postures.coordinates[units][:, ::-1]
    figure = WHOLE_BODY if maps.shows_bodies else ONE_LIMB
    if not maps.shows_bodies:
        pen = Pen(0.6, FAINT, 0.5 * strength, zorder)
        draw_figures(axes, standing(len(units)), places, FILLED * size, pen=pen)
    pen = Pen(1.2 if maps.shows_bodies else 1.8, strength=strength, zorder=zorder)
    draw_figures(axes, points[units], places, FILLED * size, figure, pen)


def drawn_units(som: Som) -> tuple[Indices, int]:
    """Return the units to draw, (n,), `MAX_FIGURES` along a side at most, and their spacing in units."""
    spacing = -(-max(som.rows, som.cols) // MAX_FIGURES)
    row, col = som.coordinates.T.astype(np.intp)
    return np.flatnonzero((row % spacing == spacing // 2) & (col % spacing == spacing // 2)), spacing


def which_are_drawn(spacing: int) -> str:
    """Return words that say which units are drawn; "" where all are."""
    return "" if spacing == 1 else f"one unit in {spacing * spacing} is drawn; "


def draw_ground(axes: Axes, som: Som, strength: float = 1.0) -> None:
    """Shade each unit by its mean distance to its neighbours."""
    distances = som.u_matrix()
    grey = 1 - strength * _DARKEST * (distances - distances.min()) / max(float(np.ptp(distances)), 1e-9)
    draw_squares(axes, np.repeat(grey[..., None], 3, axis=2))
    hide_axes(axes)


def map_size(som: Som) -> tuple[float, float]:
    """Return width and height (inches) of a picture of a map."""
    longest = max(som.rows, som.cols)
    return max(SIDE_IN * som.cols / longest, 6.0), max(SIDE_IN * som.rows / longest, 3.0) + 0.45


def name_sides(axes: Axes) -> None:
    """Write which colour is which side of the actor's body."""
    axes.text(1.0, 1.008, "actor's left", color=LEFT, ha="right", va="bottom", transform=axes.transAxes)
    axes.text(0.9, 1.008, "actor's right", color=RIGHT, ha="right", va="bottom", transform=axes.transAxes)
