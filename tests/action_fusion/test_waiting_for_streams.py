"""When an event comes, and that the order in which its parts came does not matter."""

from collections.abc import Sequence

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Event, Message
from actum.node import SECOND_NS, Tick, replay
from fused import events_of
from scenes import START_NS, Scene, acting_on, action, at, rejected_action

PUSH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.25, 0.0, 0.5), 3: (0.45, 0.0, 0.5)})
SKEW_NS = 2 * SECOND_NS


def ticked(node: ActionFusion, seconds: float, since_s: float = 0.0) -> list[Event]:
    """Let time go by in ticks of a tenth of a second."""
    ticks = range(round(10 * since_s), round(10 * (since_s + seconds)) + 1)
    return [event for i in ticks for event in node.handle(Tick(i * SECOND_NS // 10)) if isinstance(event, Event)]


def without_seq(events: Sequence[Message]) -> list[dict[str, object]]:
    return [event.model_dump(exclude={"seq"}) for event in events]


def delayed(messages: Sequence[Message], delays_ns: Sequence[int]) -> list[tuple[int, Message]]:
    """Let a key's messages arrive late by a cycle of delays, in their order."""
    arrivals = []
    last_ns = 0
    for i, message in enumerate(messages):
        last_ns = max(last_ns, message.stamp_ns + delays_ns[i % len(delays_ns)])
        arrivals.append((last_ns, message))
    return arrivals


delays = st.lists(st.integers(0, SKEW_NS), min_size=1, max_size=7)

# Two overlapping segments and a rejected one; the objects go on moving after the ends.
LIFT = acting_on((0.1, 0.0, 0.45), (0.1, 0.3, 0.65), others={2: (-0.25, 0.0, 0.5)})
POSTURES, SIGHTINGS = LIFT.postures(-0.5, 2.0), LIFT.sightings(-0.5, 2.0)
SEGMENTS = [
    action("push", 0.0, 1.3),
    action("lift", 0.5, 1.5, segment_id="s2"),
    rejected_action("too few frames", segment_id="s3", end_s=1.6),
]


def events_after(arrivals: list[tuple[int, Message]]) -> list[dict[str, object]]:
    arrivals.sort(key=lambda arrival: arrival[0])
    put = replay(ActionFusion(Settings()), arrivals, settle_ns=5 * SECOND_NS)
    events = without_seq([each for each in put if isinstance(each, Event)])
    return sorted(events, key=lambda event: str(event["segment_id"]))


ON_TIME = events_after([*delayed(POSTURES, [0]), *delayed(SIGHTINGS, [0]), *delayed(SEGMENTS, [0])])


def test_on_time_each_segment_has_its_event() -> None:
    assert [event["segment_id"] for event in ON_TIME] == ["s1", "s2", "s3"]
    assert [event["valid"] for event in ON_TIME] == [True, True, False]
    assert ON_TIME[0]["result"] != ON_TIME[1]["result"]


@settings(max_examples=15)
@given(delays, delays, delays)
@example([0], [SKEW_NS], [0])
@example([SKEW_NS], [0], [0])
@example([0], [0], [SKEW_NS])
def test_skew_between_keys_of_up_to_two_seconds_changes_nothing(postures_ns, objects_ns, actions_ns) -> None:
    skewed = [*delayed(POSTURES, postures_ns), *delayed(SIGHTINGS, objects_ns), *delayed(SEGMENTS, actions_ns)]
    assert events_after(skewed) == ON_TIME


@settings(max_examples=8)
@given(delays, delays, delays)
@example([0], [SKEW_NS], [0])
@example([SKEW_NS], [0], [0])
@example([SKEW_NS], [SKEW_NS], [0])
def test_nor_does_it_after_time_has_gone_back(postures_ns, objects_ns, actions_ns) -> None:
    """As where a recording is played once more: the streams of the time before are further than any of this one."""
    skewed = [*delayed(POSTURES, postures_ns), *delayed(SIGHTINGS, objects_ns), *delayed(SEGMENTS, actions_ns)]
    before = [
        (
            message.stamp_ns - 300 * SECOND_NS,
            message.model_copy(update={"stamp_ns": message.stamp_ns + 500 * SECOND_NS}),
        )
        for message in [*POSTURES, *SIGHTINGS]
    ]
    before = [(arrival_ns, message.model_copy(update={"session_id": "before"})) for arrival_ns, message in before]
    assert events_after([*before, *skewed]) == ON_TIME


def test_it_answers_as_soon_as_both_streams_have_reached_the_end(node) -> None:
    assert events_of(node, *PUSH.postures(end_s=2.5), action("push"), *PUSH.sightings(end_s=1.95)) == []
    (event,) = events_of(node, PUSH.objects_seen(2.0))
    assert event.result == "0.20 m away"


def test_it_answers_at_once_where_the_streams_are_already_past_the_end(node) -> None:
    assert events_of(node, *PUSH.postures(), *PUSH.sightings()) == []
    assert len(events_of(node, action("push"))) == 1


def test_it_waits_for_the_postures_of_its_own_agent(node) -> None:
    events_of(node, *PUSH.sightings(), action("push"), *PUSH.postures(end_s=1.5))
    assert events_of(node, PUSH.posture(2.5, agent=2)) == []
    assert len(events_of(node, PUSH.posture(2.5))) == 1


def test_invalid_messages_only_tell_that_time_went_on(node) -> None:
    events_of(node, *PUSH.postures(end_s=1.9), *PUSH.sightings(end_s=1.9), action("push"))
    blind = PUSH.objects_seen(2.1, valid=False, reason="undecodable_image")
    lost = PUSH.posture(2.1, valid=False, joints_m=None, joints=None, ego_from_camera=None, motion=None)
    assert events_of(node, blind) == []
    (event,) = events_of(node, lost)
    assert event.result == "0.20 m away"
    assert not node.counters.rejects


def test_an_objects_stream_that_never_comes_is_waited_for_no_longer_than_it_may_lag(node) -> None:
    events_of(node, *PUSH.postures(), action("high arm wave"))
    assert ticked(node, 2.1) == []
    (event,) = ticked(node, 0.1, since_s=2.2)
    assert (event.object, event.distances_m, event.sentence) == (None, {}, "high arm wave, 0.94")


def test_waiting_starts_at_the_first_tick_after_the_action(node) -> None:
    ticked(node, 60.0)
    events_of(node, *PUSH.postures(), action("push"))
    assert ticked(node, 2.1, since_s=60.1) == []
    assert len(ticked(node, 0.2, since_s=62.3)) == 1


def test_without_any_posture_there_is_an_event_without_an_object(node) -> None:
    events_of(node, *PUSH.sightings(), action("push"))
    (event,) = ticked(node, 3.0)
    assert (event.object, event.distances_m, event.objects_present) == (None, {}, [1, 2, 3])


def test_what_comes_after_the_answer_changes_nothing_and_is_counted_late(node) -> None:
    events_of(node, *PUSH.postures(), *PUSH.sightings(end_s=1.0), action("push"))
    assert len(ticked(node, 11.0)) == 1
    assert events_of(node, PUSH.objects_seen(1.5), PUSH.objects_seen(1.6), PUSH.objects_seen(2.1)) == []
    assert node.counters.rejects == {"late": 2, "incomplete_segment": 1}


def test_frames_after_the_end_do_not_count() -> None:
    def heard(objects_after: Scene) -> list[dict[str, object]]:
        node = ActionFusion(Settings())
        before = [m for m in PUSH.sightings() if m.stamp_ns <= at(1.2)]
        after = [m for m in objects_after.sightings() if m.stamp_ns > at(1.2)]
        return without_seq(events_of(node, *PUSH.postures(), *before, *after, action("push", end_s=1.2)))

    elsewhere = acting_on((0.9, 0.9, 0.9), (0.9, 0.9, 0.9))
    assert heard(PUSH) == heard(elsewhere)


def test_a_rejection_is_passed_on_at_once_with_its_reason(node) -> None:
    (event,) = events_of(node, rejected_action("no person"))
    assert (event.valid, event.reason, event.object, event.action) == (False, "no person", None, None)
    assert event.sentence == "no recognition: no person"


def test_a_rejection_without_an_end_ends_where_it_started(node) -> None:
    (event,) = events_of(node, rejected_action("start without end", end_s=None))
    assert (event.start_ns, event.end_ns) == (START_NS, START_NS)


@pytest.mark.parametrize("broken", [action(None), action("push", end_s=None), action("push", end_s=-1.0)])
def test_a_recognition_without_label_or_end_is_answered_as_a_rejection(node, broken) -> None:
    (event,) = events_of(node, broken)
    assert not event.valid
    assert node.counters.rejects == {"bad_action": 1}


def test_a_segment_is_answered_once(node) -> None:
    events_of(node, *PUSH.postures(), *PUSH.sightings())
    assert len(events_of(node, action("push"), action("push"))) == 1
    assert node.counters.rejects == {"duplicate_segment": 1}


def test_a_segment_that_still_waits_is_not_taken_twice(node) -> None:
    assert events_of(node, action("push"), action("push")) == []
    assert len(ticked(node, 3.0)) == 1


def test_an_id_used_again_is_answered_with_its_rejection(node) -> None:
    events_of(node, *PUSH.postures(), *PUSH.sightings(), action("push"))
    (event,) = events_of(node, rejected_action("segment_id reused", start_s=5.0, end_s=5.0))
    assert (event.segment_id, event.reason) == ("s1", "segment_id reused")


def test_time_that_goes_back_answers_what_waits_and_forgets_the_past(node) -> None:
    events_of(node, *PUSH.postures(end_s=1.7), *PUSH.sightings(), action("push"))
    (event,) = events_of(node, PUSH.posture(-90.0, session_id="new"))
    assert event.object is not None and event.object.id == 1
    events_of(node, PUSH.posture(3.0, session_id="new"), PUSH.objects_seen(3.0, session_id="new"))
    (again,) = events_of(node, action("push"))
    assert (again.object, again.distances_m) == (None, {})


def test_time_may_go_back_without_a_new_session(node) -> None:
    events_of(node, *PUSH.postures(), *PUSH.sightings())
    events_of(node, *[PUSH.posture(t) for t in (-90.0, -89.0, -88.0, 3.0)])
    assert events_of(node, action("push")) == []  # the objects' old time says nothing of the new one
    (event,) = ticked(node, 13.0)
    assert (event.object, event.distances_m) == (None, {})


def test_a_new_session_with_later_stamps_loses_nothing_and_lends_it_nothing(node) -> None:
    """Objects last seen in another session are not those of this one."""
    events_of(node, *[m.model_copy(update={"session_id": "a"}) for m in PUSH.sightings(end_s=-0.1)])
    events_of(node, *[m.model_copy(update={"session_id": "b", "objects": m.objects[:1]}) for m in PUSH.sightings(0.0)])
    (event,) = events_of(node, *PUSH.postures(), action("push"))
    assert event.objects_present == [1]


def test_the_longest_segment_is_still_held_when_its_action_comes_late(node) -> None:
    events_of(node, *[PUSH.posture(t) for t in range(-1, 65)])
    events_of(node, *[PUSH.objects_seen(t) for t in range(-1, 65)])
    (event,) = events_of(node, action("push", end_s=60.0))
    assert event.result == "0.20 m away"


def test_streams_may_wait_until_an_action_waits_for_them(node: ActionFusion) -> None:
    """The runtime then reads them several messages at a time, but at once while somebody listens to intents."""
    assert not node.has_time
    node.is_demanded = False
    assert node.has_time
    assert list(node.handle(SEGMENTS[0])) == []
    assert not node.has_time
    assert events_of(node, *POSTURES, *SIGHTINGS)
    assert node.has_time
