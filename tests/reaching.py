"""Recordings of a simulated person whose hand moves objects, with the instants at which the hand begins to."""

from collections.abc import Iterator

import numpy as np
from benchmarks.intent.takes import OBJECT_SD_M, contacts_of

from actum.messages import Message, Objects, Skeleton, TrackedObject
from actum_model_trainer.foreseeing.takes import Contact
from scene_simulator.programme import Task
from scene_simulator.simulated_scene import Scene
from scene_simulator.simulator import Simulator, labelled_stream

PROGRAMME = (Task("lift", 1), Task("push", 2), Task("point", 3), Task("pull", 3))
SEEDS = (131, 4)
TAIL_S = 2.0
FAR_M = np.array([2.0, 0.0, 3.0])
"""Where an object is that nobody reaches."""


def messages() -> list[Message]:
    """Skeletons, labelled marks and truths, and with each skeleton the objects, with a tracker's noise."""
    simulator = Simulator(PROGRAMME, *SEEDS, image_hz=0, tail_s=TAIL_S)
    rng = np.random.default_rng(SEEDS)
    stream = list(labelled_stream(simulator))
    [session] = {message.session_id for message in stream if isinstance(message, Skeleton)}
    seen = [
        objects(
            simulator.stamp_ns(state.frame),
            {
                item.id: place_m + rng.normal(0, OBJECT_SD_M, 3)
                for item, place_m in zip(simulator.scene.items, state.positions_m, strict=True)
            },
            session,
        )
        for state in simulator.scene.states(TAIL_S)
    ]
    return [*stream, *seen]


def objects(stamp_ns: int, places_m: dict[int, np.ndarray], session: str = "") -> Objects:
    found = [
        TrackedObject(
            id=number,
            name=f"object {number}",
            position_m=place_m.tolist(),
            quaternion_xyzw=[0.0, 0.0, 0.0, 1.0],
            confidence=1.0,
            seen=True,
        )
        for number, place_m in places_m.items()
    ]
    return Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=found, session_id=session)


def true_contacts() -> Iterator[Contact]:
    """The first motion (5 mm, without noise) of each object that is moved."""
    scene = Scene(PROGRAMME, *SEEDS)
    yield from (each for each in contacts_of(scene, list(scene.states(TAIL_S))) if each.action != "point")
