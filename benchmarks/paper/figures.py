"""The paper's figures: the neurons' activity over an action, the object told, the hand's distance from each object."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import matplotlib as mpl
import numpy as np
from benchmarks.rig.chain import Chain
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from actum.messages import Action, Event, Objects, Skeleton, Truth
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum_command.demo.marked import TABLE_2
from actum_command.scene_marks import mark_of
from actum_model_trainer.training import train
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from som_classifier.model import Model

from .data import TEST_SEED, TRAINED_EACH, TRAINING_SEED, Data
from .measuring import PART
from .scene import IMAGE_HZ, PAPERS_MEASURE, TAIL_S

PLACE = Path(__file__).parents[2] / "docs" / "paper.png"
COLOURS = dict(zip(TABLE_2, mpl.color_sequences["tab10"], strict=False))
HAND = INDEX["right_hand"]
FURTHEST_M = 0.6


@dataclass
class Course:
    """What was said while one action was done.

    Attributes:
        neurons: time (s since the start) and every neuron's activity.
        distances: time and the hand's distance (m) from each object that is seen.
    """

    truth: Truth
    neurons: list[tuple[float, dict[str, float]]] = field(default_factory=list)
    distances: list[tuple[float, dict[int, float]]] = field(default_factory=list)
    event: Event | None = None


def figures(data: Data) -> Iterator[str]:
    """Draw the first sample of each action that the model has not seen."""
    model = train(data.simulated(0, TRAINED_EACH, TRAINING_SEED), PART, 0)
    courses = {course.truth.action: course for course in reversed(courses_of(model))}
    draw([courses[action] for action in TABLE_2]).savefig(PLACE, dpi=110)
    yield f"""![the neurons and the distances](../../docs/{PLACE.name})"""
    yield """The first sample of each action in the test of the simulated actor on whom the model was trained: what each
neuron of the third layer answers to what was seen so far, and how far the right hand is from each object."""


def courses_of(model: Model) -> list[Course]:
    """Let the actor do each action twice before the nodes."""
    simulator = Simulator(balanced_programme(2, TEST_SEED, 0), 0, TEST_SEED, image_hz=IMAGE_HZ, tail_s=TAIL_S)
    chain, courses, hand_m = Chain(model, PAPERS_MEASURE), [], np.full(3, np.nan)
    for message in (message for instant in simulator.frames() for message in instant):
        if isinstance(message, Truth) and message.kind == "start":
            courses.append(Course(message))
        for said in chain.feed(mark_of(message) if isinstance(message, Truth) else message):
            if isinstance(said, Skeleton):
                hand_m = np.array(said.agents[0].joints[HAND])
            elif courses:
                _note(courses, said, hand_m)
    return courses


def _note(courses: Sequence[Course], said: object, hand_m: np.ndarray) -> None:
    """Keep what belongs to the newest action, and the event with the action that it is of."""
    newest = courses[-1]
    if isinstance(said, Action) and said.segment_id == newest.truth.segment_id and said.activations:
        newest.neurons.append((_seconds(newest, said.stamp_ns), said.activations))
    elif isinstance(said, Objects) and (newest.event is None):
        away = {found.id: float(np.linalg.norm(hand_m - found.position_m)) for found in said.objects}
        newest.distances.append((_seconds(newest, said.stamp_ns), away))
    elif isinstance(said, Event):
        next(course for course in courses if course.truth.segment_id == said.segment_id).event = said


def _seconds(course: Course, stamp_ns: int) -> float:
    return (stamp_ns - course.truth.stamp_ns) / SECOND_NS


def draw(courses: Sequence[Course]) -> Figure:
    """Draw a column for each action: what was told, the neurons, the distances."""
    figure = Figure(figsize=(3.1 * len(courses), 5.6), layout="constrained")
    rows = figure.subplots(2, len(courses), sharex="col", sharey="row")
    for column, course in enumerate(courses):
        _draw_neurons(rows[0, column], course)
        _draw_distances(rows[1, column], course)
    rows[0, 0].set_ylabel("neuron's activity (cosine)")
    rows[1, 0].set_ylabel("hand to object (m)")
    rows[1, 0].set_ylim(0, FURTHEST_M)
    figure.legend(*rows[0, 0].get_legend_handles_labels(), loc="outside upper left", ncols=len(TABLE_2), frameon=False)
    figure.legend(*rows[1, 0].get_legend_handles_labels(), loc="outside upper right", ncols=3, frameon=False)
    return figure


def _draw_neurons(axes: Axes, course: Course) -> None:
    for label, colour in COLOURS.items():
        own = [(time_s, activations[label]) for time_s, activations in course.neurons]
        axes.plot(*zip(*own, strict=True), color=colour, lw=2.4 if label == course.truth.action else 1.2, label=label)
    axes.set_title(f"{course.truth.action} object {course.truth.object_id}\ntold: {_told(course.event)}", fontsize=11)


def _told(event: Event | None) -> str:
    if event is None:
        return "nothing"
    found = "no object" if event.object is None else f"object {event.object.id}"
    return f"{event.action} {found} of {len(event.objects_present)}"


def _draw_distances(axes: Axes, course: Course) -> None:
    for number, style in zip(
        sorted({key for _, away in course.distances for key in away}), ("-", "--", ":"), strict=False
    ):
        own = [(time_s, away[number]) for time_s, away in course.distances if number in away]
        wide = 2.4 if number == course.truth.object_id else 1.2
        axes.plot(*zip(*own, strict=True), color="black", ls=style, lw=wide, label=f"object {number}")
    axes.set_xlabel("s")
