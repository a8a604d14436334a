"""The same scenes without marks: the classifier, which learnt from other people, finds the actions by itself."""

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from pathlib import Path

from benchmarks.rig.hard_scenes.conditions import PLAIN, Conditions
from benchmarks.rig.hard_scenes.hard_simulator import HardSimulator

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Event, Message, Posture
from actum.node import replay
from actum.recorder import Recorder
from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.training import train_to_spot
from scene_simulator.everyday import FAMILIAR, Everyday
from scene_simulator.programme import Task, balanced_programme, object_ids
from scene_simulator.simulator import labelled_stream
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.presets import DEFAULT
from som_classifier.segmentation import Segmentation

TEACHERS = range(9)
"""The people who teach; those who are tested are numbered from 1001."""
TAUGHT_EACH = 3
"""Repetitions of each action by each of them, with everyday doings between."""
TAUGHT_FROM_M = (1.0, 1.5, 2.0)
"""How far away things are at which they point besides: each of them is taught by three people."""


@dataclass(frozen=True)
class Unmarked:
    """What was told of one action that nobody marked.

    Attributes:
        event: the event that tells of it, None where it was not found.
        alarms: how many events tell of no action, but are nearer to this one than to the others.
        with_true: where the event names another object than the marked one's does, the event with only its `start` or
            only its `end` as marked.
    """

    event: Event | None
    alarms: int
    with_true: Mapping[str, Event]


def told_unmarked(stream: Sequence[Message], marked: Sequence[Event], settings: Settings) -> list[Unmarked]:
    """Hide the marked actions of a stream, let others be found, and return what is told of each in its place."""
    heard = list(_with_found_actions([message for message in stream if not isinstance(message, Action)]))
    events = events_of(heard, settings)
    telling = [_telling(event, marked, events) for event in marked]
    strays = [event for event in events if all(event is not chosen for chosen in telling)]
    nearest = [max(range(len(marked)), key=lambda n: _overlap_ns(stray, marked[n])) for stray in strays]
    return [
        Unmarked(event, nearest.count(number), _with_true_bounds(heard, event, marked[number], settings))
        for number, event in enumerate(telling)
    ]


def events_of(stream: Sequence[Message], settings: Settings) -> list[Event]:
    """Replay a stream through the fusion; return its events in the order in which they begin."""
    arrivals_ns = accumulate((message.stamp_ns for message in stream), max)
    answered = replay(ActionFusion(settings), zip(arrivals_ns, stream, strict=True))
    return sorted((m for m in answered if isinstance(m, Event)), key=lambda event: event.start_ns)


def _with_found_actions(stream: Sequence[Message]) -> Iterator[Message]:
    """Yield a stream's messages, and each final action that the classifier finds in it when it is decided."""
    classifier = SomClassifier(taught(), segmentation=Segmentation(segments="auto"))
    for message in stream:
        yield message
        if isinstance(message, Posture):
            answers = classifier.handle(message)
            yield from (answer for answer in answers if isinstance(answer, Action) and answer.final)


def _telling(marked: Event, all_marked: Sequence[Event], events: Sequence[Event]) -> Event | None:
    """Return the event that overlaps a marked one, and no other one more; of several one of its action, the longest.

    None where there is none.
    """
    own = [
        event
        for event in events
        if _overlap_ns(event, marked) > 0 and marked is max(all_marked, key=lambda other: _overlap_ns(event, other))
    ]
    return max(own, key=lambda event: (event.action == marked.action, _overlap_ns(event, marked)), default=None)


def _overlap_ns(first: Event, second: Event) -> int:
    return min(first.end_ns, second.end_ns) - max(first.start_ns, second.start_ns)


def _with_true_bounds(
    heard: Sequence[Message], event: Event | None, marked: Event, settings: Settings
) -> dict[str, Event]:
    if event is None or _object_id(event) == _object_id(marked):
        return {}
    bounds = {"start": {"start_ns": marked.start_ns}, "end": {"end_ns": marked.end_ns}}
    changed = {bound: events_of(_changed(heard, event, true), settings) for bound, true in bounds.items()}
    return {bound: next(each for each in all_of if _is_of(each, event)) for bound, all_of in changed.items()}


def _object_id(event: Event) -> int | None:
    return None if event.object is None else event.object.id


def _changed(heard: Sequence[Message], event: Event, bound: Mapping[str, int]) -> list[Message]:
    """Change a bound of the action of an event."""
    return [
        message.model_copy(update=bound) if isinstance(message, Action) and _is_of(message, event) else message
        for message in heard
    ]


def _is_of(message: Action | Event, event: Event) -> bool:
    return message.segment_id == event.segment_id


@cache
def taught() -> Model:
    """Train the default recogniser on people who also do everyday things between the actions.

    Each does every action at the table, and points at things from afar.
    """
    with tempfile.TemporaryDirectory() as folder:
        recordings = [_recorded(*scene, Path(folder)) for teacher in TEACHERS for scene in _scenes(teacher)]
        samples = samples_from(recordings)
    return train_to_spot(samples.usable, samples.streams, DEFAULT)


def _scenes(teacher: int) -> Iterator[tuple[str, int, Sequence[Task], Conditions]]:
    yield "near", teacher, balanced_programme(TAUGHT_EACH, teacher, teacher), PLAIN
    far = Conditions(distance_m=TAUGHT_FROM_M[teacher % len(TAUGHT_FROM_M)])
    yield "far", teacher, [Task("point", number) for number in object_ids()], far


def _recorded(what: str, teacher: int, programme: Sequence[Task], conditions: Conditions, folder: Path) -> Recording:
    simulator = HardSimulator(programme, teacher, teacher, conditions, image_hz=0, everyday=Everyday(FAMILIAR))
    path = folder / f"{what}-{teacher}.mcap"
    with Recorder(path, person=str(teacher), source="simulator") as recorder:
        for message in labelled_stream(simulator):
            recorder.write(message)
    return Recording(path)
