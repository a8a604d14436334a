"""What an intent says: nothing of what comes later, the same whatever came first, and calibrated from the start."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from action_fusion.intake.stream_samples import ObjectsSample
from action_fusion.intent.approach import FEATURES, approach
from action_fusion.intent.contact_network import ContactNetwork, shipped_network
from action_fusion.intent.intents import ACTIONS_LATE_NS, touched_given, touched_next, touched_place, touched_soon
from action_fusion.intent.recent_beginnings import MOST_BEGINNINGS
from action_fusion.intent.recent_paths import ARMS, OBJECTS_LATE_NS, RecentArms, RecentObjects
from action_fusion.intent.usual_objects import Done
from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Action, Intended, Intent, Message, Objects
from actum.node import SECOND_NS
from fused import intents_of
from scenes import FRAME_NS, REST_RIGHT, Scene, acting_on, action, moving, still

REACH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), others={2: (-0.4, 0.0, 0.5)})


TO_THE_BOX = replace(
    REACH,
    right_hand=moving((0.0, REST_RIGHT), (0.8, (-0.4, 0.08, 0.5)), (1.6, (-0.4, 0.08, 0.7))),
    objects={1: still((0.1, 0.0, 0.45)), 2: moving((0.8, (-0.4, 0.0, 0.5)), (1.6, (-0.4, 0.0, 0.7)))},
)


def stream(end_s: float = 1.2, scene: Scene = REACH) -> list[Message]:
    messages = [*scene.postures(-0.5, end_s), *scene.sightings(-0.5, end_s)]
    return sorted(messages, key=lambda message: message.stamp_ns or 0)


def day(gap_s: float = 30.0) -> list[Message]:
    """The cup is lifted, the box pushed; then the hand reaches for the cup, and both actions are equally likely."""
    acts: list[list[Message]] = [
        [*stream(1.7), action("lift", 0.0, 1.5, segment_id="first")],
        [*stream(1.7, TO_THE_BOX), action("push", 0.0, 1.5, segment_id="second")],
        [*stream(0.75), *(partial(s, confidence=0.5, activations={"lift": 0.3, "push": 0.3}) for s in (0.2, 0.3, 0.4))],
    ]
    shifted = [shift(message, number * gap_s) for number, act in enumerate(acts) for message in act]
    return sorted(shifted, key=lambda message: message.stamp_ns or 0)


@cache
def intents_of_day(gap_s: float) -> list[Intent]:
    return intents_of(ActionFusion(Settings()), *day(gap_s))


def shift(message: Message, seconds: float) -> Message:
    stamps = [name for name in ("stamp_ns", "start_ns", "end_ns") if getattr(message, name, None) is not None]
    return message.model_copy(update={name: getattr(message, name) + round(seconds * SECOND_NS) for name in stamps})


def straight(arms: RecentArms, towards: np.ndarray, speed_mps: float, seconds: float = 0.9) -> int:
    """Move both hands straight from the origin, elbows and shoulders still; return the last stamp (ns)."""
    stamp_ns = 0
    for frame in range(round(seconds * 30) + 1):
        stamp_ns = frame * FRAME_NS
        joints_m = np.zeros((len(ARMS), 3))
        joints_m[:2] = towards * speed_mps * stamp_ns / SECOND_NS
        arms.append(stamp_ns, joints_m)
    return stamp_ns


def seen(stamp_ns: int, **places: tuple[float, float, float]) -> ObjectsSample:
    numbered = {number: np.array(place) for number, place in enumerate(places.values(), start=1)}
    return ObjectsSample(stamp_ns, "", numbered, dict(zip(numbered, places, strict=True)), frozenset(), {})


def test_a_straight_way_leads_towards_its_goal_and_not_aside() -> None:
    arms, objects = RecentArms(), RecentObjects()
    objects.append(seen(0, ahead=(0.0, 0.0, 2.0), aside=(2.0, 0.0, 0.0)))
    at_ns = straight(arms, np.array([0.0, 0.0, 1.0]), speed_mps=0.5)
    found = approach(arms, objects, at_ns)
    assert found.names == {1: "ahead", 2: "aside"}
    assert found.features.shape == (2, 2, FEATURES)
    way_m = 0.5 * 0.8
    np.testing.assert_allclose(
        found.features[0, :, 0], np.linalg.norm([[0, 0, 1.55], [2, 0, -0.45]], axis=1), atol=0.01
    )
    assert found.features[0, 0, 5] == pytest.approx(way_m, abs=0.02)
    assert found.features[0, 0, 9] == pytest.approx(0.0, abs=1e-6)
    assert found.features[0, 1, 9] > 0.9 * way_m


def test_an_object_counts_where_it_was_a_tenth_of_a_second_ago() -> None:
    objects = RecentObjects()
    objects.append(seen(0, cup=(0.0, 0.0, 1.0)))
    objects.append(seen(SECOND_NS, cup=(0.0, 0.0, 2.0)))
    for stamp_ns, place_m in ((SECOND_NS + OBJECTS_LATE_NS - 1, 1.0), (SECOND_NS + OBJECTS_LATE_NS, 2.0)):
        assert objects.at(stamp_ns, 0)[1][0, 0, 2] == place_m
    assert objects.at(OBJECTS_LATE_NS - 1, 0)[0] == {}


def test_what_was_not_seen_for_ten_seconds_is_nowhere() -> None:
    objects = RecentObjects()
    objects.append(seen(0, cup=(0.0, 0.0, 1.0)))
    assert objects.at(10 * SECOND_NS, 0)[0] == {1: "cup"}
    assert objects.at(10 * SECOND_NS + 1, 0)[0] == {}


@given(cut=st.integers(2, 400))
@settings(max_examples=20, deadline=None)
def test_an_intent_depends_on_nothing_later(cut: int) -> None:
    part = intents_of(ActionFusion(Settings()), *day(gap_s=30.0)[:cut])
    assert part == intents_of_day(gap_s=30.0)[: len(part)]


@given(objects_late_ns=st.integers(0, OBJECTS_LATE_NS - 1), action_late_ns=st.integers(0, ACTIONS_LATE_NS - 1))
@settings(max_examples=20, deadline=None)
def test_objects_and_actions_that_come_up_to_a_tenth_of_a_second_late_change_no_intent(
    objects_late_ns: int, action_late_ns: int
) -> None:
    late_ns = {Objects: objects_late_ns, Action: action_late_ns}
    arriving = sorted(day(gap_s=2.2), key=lambda message: (message.stamp_ns or 0) + late_ns.get(type(message), 0))
    said = intents_of_day(gap_s=2.2)
    assert any(each.segment_id for each in said)
    assert intents_of(ActionFusion(Settings()), *arriving) == said


@given(
    features=st.lists(st.floats(-1e3, 1e3), min_size=2 * 3 * FEATURES, max_size=2 * 3 * FEATURES),
    begun=st.floats(0, MOST_BEGINNINGS),
)
@settings(max_examples=50, deadline=None)
def test_of_each_hand_the_probabilities_sum_to_1_at_most_whatever_is_seen(features: list[float], begun: float) -> None:
    foreseen = shipped_network().foresee(np.array(features).reshape(2, 3, FEATURES), begun)
    assert (foreseen.probability >= 0).all()
    assert (foreseen.probability.sum(axis=1) <= 1 + 1e-9).all()
    assert (foreseen.contact_s > 0).all()


def test_a_hand_that_is_not_known_touches_nothing() -> None:
    features = np.zeros((2, 2, FEATURES))
    features[1] = np.nan
    foreseen = shipped_network().foresee(features, 0.0)
    assert (foreseen.probability[1] == 0).all()


def test_without_objects_nothing_is_foreseen() -> None:
    assert shipped_network().foresee(np.zeros((2, 0, FEATURES)), 0.0).probability.shape == (2, 0)


def test_the_order_of_the_objects_does_not_matter() -> None:
    rng = np.random.default_rng(0)
    network: ContactNetwork = shipped_network()
    features = network.mean + network.sd * rng.normal(size=(2, 4, FEATURES))
    turned = network.foresee(features[:, ::-1], 1.0)
    np.testing.assert_allclose(turned.probability[:, ::-1], network.foresee(features, 1.0).probability, rtol=1e-12)


def test_a_hand_touches_a_thing_at_its_own_side_and_stays_where_it_is_once_there() -> None:
    np.testing.assert_allclose(touched_place(np.array([0.0, 0.0, 1.0]), np.zeros(3)), [0.0, 0.0, 0.12])
    np.testing.assert_allclose(touched_place(np.array([0.0, 0.0, 0.1]), np.zeros(3)), [0.0, 0.0, 0.1])


def test_what_both_hands_are_about_to_touch_is_likelier_than_by_either_and_two_things_share_the_next_touch() -> None:
    np.testing.assert_allclose(touched_soon(np.array([[0.8, 0.0], [0.5, 0.0]])), [0.9, 0.0])
    different = touched_soon(np.array([[0.9, 0.0], [0.0, 0.9]]))
    np.testing.assert_allclose(different, [0.9, 0.9])
    np.testing.assert_allclose(touched_next(different), [0.5, 0.5])


def newest(*also: Message) -> Intended:
    """Return the likeliest contact just before the hand arrives."""
    return intents_of(ActionFusion(Settings()), *also, *stream(0.75))[-1].intended[0]


def partial(end_s: float = 0.4, **fields: object) -> Message:
    return action("lift", 0.0, end_s, final=False, **fields)


def test_the_action_that_goes_on_has_its_confidence_as_its_share_of_the_contact() -> None:
    alone, doing = newest(), newest(partial(confidence=0.5))
    assert (alone.action, alone.action_probability) == (None, None)
    assert (doing.action, doing.action_probability) == ("lift", pytest.approx(0.5 * doing.probability))
    assert doing.probability == alone.probability


def without_events(messages: list[Message]) -> list[Message]:
    return [message for message in messages if not (isinstance(message, Action) and message.final)]


def test_somebody_who_lifted_the_cup_and_pushed_the_box_is_likelier_to_lift_the_cup_again() -> None:
    usual, anew = (
        intents_of(ActionFusion(Settings()), *acts)[-1].intended[0] for acts in (day(), without_events(day()))
    )
    assert (usual.object_name, usual.action) == (anew.object_name, anew.action) == ("cup", "lift")
    assert anew.action_probability == pytest.approx(0.5 * anew.probability)
    assert 0.55 * usual.probability < (usual.action_probability or 0.0) < 0.75 * usual.probability
    assert usual.probability >= anew.probability


def test_what_is_done_makes_one_object_likelier_than_another_and_a_contact_no_likelier() -> None:
    alone = np.array([0.3, 0.4, 0.0])
    given_lift = touched_given(Done(np.array([2.0, 0.5, 1.0]), ["lift"] * 3, np.ones(3)), alone)
    np.testing.assert_allclose(given_lift, [0.3 * 2 * 0.7 / 0.8, 0.4 * 0.5 * 0.7 / 0.8, 0.0])
    for nothing in (None, Done(np.ones(3), ["lift"] * 3, np.ones(3))):
        np.testing.assert_array_equal(touched_given(nothing, alone), alone)


def test_after_a_restart_of_the_sensor_nobody_has_habits() -> None:
    node = ActionFusion(Settings())
    intents_of(node, *day())
    again = [
        shift(message, -90.0).model_copy(update={"session_id": "run-2"})
        for message in day()
        if (message.stamp_ns or 0) > REACH.posture(50.0).stamp_ns
    ]
    assert intents_of(node, *again)[-1].intended == intents_of(ActionFusion(Settings()), *again)[-1].intended


@pytest.mark.parametrize(("confidence", "share"), [(2.0, 1.0), (-1.0, 0.0)])
def test_a_confidence_that_is_no_probability_counts_as_the_nearest_one(confidence: float, share: float) -> None:
    doing = newest(partial(confidence=confidence))
    assert doing.action_probability == pytest.approx(share * doing.probability)


def test_absurd_activities_of_actions_hide_no_contact() -> None:
    doing = newest(partial(confidence=0.5, activations={"lift": 1e308, "put": -1e308}))
    assert doing == newest(partial(confidence=0.5))


def test_an_action_that_is_marked_as_the_other_hands_is_not_this_ones() -> None:
    assert newest(partial(hand="right")).action == "lift"
    assert newest(partial(hand="left")).action is None


def test_what_an_earlier_session_saw_is_not_there() -> None:
    objects = RecentObjects()
    objects.append(seen(0, cup=(0.0, 0.0, 1.0)))
    objects.append(ObjectsSample(SECOND_NS, "anew", {2: np.ones(3)}, {2: "box"}, frozenset(), {}))
    assert objects.at(2 * SECOND_NS, 0)[0] == {2: "box"}


def test_a_hand_in_the_middle_of_a_thing_is_measured_all_the_same() -> None:
    arms, objects = RecentArms(), RecentObjects()
    objects.append(seen(0, here=(0.0, 0.0, 0.0)))
    arms.append(SECOND_NS, np.zeros((len(ARMS), 3)))
    assert np.isfinite(approach(arms, objects, SECOND_NS).features).all()


def test_a_person_does_not_act_much_more_often_among_many_objects() -> None:
    """All objects are approached alike; if each counted for itself, odds would be four times as high among eight."""
    network, alike = shipped_network(), shipped_network().mean
    few, many = (network.foresee(np.tile(alike, (2, n, 1)), 2.0).probability.sum(axis=1) for n in (2, 8))
    assert (many / (1 - many) < 2.5 * few / (1 - few)).all()
