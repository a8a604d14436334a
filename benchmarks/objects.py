"""Which object is acted on, and what becomes of it, in simulated scenes that are hard to see: as Markdown.

python benchmarks/objects.py: images are drawn, markers detected, hands tracked with a Kinect's noise. Fusion is told
what was done, and when, so that nothing but the object's side is measured. A few minutes on one core.
"""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Event, Image, Message, Skeleton, Truth
from actum.node import replay
from actum.skeletons import INDEX
from marker_tracker.node import MarkerTracker
from marker_tracker.settings import ObjectSpec
from marker_tracker.settings import Settings as TrackerSettings
from model_trainer.evaluation import wilson_interval
from pose_preprocessor.node import PosePreprocessor
from sensor_gateway.simulator import NO_OBJECT, Conditions, Sample, Simulator, load_conditions
from sensor_gateway.simulator.actor import EYE

ACTORS = range(41, 50)
POINTING_ACTORS = range(41, 48)
CONTACT = ("push", "pull", "put", "lift")
IDS = (1, 2, 3)
SPACINGS_M = (0.10, 0.20, 0.30)
POINTING_SPACING_M = 0.20
POINTING_DISTANCES_M = (1.0, 1.25, 1.5, 1.75, 2.0)
IMAGE_HZ = 10
TAIL_S = 0.5
OURS = "joint"
MEASURES = {"proximity": Settings(measure="proximity"), "joint": Settings(measure="joint")}
NEAR_M, NEAR_SHARE = 0.02, 0.10


@dataclass(frozen=True)
class Trial:
    """One repetition: what was done in truth, and each measure's event.

    `displacement_m` (3,) is to the person's right, up and forward; `line_right` tells whether the true line from eye
    to fingertip passes its object nearer than the others.
    """

    truth: Truth
    displacement_m: np.ndarray | None
    line_right: bool
    events: Mapping[str, Event]

    def object_right(self, measure: str) -> bool:
        found = self.events[measure].object
        return (NO_OBJECT if found is None else found.id) == self.truth.object_id

    def displacement_right(self, measure: str) -> bool:
        """Whether the displacement is right wherever the person was thought to face: how far level, how far up."""
        return self._is_near(measure, lambda d: np.array([np.hypot(d[0], d[2]), d[1]]))

    def direction_right(self, measure: str) -> bool:
        """Whether the displacement is right, and in the person's own directions."""
        return self._is_near(measure, lambda d: d)

    def _is_near(self, measure: str, seen: Callable[[np.ndarray], np.ndarray]) -> bool:
        """Whether the displacement, looked at in some way, is right to 2 cm, or to a tenth of it."""
        motion, true_m = self.events[measure].motion, self.displacement_m
        if motion is None or true_m is None:
            return False
        missed_m = float(np.linalg.norm(seen(np.array(motion.displacement_m)) - seen(true_m)))
        return missed_m <= max(NEAR_M, NEAR_SHARE * float(np.linalg.norm(true_m)))


def performed(programme: Sequence[Sample], actor: int, seed: int, conditions: Conditions) -> list[Trial]:
    """Let one person do a programme and the services look on."""
    simulator = Simulator(programme, actor, seed, image_hz=IMAGE_HZ, tail_s=TAIL_S, conditions=conditions)
    stream = list(_observed(simulator))
    events = {name: _events(stream, settings) for name, settings in MEASURES.items()}
    ends = [message for message in stream if isinstance(message, Truth) and message.kind == "end"]
    lines = _lines_right(simulator)
    return [
        Trial(end, _own_displacement(simulator, number, end), lines[number], {m: events[m][number] for m in events})
        for number, end in enumerate(ends)
    ]


def _observed(simulator: Simulator) -> Iterator[Message]:
    """Yield postures, objects and truth, and at each end the action as if it were recognised."""
    preprocessor, tracker, started = PosePreprocessor(), MarkerTracker(_tracker_settings(simulator)), {}
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
                    yield _recognised(message, started[message.segment_id])


def _tracker_settings(simulator: Simulator) -> TrackerSettings:
    objects = simulator.scene.parameters.objects
    specs = {item.id: ObjectSpec(name=item.name, size_m=objects.marker_size_m) for item in objects.items}
    return TrackerSettings(objects=specs)


def _recognised(end: Truth, start_ns: int) -> Action:
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


def _events(stream: Sequence[Message], settings: Settings) -> list[Event]:
    answered = replay(ActionFusion(settings), [(message.stamp_ns, message) for message in stream])
    return sorted((m for m in answered if isinstance(m, Event)), key=lambda event: event.start_ns)


def _own_displacement(simulator: Simulator, number: int, end: Truth) -> np.ndarray | None:
    """Turn the true displacement into the person's own directions."""
    if end.displacement_m is None:
        return None
    forward, up = _forward(simulator, number), np.array([0.0, -1.0, 0.0])
    return np.stack([np.cross(forward, up), up, forward]) @ end.displacement_m


