"""Why this and not that: which part of a segment, and which of the first maps, decided between the two best answers."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from actum_model_inspector.answered import AnsweredSegment, encoded
from actum_model_inspector.arm_map import ArmsOnBodies, fastest_m
from actum_model_inspector.contributions import Contributions, contributions
from actum_model_inspector.movement_map import arrows_of
from actum_model_inspector.stick_figures import LONGEST_ARROW_M, Pen, draw_arrows, draw_figures
from actum_model_inspector.style import FAINT, PAPER, axes_at, bare, board, in_house_style
from actum_model_inspector.text_layout import shortened
from actum_model_inspector.waterfall import AGAINST, FOR, TERM_IN, Term, draw_waterfall
from som_classifier.handedness import mirrored
from som_classifier.pyramid_model import PyramidModel

Floats = NDArray[Any]
Draw = Callable[[Axes, PyramidModel, Contributions], None]

SHADES = LinearSegmentedColormap.from_list("for and against", [AGAINST, PAPER, FOR])
_STRONGEST = 0.65
MAPS = 3
FIGURE_UNITS = 5
"""How many units a figure is the mean of."""
WIDTH_IN, GAP_IN, ROW_IN, SCALE_IN = 5.2, 0.4, 1.35, 0.28
FIGURE_IN = 0.95 * ROW_IN
NARROWEST_IN = 0.5
"""A cell that is narrower gets no figure."""


@in_house_style
def explanation_picture(model: PyramidModel, answered: AnsweredSegment) -> Figure:
    """Draw what each cell of the pyramid adds to the difference between two actions' scores, map by map.

    They are the answer and, where that is wrong, what was really done, else the action that answered next.
    """
    done = answered.label if answered.label in model.labels and not answered.correct else None
    found = contributions(model, encoded(model, answered.frames), done)
    winner, second = (shortened(model.labels[index], 30) for index in (found.winner, found.second))
    lines, (*terms, total) = _remarks(found, winner, second), _terms(found, winner, second)
    height_in, width_in = ROW_IN * len(model.pyramid.levels) + SCALE_IN, MAPS * (WIDTH_IN + GAP_IN)
    balance_in = TERM_IN * len([*terms, total])
    title = f"Why {winner} and not {second}" + (", which was done" if done else "")
    figure = board(width_in, height_in + balance_in + 0.9 + 0.2 * len(lines), title)
    above_in = (height_in + balance_in + 0.52) / figure.get_figheight()
    figure.text(0.005, above_in, "\n".join(lines), linespacing=1.35, va="bottom")
    balance = axes_at(figure, 0.1, height_in + 0.44, width_in - 0.2, balance_in)
    balance.set_xlim(0.0, width_in - 0.2)
    draw_waterfall(balance, terms, total)
    for which, (heading, draw) in enumerate(_columns(found)):
        axes = axes_at(figure, 0.1 + which * (WIDTH_IN + GAP_IN), 0.1, WIDTH_IN, height_in)
        _draw_cells(axes, model, found, which)
        draw(axes, model, found)
        axes.set_title(heading)
    return figure


def leading(units: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the units that contribute most to a cell's sum, in the direction of its sign, and their shares (sum 1)."""
    signed = units * np.sign(units.sum() or 1.0)
    chosen = np.argsort(-signed, kind="stable")[:FIGURE_UNITS]
    weights = np.maximum(signed[chosen], 0.0)
    return chosen, weights / weights.sum() if weights.sum() > 0 else np.full(len(chosen), 1 / len(chosen))


def _columns(found: Contributions) -> Sequence[tuple[str, Draw]]:
    """Return each column's heading and what draws its figures."""
    return (
        ("POSTURES, in the whole action and in its parts", _draw_postures),
        ("MOVEMENTS: where the joints are going", _draw_movements),
        (f"THE {found.arm.upper()} ARM as seen from its shoulder", _draw_arms),
    )


def _terms(found: Contributions, winner: str, second: str) -> list[Term]:
    """Return what the difference of the scores is made of, and last the difference."""
    postures, movements, arm, other_arm = found.cells.sum(axis=0).tolist()
    other = "right" if found.arm == "left" else "left"
    return [
        Term("postures", postures, "the boxes on the left, added up"),
        Term("movements", movements, "the boxes in the middle"),
        Term(f"{found.arm} arm", arm, "the boxes on the right"),
        Term(f"{other} arm", other_arm, "counts less and is not drawn"),
        Term(
            "less average", found.level,
            "the same for every segment: what the boxes add up to in an average one is taken off, so that only what is "
            "special about this one counts",
        ),
        Term("together", found.difference, f"{winner} scores {found.scores[0]:.2f}, {second} {found.scores[1]:.2f}"),
    ]  # fmt: skip


