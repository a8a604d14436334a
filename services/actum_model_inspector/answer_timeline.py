"""The picture of a model's answers over the time of a segment, with the actor beneath."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.cells import cell_len

from actum.arrays import Floats, Indices
from actum.node import SECOND_NS
from actum_model_inspector.answered import AnsweredSegment, encoded, headline
from actum_model_inspector.stick_figures import Pen, draw_figures
from actum_model_inspector.style import HALO, action_colours, axes_at, figure_without_layout, hide_axes, in_house_style
from actum_model_inspector.text_layout import shortened, wrapped
from som_classifier.model import Model, Recognition

NAMED = 5  # lines with colour and name: more are hard to distinguish
FIGURES = 6  # of the actor: as many as stand side by side without touching
MAX_INSTANTS = 200  # at which the model answers: more bars than that melt into one another
SIZE_IN = 10.5, 7.0  # width and height of the picture
LINES_IN = (0.9, 3.35, 6.9, 2.9)  # left, bottom, width and height of the axes of activations
DECISION_IN = (0.9, 2.25, 6.9, 0.85)  # the same of the axes of decisions, beneath with the same time axis
ACTOR_IN = 1.6  # height of the actor's figures
NAME_COLUMNS = 28  # small letters for which there is room to the right of the axes
DONE = " (done)"
_LETTER_WIDTH = 0.011  # of a small letter, as a share of the axes' width


@dataclass(frozen=True, eq=False)
class AnswerTimeline:
    """The model's answers at n instants of a segment; the last is the answer to the complete action.

    Attributes:
        times_s: (n,), since the segment's start.
        activations: (n, actions), the neurons' cosines.
        winners: (n,), the index of the action answered.
        confidences: (n,), of the answer.
    """

    times_s: Floats
    activations: Floats
    winners: Indices
    confidences: Floats


def answer_timeline(model: Model, answered: AnsweredSegment) -> AnswerTimeline:
    """Return the model's answers after each frame from the first possible one, at `MAX_INSTANTS` frames at most."""
    frames = encoded(model, answered.frames)
    counts = np.unique(np.linspace(model.min_frames, len(frames), MAX_INSTANTS).astype(int))
    answers: list[Recognition] = [model.recognise(frames[:count], complete=count == len(frames)) for count in counts]
    ends_ns = np.array([frames[count - 1].stamp_ns for count in counts])
    return AnswerTimeline(
        (ends_ns - frames[0].stamp_ns) / SECOND_NS,
        np.array([[recognition.activations[label] for label in model.labels] for recognition in answers]),
        np.array([model.labels.index(recognition.label) for recognition in answers]),
        np.array([recognition.confidence for recognition in answers]),
    )


@in_house_style()
def timeline_picture(model: Model, answered: AnsweredSegment) -> Figure:
    """Draw the neurons' activations over time, beneath them the decisions, and the actor at some instants."""
    timeline = answer_timeline(model, answered)
    figure = figure_without_layout(*SIZE_IN, headline(answered))
    lines, decision = (axes_at(figure, *box) for box in (LINES_IN, DECISION_IN))
    _draw_lines(lines, timeline, model.labels, answered.label)
    _draw_decision(decision, timeline, model.labels)
    for axes in (lines, decision):
        axes.set_xlim(0, max(float(timeline.times_s[-1]), 1e-3))
    lines.tick_params(labelbottom=False)
    decision.set_xlabel("time since the start (s); beneath, the actor at these times")
    _draw_actor(figure, answered)
    return figure


def _draw_lines(axes: Axes, timeline: AnswerTimeline, labels: Sequence[str], done: str | None) -> None:
    times_s, activations = timeline.times_s, timeline.activations
    named = _named_actions(timeline, labels, done)
    colours = action_colours(len(labels))
    dot = "o" if len(times_s) == 1 else ""
    axes.plot(times_s, np.delete(activations, named, axis=1), dot + "-", color="#cccccc", linewidth=0.8, clip_on=False)
    for rank, index in enumerate(named):
        width = 2.8 if rank == 0 else 1.6
        axes.plot(times_s, activations[:, index], dot + "-", color=colours[index], linewidth=width, clip_on=False)
    by_end = sorted(zip(named, axes.lines[-len(named) :], strict=True), key=lambda pair: -activations[-1, pair[0]])
    names = [_shown(labels[index], done) for index, _ in by_end]
    axes.legend([line for _, line in by_end], names, loc="upper left", bbox_to_anchor=(1.02, 1), frameon=False)
    axes.set_ylabel("activation (cosine)")
    axes.set_title("each line an action's neuron: how much the frames so far are like what it learnt; grey: the others")


