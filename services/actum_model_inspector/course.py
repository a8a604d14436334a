"""How the answer comes about over the frames of a segment, with the actor beneath."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.node import SECOND_NS
from actum_model_inspector.anatomy import Floats, Indices
from actum_model_inspector.answered import Answered, encoded
from actum_model_inspector.bodies import Pen, draw_bodies
from actum_model_inspector.labels import spread
from actum_model_inspector.lettering import columns, lines_of, shortened
from actum_model_inspector.style import HALO, action_colours, axes_at, bare, board, in_house_style
from actum_model_inspector.wording import headline
from som_classifier.model import Model
from som_classifier.recognition import Recognition

NAMED = 5
FIGURES = 6
MOST_INSTANTS = 200
SIZE_IN = 10.5, 7.0
LINES_IN, DECISION_IN = (0.9, 3.35, 6.9, 2.9), (0.9, 2.25, 6.9, 0.85)
"""Left, bottom, width and height."""
ACTOR_IN = 1.6
NAME_COLUMNS = 28
"""What there is room for at the right of the axes."""
DONE = " (done)"
_BROAD = 0.011
"""What a letter takes of the width of the axes."""
_GAP = 0.07
"""Between two names, in parts of the height of the axes."""


@dataclass(frozen=True, eq=False)
class Course:
    """What the model says while a segment goes on.

    Attributes:
        seconds: (n,), since its start, the last at its end: that one answers to the complete action.
        activations: (n, actions), the neurons' cosines.
        winners: (n,), the action decided for.
        confidences: (n,), in it.
    """

    seconds: Floats
    activations: Floats
    winners: Indices
    confidences: Floats


def course(model: Model, answered: Answered) -> Course:
    """Let the model answer after each frame, or after some of very many, the last of them as to a complete action."""
    frames = encoded(model, answered.frames)
    counts = np.unique(np.linspace(model.min_frames, len(frames), MOST_INSTANTS).astype(int))
    said: list[Recognition] = [model.recognise(frames[:count], complete=count == len(frames)) for count in counts]
    ends = np.array([frames[count - 1].stamp_ns for count in counts])
    return Course(
        (ends - frames[0].stamp_ns) / SECOND_NS,
        np.array([[recognition.activations[label] for label in model.labels] for recognition in said]),
        np.array([model.labels.index(recognition.label) for recognition in said]),
        np.array([recognition.confidence for recognition in said]),
    )


@in_house_style
def course_picture(model: Model, answered: Answered) -> Figure:
    """Draw the neurons' activations over time, the decision beneath, and the actor at some instants."""
    told = course(model, answered)
    figure = board(*SIZE_IN, headline(answered))
    lines, decision = (axes_at(figure, *box) for box in (LINES_IN, DECISION_IN))
    _draw_lines(lines, told, model.labels, answered.label)
    _draw_decision(decision, told, model.labels)
    for axes in (lines, decision):
        axes.set_xlim(0, max(float(told.seconds[-1]), 1e-3))
    lines.tick_params(labelbottom=False)
    decision.set_xlabel("time since the start (s); beneath, the actor at these times")
    _draw_actor(figure, answered)
    return figure


def _draw_lines(axes: Axes, told: Course, labels: Sequence[str], done: str | None) -> None:
    seconds, activations = told.seconds, told.activations
    named = _named(told, labels, done)
    colours = action_colours(len(labels))
    dot = "o" if len(seconds) == 1 else ""
    axes.plot(seconds, np.delete(activations, named, axis=1), dot + "-", color="#cccccc", linewidth=0.8, clip_on=False)
    for rank, index in enumerate(named):
        width = 2.8 if rank == 0 else 1.6
        axes.plot(seconds, activations[:, index], dot + "-", color=colours[index], linewidth=width, clip_on=False)
    ends = [float(activations[-1, index]) for index in named]
    height = float(np.ptp(activations)) or 1.0
    for index, end, place in zip(named, ends, spread(ends, _GAP * height), strict=True):
        done_too = DONE if labels[index] == done else ""
        name = shortened(labels[index], NAME_COLUMNS - len(done_too)) + done_too
        _name_line(axes, name, (float(seconds[-1]), end), place, colours[index])
    axes.set_ylabel("activation (cosine)")
    axes.set_title("each line an action's neuron: how much the frames so far are like what it learnt; grey: the others")