def _forward(simulator: Simulator, number: int) -> np.ndarray:
    heading = simulator.scene.trials[number].layout.heading_rad
    return np.array([-np.sin(heading), 0.0, -np.cos(heading)])


def _lines_right(simulator: Simulator) -> list[bool]:
    """Tell of each repetition whether the true line from eye to fingertip ends at its object."""
    found = []
    for state in simulator.scene.states():
        if state.mark == "end" and state.segment is not None:
            ahead = EYE * simulator.scene.actor.height_m * _forward(simulator, state.segment)
            eye = state.joints_m[INDEX["head"]] + ahead
            ray, sights = state.fingertip_m - eye, state.positions_m - eye
            found.append(int(np.argmax(sights @ ray / np.linalg.norm(sights, axis=1))) == state.target)
    return found


def contacts(conditions: Conditions, spacing_m: float) -> list[Trial]:
    """Let everybody do the four actions, each on another object."""
    spaced = conditions.model_copy(update={"spacing_m": spacing_m})
    return [
        trial
        for actor in ACTORS
        for trial in performed([Sample(a, IDS[(actor + i) % 3]) for i, a in enumerate(CONTACT)], actor, actor, spaced)
    ]


def pointings(distance_m: float) -> list[Trial]:
    """Let everybody point at each object, from a distance."""
    far = Conditions(spacing_m=POINTING_SPACING_M, distance_m=distance_m)
    everybody = (performed([Sample("point", number) for number in IDS], actor, actor, far) for actor in POINTING_ACTORS)
    return [trial for trials in everybody for trial in trials]


def pantomimes(spacing_m: float) -> list[Trial]:
    """Let everybody do the four actions beside the objects."""
    apart = Conditions(spacing_m=spacing_m)
    return [t for actor in ACTORS for t in performed([Sample(a, NO_OBJECT) for a in CONTACT], actor, actor, apart)]


def share(trials: Sequence[Trial], right: Callable[[Trial], bool]) -> str:
    hits, n = sum(map(right, trials)), len(trials)
    low, high = wilson_interval(hits, n)
    return f"{hits} ({hits / n:.0%}; {low:.0%} to {high:.0%})"


def contact_row(what: str, trials: Sequence[Trial]) -> str:
    objects = [share(trials, lambda t, m=m: t.object_right(m)) for m in MEASURES]
    moved = [share(trials, lambda t: t.displacement_right(OURS)), share(trials, lambda t: t.direction_right(OURS))]
    return f"| {what} | {len(trials)} | {' | '.join([*objects, *moved])} |"


def contact_table() -> Iterator[str]:
    yield "| push, pull, put, lift | n | object: proximity | object: joint | displacement | with direction |"
    yield "|---|---:|---|---|---|---|"
    everything: list[Trial] = []
    for name, conditions in load_conditions().items():
        of_condition = []
        for spacing_m in SPACINGS_M:
            trials = contacts(conditions, spacing_m)
            yield contact_row(f"{name}, {100 * spacing_m:.0f} cm apart", trials)
            of_condition += trials
        yield contact_row(f"**{name}**", of_condition)
        everything += of_condition
    for action in CONTACT:
        yield contact_row(f"{action}, all conditions", [t for t in everything if t.truth.action == action])
    yield contact_row("**all**", everything)
    yield "\nDisplacements: within 2 cm or a tenth, how far level and how far up; with direction: as the person faces."


def pointing_and_pantomime_tables() -> Iterator[str]:
    yield "\n| pointing, objects 20 cm apart | n | object | object by the true line from eye to fingertip |"
    yield "|---|---:|---|---|"
    pointed = {distance_m: pointings(distance_m) for distance_m in POINTING_DISTANCES_M}
    rows = {f"from {distance_m:g} m": trials for distance_m, trials in pointed.items()}
    for what, trials in {**rows, "**all**": [t for of in pointed.values() for t in of]}.items():
        right, line = share(trials, lambda t: t.object_right(OURS)), share(trials, lambda t: t.line_right)
        yield f"| {what} | {len(trials)} | {right} | {line} |"
    yield "\n| pantomimes | n | called so: proximity | called so: joint |"
    yield "|---|---:|---|---|"
    beside = {f"objects {100 * spacing_m:.0f} cm apart": pantomimes(spacing_m) for spacing_m in SPACINGS_M}
    for what, trials in {**beside, "**all**": [t for of in beside.values() for t in of]}.items():
        shares = [share(trials, lambda t, m=m: t.object_right(m)) for m in MEASURES]
        yield f"| {what} | {len(trials)} | {' | '.join(shares)} |"


def main() -> None:
    cv2.setNumThreads(1)
    for table in (contact_table, pointing_and_pantomime_tables):
        for line in table():
            print(line)
            sys.stdout.flush()


if __name__ == "__main__":
    main()
