"""How long fusion takes to decide on an event among four people, each at a table, and eight objects in sight."""

import time
from collections.abc import Iterator

import numpy as np
from benchmarks.objects.observing import recognised

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings as FusionSettings
from actum.arrays import Array
from actum.messages import Event, Message, Objects, Skeleton, TrackedObject, Truth
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.group import Group
from scene_simulator.programme import balanced_programme

PEOPLE, OBJECTS_EACH, REPETITIONS = 4, 2, 4
"""How many people, how many of each one's objects are tracked, and how often each does each action."""
NOISE_M = 0.002
"""Standard deviation of an object's position: a marker's at two metres."""


def inputs() -> Iterator[Message]:
    """Yield what fusion receives: postures, objects with every second frame, and final actions as they truly were."""
    rng, preprocessor = np.random.default_rng(0), PosePreprocessor(PoseSettings.defaults())
    group = Group([balanced_programme(REPETITIONS, seed) for seed in range(PEOPLE)])
    states = [simulator.scene.states(tail_s=3.0) for simulator in group.simulators]
    started: dict[int, int] = {}
    for number, frame in enumerate(group.frames()):
        skeleton = next(message for message in frame if isinstance(message, Skeleton))
        yield from preprocessor.handle(skeleton)
        now = [next(of_person, None) for of_person in states]
        if number % 2 == 0:
            centres_m = [state.positions_m[:OBJECTS_EACH] for state in now if state is not None]
            yield objects(skeleton, np.concatenate(centres_m) + rng.normal(0.0, NOISE_M, (sum(map(len, centres_m)), 3)))
        for truth in (message for message in frame if isinstance(message, Truth)):
            if truth.kind == "start":
                started[truth.agent] = truth.stamp_ns
            else:
                yield recognised(truth, started[truth.agent]).model_copy(update={"part": f"{truth.hand}_arm"})


def objects(skeleton: Skeleton, centres_m: Array) -> Objects:
    """Say that objects are seen at these positions (n, 3; m, camera frame)."""
    placed = [
        TrackedObject(
            id=number,
            name=f"object {number}",
            position_m=centre_m,
            quaternion_xyzw=[0.0, 0.0, 0.0, 1.0],
            confidence=1.0,
            seen=True,
        )
        for number, centre_m in enumerate(centres_m.tolist())
    ]
    return Objects(stamp_ns=skeleton.stamp_ns, sensor=skeleton.sensor, objects=placed, session_id=skeleton.session_id)


def decisions_ms(messages: list[Message]) -> tuple[list[float], list[Event]]:
    """Return how long each message took that completed an event (ms), and the events."""
    fusion, took_ms, events = ActionFusion(FusionSettings()), [], []
    for message in messages:
        began_s = time.perf_counter()
        decided = [each for each in fusion.handle(message) if isinstance(each, Event)]
        if decided:
            took_ms.append(1e3 * (time.perf_counter() - began_s) / len(decided))
            events += decided
    return took_ms, events
