"""What becomes of actions, samples and intents where a stream's stamps go back: its source or its clock began anew."""

from collections.abc import Sequence

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Message
from actum.node import SECOND_NS, Tick
from actum.stamps import RESTART_AFTER
from fused import events_of, intents_of
from scenes import FRAME_NS, Scene, acting_on, action, still

PUSH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65))
WITH_BOX = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.25, 0.0, 0.5)})
STILL = Scene(objects={1: still((0.1, 0.0, 0.45))})
"""Nobody does anything."""
STEP_NS = 90 * SECOND_NS
"""How far a clock steps back: further than any segment reaches."""


STALE = 2 * (RESTART_AFTER - 1)
"""Postures and messages of objects that are dropped before it is certain that the clock has stepped back."""


def captured(scene: Scene, **bounds: float) -> list[Message]:
    """The scene's postures and objects in the order of their stamps."""
    return sorted([*scene.postures(**bounds), *scene.sightings(**bounds)], key=lambda message: message.stamp_ns)


def of_session(session_id: str, messages: Sequence[Message]) -> list[Message]:
    return [message.model_copy(update={"session_id": session_id}) for message in messages]


def stepped_back(messages: Sequence[Message]) -> list[Message]:
    """The same after a step of the clock, of which the source knows nothing."""
    return [message.model_copy(update={"stamp_ns": message.stamp_ns - STEP_NS, "seq": None}) for message in messages]


def push_stepped_back() -> Message:
    return action("push", start_s=-90.0, end_s=-88.0, segment_id="again")


def ticked(node: ActionFusion, seconds: float) -> list[Message]:
    return [each for i in range(round(10 * seconds)) for each in node.handle(Tick(i * SECOND_NS // 10))]


def test_an_action_within_whose_segment_a_source_begins_anew_is_answered_at_once(node: ActionFusion) -> None:
    events_of(node, *of_session("a", PUSH.sightings()), *of_session("a", PUSH.postures(end_s=1.7)), action("push"))
    (event,) = events_of(node, *of_session("b", [PUSH.posture(1.0)]))
    assert event.object is not None and event.object.id == 1


def test_an_action_whose_segment_begins_with_the_new_source_waits_for_its_samples(node: ActionFusion) -> None:
    """The action has overtaken them."""
    events_of(node, *of_session("a", PUSH.postures(end_s=1.7)), action("push"))
    assert events_of(node, *of_session("b", PUSH.postures(start_s=0.0))) == []
    (event,) = events_of(node, *of_session("b", PUSH.sightings(start_s=0.0)))
    assert event.object is not None and event.object.id == 1


def test_postures_of_a_new_source_that_came_before_its_first_objects_are_kept(node: ActionFusion) -> None:
    """The stamps of the objects go back a little, those of the postures do not: they ended earlier."""
    events_of(node, *of_session("a", [*PUSH.postures(end_s=-0.5), *PUSH.sightings(end_s=0.2)]))
    new = of_session("b", [*PUSH.postures(-0.3, 1.6), *PUSH.sightings(-0.3)])
    (event,) = events_of(node, *new, action("push", end_s=1.5))
    assert [event] == events_of(ActionFusion(Settings()), *new, action("push", end_s=1.5))
    assert event.object is not None and event.object.id == 1


def test_samples_of_the_source_of_before_say_nothing_of_an_action_before_the_new_one(node: ActionFusion) -> None:
    """Their stamps are those of the action and later."""
    events_of(node, *of_session("a", [*STILL.postures(-3.0, 1.7), *STILL.sightings(-3.0, 1.7)]))
    new = of_session("b", [*PUSH.postures(0.0, 1.1), *PUSH.sightings(0.0, 1.1)])
    (event,) = events_of(node, *new, action("push", end_s=1.0))
    assert [event] == events_of(ActionFusion(Settings()), *new, action("push", end_s=1.0))


def test_an_object_that_only_the_source_of_before_saw_is_not_there_though_the_stamps_are_the_same(
    node: ActionFusion,
) -> None:
    events_of(node, *of_session("a", WITH_BOX.postures()), *of_session("a", WITH_BOX.sightings()))
    (event,) = events_of(node, *of_session("b", PUSH.postures()), *of_session("b", PUSH.sightings()), action("push"))
    assert event.objects_present == [1]


def test_after_a_clock_that_steps_back_an_action_has_the_event_that_it_has_without_anything_before(
    node: ActionFusion,
) -> None:
    events_of(node, *captured(PUSH), action("push"))
    back = stepped_back(captured(PUSH))
    (event,) = events_of(node, *back, push_stepped_back())
    assert node.counters.rejects == {"stale_stamp": STALE}
    (alone,) = events_of(ActionFusion(Settings()), *back[STALE:], push_stepped_back())
    assert event == alone
    assert event.object is not None


def test_after_a_clock_that_steps_back_nobodys_postures_of_before_stand_for_those_that_are_lost(
    node: ActionFusion,
) -> None:
    others = [PUSH.posture(i * FRAME_NS / SECOND_NS, agent=2) for i in range(90)]
    events_of(node, *PUSH.postures(), *others, *PUSH.sightings())
    events_of(node, *stepped_back([*PUSH.postures(end_s=1.0), *PUSH.sightings()]), push_stepped_back())
    (event,) = ticked(node, 13.0)
    assert event.reason == "postures lost: none came for 1.0 s of the segment"


def test_after_a_clock_that_steps_back_a_reach_is_foreseen_as_without_anything_before(node: ActionFusion) -> None:
    reach = captured(PUSH, start_s=-0.5, end_s=0.75)
    intents_of(node, *reach)
    back = stepped_back(reach)
    assert intents_of(node, *back) == intents_of(ActionFusion(Settings()), *back[STALE:]) != []
