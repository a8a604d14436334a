"""The picture that explains an answer: which parts of a segment, on which maps, favour it over another action."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from actum.arrays import Floats, Indices
from actum_model_inspector.answered import AnsweredSegment, encoded
from actum_model_inspector.arm_map import ArmsOnBodies, fastest_m
from actum_model_inspector.contributions import Contributions, contributions
from actum_model_inspector.stick_figures import LONGEST_ARROW_M, Pen, draw_arrows, draw_figures
from actum_model_inspector.style import FAINT, PAPER, axes_at, figure_without_layout, hide_axes, in_house_style
from actum_model_inspector.text_layout import shortened
from actum_model_inspector.velocity_map import velocity_arrows
from actum_model_inspector.waterfall import NEGATIVE, POSITIVE, TERM_IN, Term, draw_waterfall
from som_classifier.handedness import mirrored
from som_classifier.pyramid_model import PyramidModel

Draw = Callable[[Axes, PyramidModel, Contributions], None]

SHADES = LinearSegmentedColormap.from_list("for and against", [NEGATIVE, PAPER, POSITIVE])
_STRONGEST = 0.65  # of the colour map, for the largest contribution: figures and figures' colours stay visible on it
MAPS = 3  # columns: postures, velocities, the acting arm
FIGURE_UNITS = 5  # of the largest contributions, whose mean a figure shows: few, so that it remains a posture
WIDTH_IN = 5.2  # of a column: four cells of the lowest level, each wide enough for a figure
GAP_IN = 0.4  # between columns
ROW_IN = 1.35  # height of a level's cells
SCALE_IN = 0.28  # height of the arrow from start to end
FIGURE_IN = 0.95 * ROW_IN  # height of a figure: a little less than its cell's
NARROWEST_IN = 0.5  # narrower cells get no figure: it would not fit


@in_house_style
def explanation_picture(model: PyramidModel, answered: AnsweredSegment) -> Figure:
    """Draw each pyramid cell's contribution to the difference between two actions' scores, map by map.

    The two are the action answered and, where that is wrong, the action really done, else the one with the next largest
    activation.
    """
    done = answered.label if answered.label in model.labels and not answered.correct else None
    attribution = contributions(model, encoded(model, answered.frames), done)
    winner, other = (shortened(model.labels[index], 30) for index in (attribution.winner, attribution.other))
    lines, (*terms, total) = _remarks(attribution, winner, other), _terms(attribution, winner, other)
    height_in, width_in = ROW_IN * len(model.pyramid.levels) + SCALE_IN, MAPS * (WIDTH_IN + GAP_IN)
    waterfall_in = TERM_IN * len([*terms, total])
    title = f"Why {winner} and not {other}" + (", which was done" if done else "")
    figure = figure_without_layout(width_in, height_in + waterfall_in + 0.9 + 0.2 * len(lines), title)
    above = (height_in + waterfall_in + 0.52) / figure.get_figheight()
    figure.text(0.005, above, "\n".join(lines), linespacing=1.35, va="bottom")
    waterfall = axes_at(figure, 0.1, height_in + 0.44, width_in - 0.2, waterfall_in)
    waterfall.set_xlim(0.0, width_in - 0.2)
    draw_waterfall(waterfall, terms, total)
    for channel, (heading, draw) in enumerate(_columns(attribution)):
        axes = axes_at(figure, 0.1 + channel * (WIDTH_IN + GAP_IN), 0.1, WIDTH_IN, height_in)
        _draw_cells(axes, model, attribution, channel)
        draw(axes, model, attribution)
        axes.set_title(heading)
    return figure


def largest_contributors(units: Floats) -> tuple[Indices, Floats]:
    """Return the units with the largest contributions of the same sign as the sum of all, and their weights.

    Args:
        units: (n,), contributions.

    Returns:
        indices: (k,), k = `FIGURE_UNITS` or fewer, the unit of the largest contribution first.
        weights: (k,), in proportion to the contributions, of sum 1.
    """
    signed = units * np.sign(units.sum() or 1.0)
    chosen = np.argsort(-signed, kind="stable")[:FIGURE_UNITS]
    weights = np.maximum(signed[chosen], 0.0)
    return chosen, weights / weights.sum() if weights.sum() > 0 else np.full(len(chosen), 1 / len(chosen))


def _columns(attribution: Contributions) -> Sequence[tuple[str, Draw]]:
    """Return each column's heading and the function that draws its figures."""
    return (
        ("POSTURES, in the whole action and in its parts", _draw_postures),
        ("MOVEMENTS: where the joints are going", _draw_velocities),
        (f"THE {attribution.arm.upper()} ARM as seen from its shoulder", _draw_arms),
    )


def _terms(attribution: Contributions, winner: str, other: str) -> list[Term]:
    """Return the terms of the difference between the scores, and last the difference itself."""
    postures, velocities, arm, other_arm = attribution.cells.sum(axis=0).tolist()
    idle = "right" if attribution.arm == "left" else "left"
    winner_score, other_score = attribution.scores
    return [
        Term("postures", postures, "the boxes on the left, added up"),
        Term("movements", velocities, "the boxes in the middle"),
        Term(f"{attribution.arm} arm", arm, "the boxes on the right"),
        Term(f"{idle} arm", other_arm, "counts less and is not drawn"),
        Term(
            "less average", attribution.bias,
            "the same for every segment: what the boxes add up to in an average one is taken off, so that only what is "
            "special about this one counts",
        ),
        Term("together", attribution.difference, f"{winner} scores {winner_score:.2f}, {other} {other_score:.2f}"),
    ]  # fmt: skip