def _named_actions(timeline: AnswerTimeline, labels: Sequence[str], done: str | None) -> Indices:
    """Choose the actions whose lines are named: the final answer first, the action done, then those answered longest.

    Among equally long ones, that with the larger activation comes first.
    """
    rank = np.bincount(timeline.winners, minlength=len(labels)) + timeline.activations.max(axis=0)
    if done in labels:
        rank[labels.index(done)] = np.inf
    rank[timeline.winners[-1]] = np.inf
    most = np.argsort(-rank, kind="stable")[:NAMED]
    return np.array([timeline.winners[-1], *most[most != timeline.winners[-1]]])


def _shown(label: str, done: str | None) -> str:
    """Return an action's name for the legend, marked where it is the action done."""
    suffix = DONE if label == done else ""
    return shortened(label, NAME_COLUMNS - len(suffix)) + suffix


def _draw_decision(axes: Axes, timeline: AnswerTimeline, labels: Sequence[str]) -> None:
    """Draw each answer's confidence as a bar from the answer before to this one, in its action's colour.

    A run of bars of the same action is named where it is wide enough.
    """
    colours = action_colours(len(labels))
    borders_s, winners = np.concatenate([[0.0], timeline.times_s]), timeline.winners
    axes.bar(
        borders_s[:-1], timeline.confidences, np.diff(borders_s), align="edge", color=colours[winners],
        edgecolor=colours[winners], linewidth=0.6,
    )  # fmt: skip
    begins = np.flatnonzero(np.concatenate([[True], winners[1:] != winners[:-1]]))
    for first, last in zip(begins, [*begins[1:], len(winners)], strict=True):
        name = shortened(labels[winners[first]], NAME_COLUMNS)
        if (borders_s[last] - borders_s[first]) / max(borders_s[-1], 1e-9) > _LETTER_WIDTH * cell_len(name):
            middle = (borders_s[first] + borders_s[last]) / 2
            axes.text(middle, 0.45, name, ha="center", va="center", path_effects=HALO, fontsize=8)
    axes.set_ylim(0, 1)
    axes.set_ylabel("confidence")
    answer = wrapped(labels[timeline.winners[-1]], NAME_COLUMNS - 5)
    axes.text(
        1.04, 0.5, f"answer at the end:\n{answer} {timeline.confidences[-1]:.2f}", transform=axes.transAxes, va="center"
    )


def _draw_actor(figure: Figure, answered: AnsweredSegment) -> None:
    """Draw the actor at about even instants, each figure beneath its time; the axes' unit is an inch."""
    left, _, width, _ = DECISION_IN
    axes = axes_at(figure, left - ACTOR_IN / 2, 0.1, width + ACTOR_IN, ACTOR_IN)
    axes.set_xlim(-ACTOR_IN / 2, width + ACTOR_IN / 2)
    axes.set_ylim(ACTOR_IN / 2, -ACTOR_IN / 2)
    hide_axes(axes)
    across = answered.relative_times * width
    chosen = evenly_spaced(across, FIGURES)
    kinematics = [answered.frames[index].kinematics for index in chosen]
    postures = np.array([each.posture for each in kinematics if each is not None])
    places = np.stack([across[chosen], np.zeros(len(chosen))], axis=1)
    draw_figures(axes, postures, places, 0.95 * ACTOR_IN, pen=Pen(2.0))


def evenly_spaced(places: Floats, most: int) -> list[int]:
    """Choose indices of rising places (n,): those nearest to `most` evenly spaced ones.

    One that lies closer than 0.6 spacings to the one before is left out.
    """
    wanted = np.linspace(places[0], places[-1], most)
    chosen: list[int] = []
    for index in (int(np.abs(places - place).argmin()) for place in wanted):
        if not chosen or places[index] - places[chosen[-1]] > 0.6 * (wanted[1] - wanted[0]):
            chosen.append(index)
    return chosen
