"""The services look on while simulated people act: drawn images, detected markers, hands with a Kinect's noise."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from benchmarks.rig.hard_scenes.conditions import Conditions
from benchmarks.rig.hard_scenes.hard_simulator import HardSimulator

from action_fusion.settings import Settings
from actum.messages import Action, Image, Message, Objects, Skeleton, Truth
from actum.skeletons import INDEX
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import ObjectSpec
from marker_tracker.settings import Settings as TrackerSettings
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.actor import EYE
from scene_simulator.programme import Task

from .trials import OURS, Trial
from .unmarked import events_of, told_unmarked

TAIL_S = 1.5
"""How long a scene goes on after its last action, so that it can be found."""
MEASURES = {"proximity": Settings(measure="proximity"), "joint": Settings(measure="joint")}
LEFT_M = 0.005
"""An object this near to where it ends has been left there."""


@dataclass(frozen=True)
class Scene:
    """One person who does a programme under conditions; the same numbers, the same scene."""

    programme: Sequence[Task]
    person: int
    conditions: Conditions
    image_hz: int

    def trials(self) -> list[Trial]:
        """Draw the scene once; each measure judges the same sightings, and the joint one also where nobody marks."""
        simulator = HardSimulator(
            self.programme, self.person, self.person, self.conditions, image_hz=self.image_hz, tail_s=TAIL_S
        )
        stream = list(observed(simulator))
        events = {name: events_of(stream, settings) for name, settings in MEASURES.items()}
        unmarked = told_unmarked(stream, events[OURS], MEASURES[OURS])
        ends = [message for message in stream if isinstance(message, Truth) and message.kind == "end"]
        return [
            Trial(
                truth=end,
                displacement_m=own_displacement(simulator, number, end),
                line_right=_line_right(simulator, number),
                seen_left=seen_left(simulator, stream, number, end),
                events={measure: of_measure[number] for measure, of_measure in events.items()},
                unmarked=unmarked[number],
            )
            for number, end in enumerate(ends)
        ]


def observed(simulator: HardSimulator) -> Iterator[Message]:
    """Yield postures, objects and truth, and at each end the action as if it were recognised."""
    tracker, started = MarkerTracker(_tracker_settings(simulator)), {}
    preprocessor = PosePreprocessor(PoseSettings.defaults())
    for messages in simulator.frames():
        for message in messages:
            if isinstance(message, Skeleton):
                yield from preprocessor.handle(message)
            elif isinstance(message, Image):
                yield from tracker.handle(message)
            elif isinstance(message, Truth):
                yield message
                started.setdefault(message.segment_id, message.stamp_ns)
                if message.kind == "end":
                    yield recognised(message, started[message.segment_id])


def _tracker_settings(simulator: HardSimulator) -> TrackerSettings:
    objects = simulator.scene.parameters.objects
    specs = {item.id: ObjectSpec(name=item.name, size_m=objects.marker_size_m) for item in objects.items}
    return TrackerSettings(objects=specs)


def recognised(end: Truth, start_ns: int) -> Action:
    """Answer a segment as a classifier that is always right would."""
    return Action(
        stamp_ns=end.stamp_ns,
        sensor=end.sensor,
        agent=end.agent,
        segment_id=end.segment_id,
        start_ns=start_ns,
        end_ns=end.stamp_ns,
        final=True,
        action=end.action,
        confidence=1.0,
        activations={},
        part=None,
        frames=0,
        missed=0,
    )


def own_displacement(simulator: HardSimulator, number: int, end: Truth) -> np.ndarray | None:
    """Turn the true displacement into the person's own directions."""
    if end.displacement_m is None:
        return None
    forward, up = _forward(simulator, number), np.array([0.0, -1.0, 0.0])
    return np.stack([np.cross(forward, up), up, forward]) @ end.displacement_m


def _forward(simulator: HardSimulator, number: int) -> np.ndarray:
    heading = simulator.scene.trials[number].layout.heading_rad
    return np.array([-np.sin(heading), 0.0, -np.cos(heading)])


def _line_right(simulator: HardSimulator, number: int) -> bool:
    """Tell whether the true line from eye to fingertip passes its object nearer than the others."""
    for state in simulator.scene.states(TAIL_S):
        if state.mark == "end" and state.segment == number:
            ahead = EYE * simulator.scene.actor.height_m * _forward(simulator, number)
            eye = state.joints_m[INDEX["head"]] + ahead
            ray, sights = state.fingertip_m - eye, state.positions_m - eye
            return int(np.argmax(sights @ ray / np.linalg.norm(sights, axis=1))) == state.target
    return False


def seen_left(simulator: HardSimulator, stream: Sequence[Message], number: int, end: Truth) -> bool:
    """Tell whether the object is seen in the segment where it is left, or held to its end."""
    states = [state for state in simulator.scene.states(TAIL_S) if state.segment == number]
    target = states[-1].target
    if target is None:
        return True
    last_m = states[-1].positions_m[target]
    away = [state for state in states if np.linalg.norm(state.positions_m[target] - last_m) > LEFT_M]
    since_ns = simulator.stamp_ns(away[-1].frame) if away else 0
    return any(
        since_ns < message.stamp_ns <= end.stamp_ns and any(o.id == end.object_id and o.seen for o in message.objects)
        for message in stream
        if isinstance(message, Objects)
    )
