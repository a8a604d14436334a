"""A live fusion says what a person is about to touch as a replay does, to the value, where objects come in time."""

import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum import keys
from actum.messages import Intent, Status
from actum.node import replay
from live import PATIENCE_S, System, collect
from scenes import acting_on
from wire import without_seq

pytestmark = pytest.mark.system
SCENE = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.25, 0.0, 0.5)})
BOUNDS_S = (-0.9, 0.9)
"""Shorter than the two seconds for which a fusion keeps where objects were: here all of these come first."""


def test_intents_are_those_of_the_replay(running: System) -> None:
    postures, sightings = SCENE.postures(*BOUNDS_S), SCENE.sightings(*BOUNDS_S)
    by_stamp = sorted([*sightings, *postures], key=lambda message: message.stamp_ns)
    replayed = replay(ActionFusion(Settings()), [(message.stamp_ns, message) for message in by_stamp])
    expected = [message for message in replayed if isinstance(message, Intent)]
    assert any(intent.intended for intent in expected)
    running.start_router()
    running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        assert client.wait_for_subscriber(keys.OBJECTS, PATIENCE_S)
        intents, statuses = (client.listen(keys.pattern(topic, client.sensor)) for topic in (keys.INTENT, keys.STATUS))
        for sighting in sightings:
            client.put(sighting)
        objects = keys.key(keys.OBJECTS, client.sensor)
        collect(statuses, Status, lambda found: any(s.handled.get(objects) == len(sightings) for s in found))
        for posture in postures:
            client.put(posture)
        said = collect(intents, Intent, lambda found: len(found) >= len(expected))
    assert without_seq(said) == without_seq(expected)