def _remarks(attribution: Contributions, winner: str, other: str) -> list[str]:
    """Return lines that explain the colours, and any peculiarity of this answer."""
    lines = [f"green speaks for {winner}, purple for {other}; the figures: what the units hold that say so most"]
    if attribution.difference < 0:
        lines.append(f"the scores lean to {other}: the place on the map of actions decided otherwise")
    if attribution.in_mirror:
        lines.append("the left arm acts: the model reads this in a mirror; it is drawn as it was")
    elif attribution.left_moves:
        lines.append("the left arm moves most, but this was not read in a mirror: the map of arms sees the right one")
    return lines


def _cells(model: PyramidModel) -> Floats:
    """Return left, top and width of each pyramid cell in a column, inches, shape (cells, 3)."""
    return np.array(
        [
            (WIDTH_IN * cell / level, ROW_IN * row, WIDTH_IN / level)
            for row, level in enumerate(model.pyramid.levels)
            for cell in range(level)
        ]
    )


def _draw_cells(axes: Axes, model: PyramidModel, attribution: Contributions, channel: int) -> None:
    """Draw the cells as boxes, level beneath level, shaded by their contribution; the axes' unit is an inch."""
    largest = float(np.abs(attribution.cells).max()) or 1.0
    for (left, top, width), value in zip(_cells(model), attribution.cells[:, channel], strict=True):
        shade = SHADES(0.5 + 0.5 * _STRONGEST * value / largest)
        axes.add_patch(Rectangle((left, top), width, ROW_IN, facecolor=shade, edgecolor=PAPER, linewidth=3))
        axes.text(left + 0.08, top + 0.08, f"{value:+.2f}", va="top", weight="bold", fontsize=9)
    bottom = ROW_IN * len(model.pyramid.levels)
    axes.set_xlim(0, WIDTH_IN)
    axes.set_ylim(bottom + SCALE_IN, 0)
    axes.set_aspect("equal")
    hide_axes(axes)
    axes.annotate(
        "", (WIDTH_IN - 0.45, bottom + 0.14), (0.5, bottom + 0.14), arrowprops={"arrowstyle": "->", "color": FAINT}
    )
    axes.text(0.0, bottom + 0.14, "start", va="center", color=FAINT)
    axes.text(WIDTH_IN, bottom + 0.14, "end", va="center", ha="right", color=FAINT)


def _figure_places(model: PyramidModel) -> tuple[Indices, Floats]:
    """Return the cells that are wide enough for a figure, (n,), and x and y of its middle, inches, (n, 2)."""
    cells = _cells(model)
    wide = np.flatnonzero(cells[:, 2] >= NARROWEST_IN)
    return wide, np.stack([cells[wide, 0] + cells[wide, 2] / 2, cells[wide, 1] + ROW_IN / 2], axis=1)


def _draw_postures(axes: Axes, model: PyramidModel, attribution: Contributions) -> None:
    """Draw into each cell the mean posture of the units that contribute most."""
    wide, middles = _figure_places(model)
    means = _mean_contributors(attribution, wide, 0, _unit_postures(model))
    draw_figures(axes, _as_performed(means, attribution), middles, FIGURE_IN, pen=Pen(1.8))


def _draw_velocities(axes: Axes, model: PyramidModel, attribution: Contributions) -> None:
    """Draw into each cell its mean posture, with the mean velocities of the units that contribute most as arrows."""
    wide, middles = _figure_places(model)
    _, arrows_m = velocity_arrows(model.first.velocities)
    means = _as_performed(_mean_contributors(attribution, wide, 1, arrows_m), attribution)
    bodies = _as_performed(_mean_postures(model, attribution, wide), attribution)
    draw_figures(axes, bodies, middles, FIGURE_IN, pen=Pen(1.2, FAINT))
    draw_arrows(axes, bodies, means, middles, FIGURE_IN)


def _draw_arms(axes: Axes, model: PyramidModel, attribution: Contributions) -> None:
    """Draw into each cell its mean posture, with the mean arm (and its velocity) of the units that contribute most."""
    wide, middles = _figure_places(model)
    means = _mean_contributors(attribution, wide, 2, model.first.arms.weights)
    drawn = ArmsOnBodies.of(means, _mean_postures(model, attribution, wide))
    drawn = drawn.mirrored() if attribution.in_mirror else drawn
    drawn.draw(axes, middles, FIGURE_IN, LONGEST_ARROW_M / fastest_m(model.first.arms))


def _unit_postures(model: PyramidModel) -> Floats:
    """Return the posture of each unit of the posture map, (units, 15, 3)."""
    return model.first.postures.weights.reshape(len(model.first.postures.weights), -1, 3)


def _mean_postures(model: PyramidModel, attribution: Contributions, cells: Indices) -> Floats:
    """Return the mean posture in each cell, (cells, 15, 3): that of the posture map's units, weighted by activity."""
    activities = attribution.activities[cells, 0]
    postures: Floats = np.tensordot(activities / activities.sum(axis=1, keepdims=True), _unit_postures(model), 1)
    return postures


def _mean_contributors(attribution: Contributions, cells: Indices, channel: int, values: Floats) -> Floats:
    """Return for each cell the mean of the units' values (units, …), over those that contribute most, (cells, …)."""
    chosen = (largest_contributors(units) for units in attribution.units[cells, channel])
    return np.array([np.tensordot(weights, values[indices], 1) for indices, weights in chosen])


def _as_performed(vectors: Floats, attribution: Contributions) -> Floats:
    """Mirror vectors (n, 15, 3) back where the segment was read in a mirror."""
    return mirrored(vectors) if attribution.in_mirror else vectors
