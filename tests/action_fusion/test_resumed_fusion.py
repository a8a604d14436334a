"""What the fusion answers where it, or the tracker, was not there all the time."""

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Event
from actum.node import SECOND_NS, Tick
from fused import events_of
from scenes import acting_on, action, at, rejected_action

PUSH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))


def resumed(*before: Event) -> ActionFusion:
    """A fusion that is started in the place of one that put these events."""
    node = ActionFusion(Settings())
    node.remember(before)
    return node


def ticked(node: ActionFusion, from_s: float, to_s: float) -> list[Event]:
    ticks = range(round(10 * from_s), round(10 * to_s))
    return [event for i in ticks for event in node.handle(Tick(i * SECOND_NS // 10)) if isinstance(event, Event)]


def test_an_action_that_has_its_event_gets_no_other(node: ActionFusion) -> None:
    told = [action("push"), rejected_action("no person", segment_id="s2"), action("lift", end_s=None, segment_id="s3")]
    before = events_of(node, *PUSH.postures(), *PUSH.sightings(), *told)
    assert len(before) == 3
    node = resumed(*before)
    assert events_of(node, *told, *PUSH.postures(), *PUSH.sightings(), *told) == []
    assert node.counters.counts["actions_told_again"] == 6
    assert not node.counters.rejects


def test_the_same_segment_of_another_session_gets_its_event(node: ActionFusion) -> None:
    first = action("push", session_id="first")
    before = events_of(node, *PUSH.postures(), *PUSH.sightings(), first)
    second = first.model_copy(update={"session_id": "second"})
    assert len(events_of(resumed(*before), *PUSH.postures(), *PUSH.sightings(), second)) == 1


def test_after_a_restart_the_postures_of_before_are_missed() -> None:
    node = resumed()
    (event,) = events_of(node, *PUSH.postures(1.0), *PUSH.sightings(-1.0), action("push"))
    assert event.reason == "the fusion started late: its first posture is 1.0 s after the segment's start"
    assert event.sentence == f"no event of push: {event.reason}"
    assert node.counters.rejects == {"incomplete_segment": 1}


def test_after_a_restart_it_waits_for_streams_that_were_there_before(node: ActionFusion) -> None:
    before = events_of(node, *PUSH.postures(), *PUSH.sightings(), action("push"))
    node = resumed(*before)
    events_of(node, action("push", segment_id="s2"))
    assert ticked(node, 0.0, 9.0) == []
    (event,) = events_of(node, *PUSH.postures(), *PUSH.sightings())
    assert event.object is not None


def test_after_a_restart_without_any_posture_it_says_so() -> None:
    node = resumed()
    events_of(node, *PUSH.sightings(), action("push"))
    (event,) = ticked(node, 0.0, 13.0)
    assert event.reason == "the fusion started late: it has received no posture since its start"


def test_after_a_restart_without_the_objects_that_there_were_it_says_so(node: ActionFusion) -> None:
    before = events_of(node, *PUSH.postures(), *PUSH.sightings(), action("push"))
    node = resumed(*before)
    events_of(node, *PUSH.postures(), action("push", segment_id="s2"))
    (event,) = ticked(node, 0.0, 13.0)
    assert event.reason == "the fusion started late: it has received no objects since its start"


def test_after_a_restart_where_there_never_were_objects_none_are_missed() -> None:
    node = resumed()
    events_of(node, *PUSH.postures(), action("push"))
    (event,) = ticked(node, 0.0, 13.0)
    assert (event.valid, event.why) == (True, "no object in sight")


def test_objects_that_a_killed_tracker_never_put_make_it_a_rejection(node: ActionFusion) -> None:
    seen = [m for m in PUSH.sightings() if not at(0.5) < m.stamp_ns < at(1.5)]
    (event,) = events_of(node, *PUSH.postures(), *seen, action("push"))
    assert event.reason == "objects lost: none came for 1.0 s of the segment"


def test_a_segment_in_which_no_object_is_in_view_is_none_of_it(node: ActionFusion) -> None:
    empty = [m.model_copy(update={"objects": []}) for m in PUSH.sightings()]
    (event,) = events_of(node, *PUSH.postures(), *empty, action("push"))
    assert (event.valid, event.why) == (True, "no object in sight")


def test_a_slow_tracker_is_not_a_lost_one(node: ActionFusion) -> None:
    (event,) = events_of(node, *PUSH.postures(), *PUSH.sightings()[::20], action("push"))
    assert event.object is not None


def test_objects_that_stand_still_are_waited_for_and_read_when_they_come(node: ActionFusion) -> None:
    events_of(node, *PUSH.postures(), *PUSH.sightings(end_s=1.0), action("push"))
    assert ticked(node, 0.0, 8.0) == []
    late = [m for m in PUSH.sightings() if m.stamp_ns > at(1.0)]
    (event,) = events_of(node, *late)
    assert event.result == "0.20 m away"


def test_the_fusion_is_busy_while_an_action_goes_on_or_waits(node: ActionFusion) -> None:
    """Then no other process takes its place: it would lack the samples of before."""
    ticked(node, 0.0, 1.0)
    assert not node.is_busy
    list(node.handle(action("push", final=False)))
    assert node.is_busy
    ticked(node, 1.0, 4.0)
    assert not node.is_busy, "nothing more was said of it"
    list(node.handle(action("push", final=False)))
    list(node.handle(action("push")))
    assert node.is_busy, "it waits for its samples"
    events_of(node, *PUSH.postures(), *PUSH.sightings())
    assert not node.is_busy
