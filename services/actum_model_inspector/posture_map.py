"""The first map as a grid of stick figures: which postures the model knows, and which it takes for alike."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from actum.som import Som
from actum_model_inspector.model_maps import ModelMaps
from actum_model_inspector.stick_figures import WHOLE, Pen, draw_figures, rest
from actum_model_inspector.style import FAINT, LEFT, RIGHT, bare, canvas, in_house_style, tiles

Floats = NDArray[Any]

MOST_FIGURES = 20
"""Along a side: more are too small to see."""
SIDE_IN = 10.5
FILLED = 0.96
_DARKEST = 0.35


@in_house_style
def posture_map(maps: ModelMaps) -> Figure:
    """Draw each unit's weights as a figure, on the U-matrix."""
    som = maps.postures
    figure = canvas(*map_size(som), f"The posture map: {som.rows} × {som.cols} units, each standing for a posture")
    axes = figure.add_subplot()
    every = draw_postures(axes, maps)
    axes.set_title(f"{which_are_drawn(every)}neighbours are alike; dark ground: a border between unlike postures")
    name_sides(axes)
    return figure


def draw_postures(axes: Axes, maps: ModelMaps, strength: float = 1.0) -> int:
    """Draw the map and return how many units there are from one figure to the next."""
    som = maps.postures
    draw_ground(axes, som, strength)
    units, every = drawn_units(som)
    draw_units(axes, maps, maps.unit_points(), units, every, strength)
    return every


def draw_units(
    axes: Axes,
    maps: ModelMaps,
    points: Floats,
    units: NDArray[np.intp],
    size: float,
    strength: float = 1.0,
    zorder: float = 2.0,
) -> None:
    """Draw some units' figures, given all units' points; where those are three joints, with the body they belong to."""
    places = maps.postures.coordinates[units][:, ::-1]
    whole = maps.figure is WHOLE
    if not whole:
        pen = Pen(0.6, FAINT, 0.5 * strength, zorder)
        draw_figures(axes, rest(len(units)), places, FILLED * size, pen=pen)
    pen = Pen(1.2 if whole else 1.8, strength=strength, zorder=zorder)
    draw_figures(axes, points[units], places, FILLED * size, maps.figure, pen)


def drawn_units(som: Som) -> tuple[NDArray[np.intp], int]:
    """Choose the units to draw, and return how far they lie apart: no more than `MOST_FIGURES` along a side."""
    every = -(-max(som.rows, som.cols) // MOST_FIGURES)
    row, col = som.coordinates.T.astype(np.intp)
    return np.flatnonzero((row % every == every // 2) & (col % every == every // 2)), every


def which_are_drawn(every: int) -> str:
    """Say which units are drawn where not all are."""
    return "" if every == 1 else f"one unit in {every * every} is drawn; "


def draw_ground(axes: Axes, som: Som, strength: float = 1.0) -> None:
    """Shade each unit by its mean distance to its neighbours."""
    apart = som.u_matrix()
    grey = 1 - strength * _DARKEST * (apart - apart.min()) / max(float(np.ptp(apart)), 1e-9)
    tiles(axes, np.repeat(grey[..., None], 3, axis=2))
    bare(axes)


def map_size(som: Som) -> tuple[float, float]:
    """Return width and height (inches) of a picture of a map."""
    longest = max(som.rows, som.cols)
    return max(SIDE_IN * som.cols / longest, 6.0), max(SIDE_IN * som.rows / longest, 3.0) + 0.45


def name_sides(axes: Axes) -> None:
    """Say which colour is which side of the actor's body."""
    axes.text(1.0, 1.008, "actor's left", color=LEFT, ha="right", va="bottom", transform=axes.transAxes)
    axes.text(0.9, 1.008, "actor's right", color=RIGHT, ha="right", va="bottom", transform=axes.transAxes)