def _remarks(found: Contributions, winner: str, second: str) -> list[str]:
    lines = [f"green speaks for {winner}, purple for {second}; the figures: what the units hold that say so most"]
    if found.difference < 0:
        lines.append(f"the scores lean to {second}: the place on the map of actions decided otherwise")
    if found.in_mirror:
        lines.append("the left arm acts: the model reads this in a mirror; it is drawn as it was")
    elif found.left_moves:
        lines.append("the left arm moves most, but this was not read in a mirror: the map of arms sees the right one")
    return lines


def _cells(model: PyramidModel) -> Floats:
    """Return left, top and width of each cell in inches, (cells, 3)."""
    return np.array(
        [
            (WIDTH_IN * cell / level, ROW_IN * row, WIDTH_IN / level)
            for row, level in enumerate(model.pyramid.levels)
            for cell in range(level)
        ]
    )


def _draw_cells(axes: Axes, model: PyramidModel, found: Contributions, which: int) -> None:
    """Draw the cells as boxes, level beneath level, shaded by what they add; one unit is an inch."""
    largest = float(np.abs(found.cells).max()) or 1.0
    for (left, top, width), value in zip(_cells(model), found.cells[:, which], strict=True):
        shade = SHADES(0.5 + 0.5 * _STRONGEST * value / largest)
        axes.add_patch(Rectangle((left, top), width, ROW_IN, facecolor=shade, edgecolor=PAPER, linewidth=3))
        axes.text(left + 0.08, top + 0.08, f"{value:+.2f}", va="top", weight="bold", fontsize=9)
    bottom = ROW_IN * len(model.pyramid.levels)
    axes.set_xlim(0, WIDTH_IN)
    axes.set_ylim(bottom + SCALE_IN, 0)
    axes.set_aspect("equal")
    bare(axes)
    axes.annotate(
        "", (WIDTH_IN - 0.45, bottom + 0.14), (0.5, bottom + 0.14), arrowprops={"arrowstyle": "->", "color": FAINT}
    )
    axes.text(0.0, bottom + 0.14, "start", va="center", color=FAINT)
    axes.text(WIDTH_IN, bottom + 0.14, "end", va="center", ha="right", color=FAINT)


def _middles(model: PyramidModel) -> tuple[NDArray[np.intp], Floats]:
    """Return the cells that are broad enough for a figure, and where its middle goes."""
    cells = _cells(model)
    broad = np.flatnonzero(cells[:, 2] >= NARROWEST_IN)
    return broad, np.stack([cells[broad, 0] + cells[broad, 2] / 2, cells[broad, 1] + ROW_IN / 2], axis=1)


def _draw_postures(axes: Axes, model: PyramidModel, found: Contributions) -> None:
    """Draw into each cell the mean posture of the units that add most to it."""
    broad, middles = _middles(model)
    means = _leading(found, broad, 0, _postures(model))
    draw_figures(axes, _as_it_was(means, found), middles, FIGURE_IN, pen=Pen(1.8))


def _draw_movements(axes: Axes, model: PyramidModel, found: Contributions) -> None:
    """Draw into each cell its mean posture, and as arrows the mean velocity of the units that add most to it."""
    broad, middles = _middles(model)
    _, arrows_m = arrows_of(model.first.velocities)
    means = _as_it_was(_leading(found, broad, 1, arrows_m), found)
    bodies = _as_it_was(_seen(model, found, broad), found)
    draw_figures(axes, bodies, middles, FIGURE_IN, pen=Pen(1.2, FAINT))
    draw_arrows(axes, bodies, means, middles, FIGURE_IN)


def _draw_arms(axes: Axes, model: PyramidModel, found: Contributions) -> None:
    """Draw into each cell its mean posture, on it the mean arm of the units that add most to it and where it goes."""
    broad, middles = _middles(model)
    means = _leading(found, broad, 2, model.first.arms.weights)
    drawn = ArmsOnBodies.of(means, _seen(model, found, broad))
    drawn = drawn.in_a_mirror() if found.in_mirror else drawn
    drawn.draw(axes, middles, FIGURE_IN, LONGEST_ARROW_M / fastest_m(model.first.arms))


def _postures(model: PyramidModel) -> Floats:
    return model.first.postures.weights.reshape(len(model.first.postures.weights), -1, 3)


def _seen(model: PyramidModel, found: Contributions, cells: NDArray[np.intp]) -> Floats:
    """Return each cell's mean posture, (cells, 15, 3)."""
    seen = found.activities[cells, 0]
    postures: Floats = np.tensordot(seen / seen.sum(axis=1, keepdims=True), _postures(model), 1)
    return postures


def _leading(found: Contributions, cells: NDArray[np.intp], which: int, units: Floats) -> Floats:
    """Return for each cell the mean over those units of a map that add most to it."""
    chosen = (leading(added) for added in found.units[cells, which])
    return np.array([np.tensordot(share, units[indices], 1) for indices, share in chosen])


def _as_it_was(vectors: Floats, found: Contributions) -> Floats:
    return mirrored(vectors) if found.in_mirror else vectors
