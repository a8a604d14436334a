"""Action and object together: simulated people through preprocessor, classifier and fusion, their actions marked."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from benchmarks.intent.takes import LAYOUTS, OBJECT_SD_M, TAIL_S, contacts_of, scene_of

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings as FusionSettings
from actum.arrays import Array
from actum.messages import Intended, Intent, Message, Objects, Posture, Segment, TrackedObject
from actum.node import SECOND_NS
from actum_command.simulated_model import SIMULATED_MODEL
from actum_model_trainer.foreseeing.scoring import BACKGROUND, BEFORE_S, HORIZON_S, expected_calibration_error
from actum_model_trainer.foreseeing.takes import Contact
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings
from scene_simulator.simulated_scene import Scene
from scene_simulator.simulator import Simulator, labelled_stream
from som_classifier.model_loading import load_model
from som_classifier.node import SomClassifier


class ArrangedSimulator(Simulator):
    """The simulated scene with other objects at other places."""

    def __init__(self, scene: Scene) -> None:
        self._arranged = scene
        super().__init__(scene.programme, *scene.seeds, image_hz=0, tail_s=TAIL_S)
        self.scene = scene


class Watched(NamedTuple):
    """What was said of a person whose true contacts are known.

    Attributes:
        contacts: by stamp.
        stamps_ns: of the postures.
        intents: what was said, of some of the postures.
    """

    contacts: list[Contact]
    stamps_ns: list[int]
    intents: list[Intent]

    def likeliest(self, seconds: float) -> Iterator[tuple[Contact, Intended | None]]:
        """Yield each contact with what was said to be likeliest so long (s) before; None where nothing was."""
        for contact in self.contacts:
            at_ns = contact.stamp_ns - round(seconds * SECOND_NS)
            last = [intent for intent in self.intents if intent.stamp_ns <= at_ns][-1:]
            yield contact, next((each for intent in last for each in intent.intended[:1]), None)


def table(persons: Sequence[int], seed: int) -> Iterator[str]:
    """Yield what is said before the contacts of these people, and how well its probabilities hold."""
    scenes = [scene_of(person, seed, *layout) for person in persons[:4] for layout in (LAYOUTS[1], LAYOUTS[3])]
    said = [_watched(scene) for scene in scenes]
    count = sum(len(each.contacts) for each in said)
    yield f"{count} contacts; the model is the one of the simulated scene that comes with actum."
    rows = [f"| {seconds} | {pairs_right(said, seconds):.2f} |" for seconds in BEFORE_S]
    yield "\n".join(["| before the contact (s) | likeliest action and object right |", "|---:|---:|", *rows])
    error = expected_calibration_error(np.concatenate([outcomes(each) for each in said]))
    yield f"Expected calibration error of the pair's probability: {error:.3f}."


def _watched(scene: Scene) -> Watched:
    fusion = ActionFusion(FusionSettings())
    received = [*received_in(scene)]
    intents = [put for each in received for put in fusion.handle(each) if isinstance(put, Intent)]
    return Watched(contacts_in(scene), stamps_of(received), intents)


def contacts_in(scene: Scene) -> list[Contact]:
    """Return the true contacts."""
    return [*contacts_of(scene, [*scene.states(TAIL_S)])]


def stamps_of(received: Sequence[Message]) -> list[int]:
    """Return the stamps of the postures."""
    return [each.stamp_ns for each in received if isinstance(each, Posture)]


def received_in(scene: Scene) -> Iterator[Message]:
    """Yield the postures, objects and actions that the fusion receives; the actions are marked."""
    preprocessor, classifier = PosePreprocessor(PoseSettings.defaults()), SomClassifier(load_model(SIMULATED_MODEL))
    for message in _captured(scene):
        postures = list(preprocessor.handle(message))
        marked: list[Message] = [message] if isinstance(message, Segment) else postures
        actions = [action for each in marked for action in classifier.handle(each)]
        yield from [message] if isinstance(message, Objects) else [*postures, *actions]


def _captured(scene: Scene) -> Iterator[Message]:
    """Yield skeletons, marks, and the objects of every second frame with a tracker's noise."""
    simulator, rng = ArrangedSimulator(scene), np.random.default_rng(scene.seeds)
    stream = [m for m in labelled_stream(simulator) if m.stamp_ns is not None]
    for state in [*scene.states(TAIL_S)][::2]:
        found = [
            TrackedObject(
                id=item.id,
                name=item.name,
                position_m=(place_m + rng.normal(0, OBJECT_SD_M, 3)).tolist(),
                quaternion_xyzw=[0.0, 0.0, 0.0, 1.0],
                confidence=1.0,
                seen=True,
            )
            for item, place_m in zip(scene.items, state.positions_m, strict=True)
        ]
        stamp_ns = simulator.stamp_ns(state.frame)
        session = stream[0].session_id if hasattr(stream[0], "session_id") else ""
        stream.append(Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=found, session_id=session))
    yield from sorted(stream, key=lambda message: message.stamp_ns or 0)


def pairs_right(said: Sequence[Watched], seconds: float) -> float:
    """Return the share of contacts whose action and object were said to be the likeliest so long (s) before."""
    right = [
        first is not None and (first.object_id, first.action) == (contact.number, contact.action)
        for each in said
        for contact, first in each.likeliest(seconds)
    ]
    return float(np.mean(right))


def outcomes(watched: Watched) -> Array:
    """Return the probability of each pair in each intent, and whether it came, (N, 2)."""
    told = [
        (intent.stamp_ns, one)
        for intent in watched.intents
        for one in intent.intended
        if (one.action_probability or 0.0) > BACKGROUND
    ]
    came = [
        any(
            0 < contact.stamp_ns - stamp_ns <= HORIZON_S * SECOND_NS
            for contact in watched.contacts
            if (contact.number, contact.action) == (one.object_id, one.action)
        )
        for stamp_ns, one in told
    ]
    return np.stack([[one.action_probability or 0.0 for _, one in told], came], axis=1)
