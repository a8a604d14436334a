"""A service that is started again goes on with what comes, and does not say once more what was said."""

import time
from collections.abc import Sequence

import pytest

from actum import keys
from actum.messages import Event, Message
from actum.runtime import Client
from actum.runtime.inbox import HISTORY_S
from live import System, collect, wait_until
from scenes import acting_on, action, at

PUSH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))
LATER_S = 10.0
pytestmark = pytest.mark.system


def put_all(client: Client, messages: Sequence[Message]) -> None:
    assert client.wait_for_subscriber(keys.OBJECTS, 10.0)
    for message in messages:
        client.put(message)


def later(message: Message) -> Message:
    """The same ten seconds on."""
    shift_ns = at(LATER_S) - at(0.0)
    stamps = {name: getattr(message, name) + shift_ns for name in ("start_ns", "end_ns") if hasattr(message, name)}
    return message.model_copy(update=stamps | {"stamp_ns": message.stamp_ns + shift_ns})


def test_a_fusion_started_anew_does_not_answer_old_segments_again(running: System) -> None:
    """Publishers keep their last messages for those who come late: those of the last seconds, and not for ever."""
    running.start_router()
    fusion = running.start("action_fusion")
    scene = [*PUSH.postures(), *PUSH.sightings(), action("push")]
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        put_all(client, scene)
        assert [event.segment_id for event in collect(events, Event, bool)] == ["s1"]
        answered_s = time.monotonic()
        wait_until(lambda: time.monotonic() > answered_s + HISTORY_S + 0.5, "the answer is old")
        fusion.terminate()
        running.start("action_fusion")
        running.wait_for_services(client, "action_fusion")
        put_all(client, [later(m) for m in scene[:-1]] + [later(scene[-1]).model_copy(update={"segment_id": "s2"})])
        found = collect(events, Event, lambda found: any(event.segment_id == "s2" for event in found))
    assert [event.segment_id for event in found] == ["s2"]


def test_who_takes_over_does_not_answer_again_what_was_just_answered(running: System) -> None:
    running.start_router()
    fusion = running.start("action_fusion", "--instance", "one")
    with running.client() as client:
        running.wait_for_services(client, "action_fusion")
        events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        put_all(client, [*PUSH.postures(), *PUSH.sightings(), action("push")])
        assert [event.segment_id for event in collect(events, Event, bool)] == ["s1"]
        running.start("action_fusion", "--instance", "two", "--take-over")
        wait_until(lambda: fusion.process.poll() is not None, "the first has left")
        running.wait_for_services(client, "action_fusion")
        there_s = time.monotonic()
        wait_until(lambda: time.monotonic() > there_s + HISTORY_S + 0.5, "whatever it was told again is answered")
        assert events.take() is None