def _named(told: Course, labels: Sequence[str], done: str | None) -> Indices:
    """Choose the answer, what was done, and those decided for longest, or that answered most; the answer first."""
    rank = np.bincount(told.winners, minlength=len(labels)) + told.activations.max(axis=0)
    if done in labels:
        rank[labels.index(done)] = np.inf
    rank[told.winners[-1]] = np.inf
    most = np.argsort(-rank, kind="stable")[:NAMED]
    return np.array([told.winners[-1], *most[most != told.winners[-1]]])


def _name_line(axes: Axes, name: str, end: tuple[float, float], place: float, colour: Floats) -> None:
    """Write a name to the right of the axes, level with where its line ends or as near as there is room."""
    axes.annotate(
        name, end, (1.04, place), textcoords=axes.get_yaxis_transform(), va="center", annotation_clip=False,
        arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 1.2, "shrinkB": 0, "relpos": (0, 0.5)},
    )  # fmt: skip


def _draw_decision(axes: Axes, told: Course, labels: Sequence[str]) -> None:
    """Draw each answer's confidence as a bar, since the answer before, in its action's colour, named where it fits."""
    colours = action_colours(len(labels))
    seconds, winners = np.concatenate([[0.0], told.seconds]), told.winners
    axes.bar(
        seconds[:-1], told.confidences, np.diff(seconds), align="edge", color=colours[winners],
        edgecolor=colours[winners], linewidth=0.6,
    )  # fmt: skip
    begins = np.flatnonzero(np.concatenate([[True], winners[1:] != winners[:-1]]))
    for first, last in zip(begins, [*begins[1:], len(winners)], strict=True):
        name = shortened(labels[winners[first]], NAME_COLUMNS)
        if (seconds[last] - seconds[first]) / max(seconds[-1], 1e-9) > _BROAD * columns(name):
            middle = (seconds[first] + seconds[last]) / 2
            axes.text(middle, 0.45, name, ha="center", va="center", path_effects=HALO, fontsize=8)
    axes.set_ylim(0, 1)
    axes.set_ylabel("confidence")
    answer = lines_of(labels[told.winners[-1]], NAME_COLUMNS - 5)
    axes.text(
        1.04, 0.5, f"answer at the end:\n{answer} {told.confidences[-1]:.2f}", transform=axes.transAxes, va="center"
    )


def _draw_actor(figure: Figure, answered: Answered) -> None:
    """Draw the actor at instants that lie evenly in time, each beneath its time; one unit is an inch."""
    left, _, width, _ = DECISION_IN
    axes = axes_at(figure, left - ACTOR_IN / 2, 0.1, width + ACTOR_IN, ACTOR_IN)
    axes.set_xlim(-ACTOR_IN / 2, width + ACTOR_IN / 2)
    axes.set_ylim(ACTOR_IN / 2, -ACTOR_IN / 2)
    bare(axes)
    across = answered.shares * width
    chosen = spaced(across, FIGURES)
    movements = [answered.frames[index].kinematics for index in chosen]
    postures = np.array([movement.posture for movement in movements if movement is not None])
    places = np.stack([across[chosen], np.zeros(len(chosen))], axis=1)
    draw_bodies(axes, postures, places, 0.95 * ACTOR_IN, pen=Pen(2.0))


def spaced(places: Floats, most: int) -> list[int]:
    """Choose of rising places those nearest to evenly spread ones, leaving out what crowds the one before."""
    wanted = np.linspace(places[0], places[-1], most)
    chosen: list[int] = []
    for index in (int(np.abs(places - place).argmin()) for place in wanted):
        if not chosen or places[index] - places[chosen[-1]] > 0.6 * (wanted[1] - wanted[0]):
            chosen.append(index)
    return chosen
