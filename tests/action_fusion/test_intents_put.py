"""With each posture of a reach the fusion puts what the person is about to touch; an empty intent ends the reach."""

from dataclasses import replace
from itertools import pairwise

import pytest

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.limits import MOST_STREAMS
from actum.messages import Event, Intent, Message, Posture
from actum.node import SECOND_NS
from fused import events_of, intents_of
from scenes import FRAME_NS, REST_LEFT, Scene, acting_on, action, at, moving

REACH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.4, 0.0, 0.5)})
"""The right hand arrives at the cup after 0.8 s; the box lies on the other side."""


WITH_BOTH_HANDS = replace(REACH, left_hand=moving((0.0, REST_LEFT), (0.8, (-0.4, 0.08, 0.5))))
"""The left hand arrives at the box at the same instant."""


def stream(start_s: float = -0.5, end_s: float = 1.6, scene: Scene = REACH, **fields: object) -> list[Message]:
    """The scene's postures and objects as they are captured, the fields of postures as given."""
    postures = [posture.model_copy(update=fields) for posture in scene.postures(start_s, end_s)]
    return sorted([*postures, *scene.sightings(start_s, end_s)], key=lambda message: message.stamp_ns or 0)


def test_before_the_hand_arrives_an_intent_names_object_and_hand(node: ActionFusion) -> None:
    intents = intents_of(node, *stream(end_s=0.75))
    assert intents
    newest = intents[-1].intended[0]
    assert (newest.object_id, newest.object_name, newest.hand) == (1, "cup", "right")


def test_an_intent_has_the_stamp_and_the_origin_of_its_posture(node: ActionFusion) -> None:
    messages = stream(end_s=0.75, session_id="run-1", agent=3)
    stamps = {message.stamp_ns for message in messages if isinstance(message, Posture)}
    intents = intents_of(node, *messages)
    assert intents
    assert {intent.stamp_ns for intent in intents} <= stamps
    assert {(intent.sensor, intent.agent, intent.session_id) for intent in intents} == {("kinect0", 3, "run-1")}


