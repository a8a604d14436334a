"""A short simulated scene with a mark for each action, told alike wherever the services run."""

import threading
from collections.abc import Iterable
from pathlib import Path

from benchmarks.rig.chain import Chain

from actum.messages import Event, Message, Truth
from actum.runtime import Client, Listening
from actum_command.scene_marks import mark_of
from scene_simulator.endless_simulator import simulator_of
from scene_simulator.settings import Settings
from som_classifier.model_loading import load_model

SCENE = {"repetitions": 1, "everyday": "none", "seed": 3}
ACTIONS = 5
SCENE_S = 120.0
"""A scene of five actions takes some 25 s, and its answers some more where the link is bad."""
Told = dict[str, tuple[str | None, str | None]]
"""The action and the object's name of each segment."""


def on_one_host(model: Path) -> Told:
    """What is told of the scene where nothing lies between the services."""
    chain = Chain(load_model(model))
    simulator = simulator_of(Settings.model_validate(SCENE), start_ns=1)
    messages = [marked for frame in simulator.frames() for message in frame for marked in with_mark(message, "")]
    return told(output for message in messages for output in chain.feed(message))


def with_mark(message: Message, prefix: str) -> list[Message]:
    """A message, and before it the mark of a truth, whose segments are named with the prefix."""
    if not isinstance(message, Truth):
        return [message]
    return [mark_of(message).model_copy(update={"segment_id": prefix + message.segment_id}), message]


def told(messages: Iterable[Message], prefix: str = "") -> Told:
    events = [message for message in messages if isinstance(message, Event) and message.segment_id.startswith(prefix)]
    return {
        event.segment_id.removeprefix(prefix): (event.action, event.object and event.object.name) for event in events
    }


def mark(switch: Client, truths: Listening, prefix: str, over: threading.Event) -> None:
    while not over.wait(0.005):
        while (received := truths.receive()) is not None:
            if isinstance(received.message, Truth):
                switch.put(with_mark(received.message, prefix)[0])
