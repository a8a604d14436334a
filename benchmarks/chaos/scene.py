"""The scene that is played, known ahead: which actions are done when, which are marked, and what is told of them."""

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.rig.chain import Chain

from actum.messages import Event, Segment, Truth
from actum.node import SECOND_NS, Source
from actum_command.simulated_model import ACTOR
from scene_simulator.endless_simulator import simulator_of
from scene_simulator.settings import Settings
from som_classifier.model_loading import load_model

IMAGE_HZ = 10
"""Enough to follow what is moved; the test is of processes, not of how much a tracker can see."""
MARKED_OF_FIVE = 3
"""How many of five actions in a row are marked: most, since of these each has to be answered."""
SESSION = "simulator-"
"""What the simulated scene's sessions are called, before the stamp at which they start."""


@dataclass(frozen=True)
class Planned:
    """One action of the scene: its number, its bounds (ns after the session's start), and whether it is marked."""

    number: int
    start_ns: int
    end_ns: int
    action: str
    object_id: int
    marked: bool


def settings_of(seed: int, image_hz: int = IMAGE_HZ) -> Settings:
    """Return the settings of the scene: one of the people who taught does all actions, and everyday things between."""
    scene = {"actor": ACTOR, "seed": seed, "image_hz": image_hz, "everyday": "all", "minutes": 0, "pauses": "short"}
    return Settings.model_validate({"repetitions": 0, **scene})


def arguments_of(seed: int) -> list[str]:
    """Return the arguments of the simulator's process."""
    settings = settings_of(seed)
    names = ("actor", "seed", "repetitions", "image_hz", "everyday", "minutes", "pauses")
    return [word for name in names for word in (f"--{name.replace('_', '-')}", str(getattr(settings, name)))]


def planned(seed: int, count: int) -> list[Planned]:
    """Return the first actions that the scene will show in each of its sessions, and draw which of them are marked."""
    rng = random.Random(seed)
    chosen = {first + drawn for first in range(1, count + 1, 5) for drawn in rng.sample(range(5), MARKED_OF_FIVE)}
    truths = _truths(simulator_of(settings_of(seed, image_hz=0), 0))
    bounds = zip(range(1, count + 1), truths, truths, strict=False)
    return [
        Planned(number, start.stamp_ns, end.stamp_ns, end.action, end.object_id, number in chosen)
        for number, start, end in bounds
    ]


def _truths(simulator: Source) -> Iterator[Truth]:
    for messages in simulator.frames():
        yield from (message for message in messages if isinstance(message, Truth))


def session_start_ns(session_id: str) -> int:
    """Return the stamp at which a session of the scene starts."""
    return int(session_id.removeprefix(SESSION))


def marks_of(segment_id: str, action: Planned, session_ns: int, sensor: str) -> list[Segment]:
    """Return the two marks of an action in a session that starts at a stamp."""
    bounds_ns = {"start": session_ns + action.start_ns, "end": session_ns + action.end_ns}
    return [
        Segment(stamp_ns=stamp_ns, sensor=sensor, kind=kind, segment_id=segment_id, origin="chaos")  # type: ignore[arg-type]
        for kind, stamp_ns in bounds_ns.items()
    ]


def undisturbed(seed: int, model: Path, actions: Sequence[Planned]) -> dict[int, Event]:
    """Return what is told of each marked action, by its number, where nothing ever fails and nothing is late."""
    chain = Chain(load_model(model))
    marks = [mark for each in actions if each.marked for mark in marks_of(str(each.number), each, 0, "kinect0")]
    told: dict[int, Event] = {}
    for messages in simulator_of(settings_of(seed), 0).frames():
        while marks and (marks[0].stamp_ns or 0) <= messages[0].stamp_ns:
            chain.feed(marks.pop(0))
        for message in messages:
            for output in chain.feed(message):
                if isinstance(output, Event) and output.segment_id.isdecimal():
                    told[int(output.segment_id)] = output
        if not actions or messages[0].stamp_ns > actions[-1].end_ns + SECOND_NS:
            return told
    return told
