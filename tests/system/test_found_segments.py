"""Live processes: what nobody marked is marked, answered and told, once."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import AUTO, Action, Event, Message, Posture, Segment, Status
from actum.runtime import Client, Listening
from chain import replayed
from live import PATIENCE_S, System, collect, wait_until
from recognisers import tiny_model
from scenes import acting_on
from som_classifier.node import SomClassifier
from spotters import beating
from wire import without_seq

CLASSIFIER = Path(__file__).parents[1] / "finding_classifier.py"
SCENE = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))
POSTURES = SCENE.postures()
pytestmark = pytest.mark.system


def put_scene(client: Client) -> None:
    """Put postures and objects in turn; none is lost, since both are fewer than a ring holds."""
    assert client.wait_for_subscriber(keys.OBJECTS, PATIENCE_S)
    for posture, sighting in zip(POSTURES, SCENE.sightings(), strict=True):
        client.put(posture)
        client.put(sighting)


def offline(postures: list[Posture]) -> list[Message]:
    return [m for _, m in replayed(SomClassifier(beating(tiny_model())), [(p.stamp_ns, p) for p in postures])]


def comparable(messages: list) -> list[bytes]:
    return without_seq(sorted(messages, key=lambda m: (m.segment_id, getattr(m, "kind", ""))))


def test_a_scene_without_marks_gives_the_marks_actions_and_events_of_its_replay(running: System) -> None:
    expected = offline(POSTURES)
    finals = [m for m in expected if isinstance(m, Action) and m.final]
    running.start_router()
    running.start_script(CLASSIFIER)
    running.start("action_fusion")
    with running.client() as client:
        running.wait_for_services(client, "som_classifier", "action_fusion")
        assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
        segments, actions, events, statuses = (
            client.listen(keys.pattern(topic, client.sensor))
            for topic in (keys.SEGMENT, keys.ACTION, keys.EVENT, keys.STATUS)
        )
        put_scene(client)
        told = collect(events, Event, lambda found: len(found) >= len(finals))
        answered = [m for m in collect(actions, Action, bool) if m.final]
        marks = collect(segments, Segment, lambda found: len(found) >= 2 * len(finals))
        seen = f"actum/{client.sensor}/segment"
        heard: list[Status] = []

        def own_marks_came_back() -> bool:
            heard.extend(collect(statuses, Status, lambda _: True))
            own = [status for status in heard if status.service == "som_classifier"]
            return bool(own) and own[-1].handled.get(seen, 0) >= 2 * len(finals)

        wait_until(own_marks_came_back, "the classifier has heard its own marks")
        status = [status for status in heard if status.service == "som_classifier"][-1]
    assert len(finals) >= 2
    assert comparable(answered) == comparable(finals)
    assert comparable(marks) == comparable([m for m in expected if isinstance(m, Segment)])
    assert {m.origin for m in marks} == {AUTO}
    assert sorted(e.segment_id for e in told) == sorted(m.segment_id for m in finals)
    assert all(e.valid for e in told)
    assert (status.rejects, status.counts) == ({}, {"found": len(finals), "told": len(finals)})


def test_a_classifier_started_anew_in_the_middle_says_nothing_twice_and_gives_new_names(running: System) -> None:
    """Each of the two says what it would say of its own part; the marks of the first are not answered by the second."""
    running.start_router()
    middle = len(POSTURES) // 2
    told: list[list[Action]] = []
    with running.client() as client:
        actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        for part in (POSTURES[:middle], POSTURES[middle:]):
            classifier = running.start_script(CLASSIFIER)
            running.wait_for_services(client, "som_classifier")
            told.append(told_of(part, client, actions))
            classifier.terminate()
            wait_until(lambda: not client.alive(), "the classifier is gone")
        assert not collect(actions, Action, lambda _: True)
    names = [{m.segment_id for m in part} for part in told]
    assert all(names) and not names[0] & names[1]


def told_of(postures: list[Posture], client: Client, actions: Listening) -> list[Action]:
    """Put postures and return all actions that follow, which are those of their replay."""
    assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
    for posture in postures:
        client.put(posture)
    expected = [m for m in offline(postures) if isinstance(m, Action)]
    told: list[Action] = collect(actions, Action, lambda found: len(found) >= len(expected))
    assert without_seq(told) == without_seq(expected)
    return told