def test_what_is_put_to_a_late_listener_does_not_depend_on_when_it_began_to_listen(node: ActionFusion) -> None:
    messages = [action("push", final=False), *stream()]
    demanded = intents_of(node, *messages)
    late, quiet = ActionFusion(Settings()), messages[: len(messages) // 2]
    late.is_demanded = False
    assert intents_of(late, *quiet) == []
    late.is_demanded = True
    heard = intents_of(late, *messages[len(quiet) :])
    assert heard == [intent for intent in demanded if intent.stamp_ns > (quiet[-1].stamp_ns or 0)] != []


def test_while_nobody_listens_events_are_put_as_before(node: ActionFusion) -> None:
    messages = [*stream(), action("push", 0.0, 1.5)]
    quiet = ActionFusion(Settings())
    quiet.is_demanded = False
    assert events_of(quiet, *messages) == events_of(node, *messages) != []


def test_the_likeliest_contact_comes_first_and_the_probabilities_sum_to_1_at_most(node: ActionFusion) -> None:
    intents = intents_of(node, *stream())
    assert intents
    for intent in intents:
        probabilities = [each.probability for each in intent.intended]
        assert probabilities == sorted(probabilities, reverse=True)
        assert sum(probabilities) <= 1 + 1e-9
        assert all(each.probability <= each.soon_probability <= 1 for each in intent.intended)


def test_while_each_hand_reaches_for_another_object_both_will_be_touched_and_either_may_be_next(
    node: ActionFusion,
) -> None:
    newest = intents_of(node, *stream(end_s=0.75, scene=WITH_BOTH_HANDS))[-1].intended
    assert {(each.object_name, each.hand) for each in newest} == {("cup", "right"), ("box", "left")}
    assert all(each.soon_probability > 0.8 for each in newest)
    assert all(0.3 < each.probability < 0.7 for each in newest)


def test_a_reach_ends_with_one_empty_intent_and_nothing_after_it(node: ActionFusion) -> None:
    intents = intents_of(node, *stream(end_s=6.0))
    empty = [not intent.intended for intent in intents]
    assert empty[-1]
    assert not any(earlier and later for earlier, later in pairwise(empty))
    assert intents[-1].stamp_ns < at(4.0)


@pytest.mark.parametrize("fields", [{"agent": 0}, {"valid": False, "reason": "no torso"}], ids=["agent 0", "invalid"])
def test_nobody_known_and_no_valid_posture_give_no_intent(fields: dict[str, object], node: ActionFusion) -> None:
    assert intents_of(node, *stream(**fields)) == []


def test_a_posture_that_comes_late_or_twice_gives_no_intent(node: ActionFusion) -> None:
    reach = stream(end_s=0.75)
    assert intents_of(node, *reach)
    assert intents_of(node, *(message for message in reach if isinstance(message, Posture))) == []


def test_an_intent_names_the_segment_that_goes_on_until_that_has_ended(node: ActionFusion) -> None:
    going = action("lift", 0.0, 0.3, segment_id="auto-1", final=False, completeness=0.2)
    reach = stream(end_s=0.75)
    early = [message for message in reach if (message.stamp_ns or 0) < at(0.5)]
    going_on = intents_of(node, going, *early)
    assert (going_on[-1].segment_id, going_on[-1].completeness) == ("auto-1", 0.2)
    assert going_on[-1].intended[0].action == "lift"
    ended = intents_of(node, action("lift", 0.0, 0.3, segment_id="auto-1"), *reach[len(early) :])
    assert ended
    assert {intent.segment_id for intent in ended} == {None}


def test_a_source_that_begins_anew_is_foreseen_anew(node: ActionFusion) -> None:
    first = intents_of(node, *stream(end_s=0.75, session_id="run-1"))
    again = [
        message.model_copy(update={"stamp_ns": message.stamp_ns - 90 * SECOND_NS, "session_id": "run-2"})
        for message in stream(end_s=0.75)
        if message.stamp_ns is not None
    ]
    second = intents_of(node, *again)
    assert [intent.intended for intent in second] == [intent.intended for intent in first]


def test_somebody_whose_stream_was_forgotten_and_who_comes_back_with_older_stamps_is_foreseen_anew(
    node: ActionFusion,
) -> None:
    """So many people without a usable posture come between that the stream of the first is forgotten."""
    first = intents_of(ActionFusion(Settings()), *stream(end_s=0.75))
    day_ahead = REACH.posture(1.0).model_copy(update={"stamp_ns": at(1.0) + 86_400 * SECOND_NS})
    crowd = [REACH.posture(-0.6, agent=2 + n, valid=False, reason="no torso") for n in range(MOST_STREAMS)]
    again = intents_of(node, day_ahead, *crowd, *stream(end_s=0.75))
    assert [intent.intended for intent in again] == [intent.intended for intent in first] != []


def test_the_event_of_a_foreseen_action_is_the_one_without_intents(node: ActionFusion) -> None:
    [event] = events_of(node, *stream(), action("push", 0.0, 1.5))
    assert isinstance(event, Event)
    assert event.object is not None
    assert event.object.id == 1


def test_of_two_people_each_has_intents_of_their_own(node: ActionFusion) -> None:
    """The second does as the first, half a frame later."""
    messages: list[Message] = []
    for message in stream(end_s=0.75):
        messages.append(message)
        if isinstance(message, Posture):
            second = {"agent": 2, "stamp_ns": message.stamp_ns + FRAME_NS // 2}
            messages.append(message.model_copy(update=second))
    by_agent: dict[int, list[Intent]] = {1: [], 2: []}
    for intent in intents_of(node, *messages):
        by_agent[intent.agent].append(intent)
    assert len(by_agent[1]) == len(by_agent[2]) > 0
