"""What each action was done to makes its objects likelier, and its own objects make an action likelier."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from action_fusion.intent.action_shares import MOST_SHARES, shares_of
from action_fusion.intent.usual_objects import KNOWN_AFTER_NS, LATE_EVENTS, MOST_EVENTS, UsualObjects
from actum.messages import ActedObject, Event
from actum.node import SECOND_NS
from events import event

CUP, BOX = 1, 2
LATER_NS = 10_000 * SECOND_NS
Habit = tuple[str, int]


def done(label: str, number: int, at_ns: int = 0, **fields: object) -> Event:
    acted = ActedObject(id=number, name=f"object {number}", distance_m=0.1)
    said = event("s1", f"{label} object {number}", action=label)
    return said.model_copy(update={"object": acted, "end_ns": at_ns} | fields)


def learnt(*habits: Habit) -> UsualObjects:
    usual = UsualObjects()
    for second, (label, number) in enumerate(habits):
        usual.append(done(label, number, second * SECOND_NS))
    return usual


def ratio(usual: UsualObjects, label: str, number: int, objects: Sequence[int] = (CUP, BOX)) -> float:
    return float(usual.ratios(LATER_NS, [label], objects)[0, objects.index(number)])


HABITS = (("drink", CUP), ("push", BOX)) * 3


def test_who_drank_from_the_cup_drinks_from_the_cup() -> None:
    usual = learnt(*HABITS)
    assert 1.2 < ratio(usual, "drink", CUP) < 2.0
    assert 0.0 < ratio(usual, "drink", BOX) < 0.8


def test_the_more_often_a_habit_was_kept_the_more_it_counts() -> None:
    rising = [ratio(learnt(*HABITS[:2] * n), "drink", CUP) for n in (1, 2, 4, 8, 16)]
    assert rising == sorted(rising)
    assert rising[-1] > 1.9


def test_of_a_person_who_does_anything_to_anything_chance_is_no_habit() -> None:
    """What happens once more often by chance would count for a lot, if it were all that happened."""
    anything = [(label, number) for label in ("drink", "push", "wave") for number in (CUP, BOX, 3)] * 4
    often = ratio(learnt(*anything, ("drink", CUP), ("drink", CUP)), "drink", CUP, objects=(CUP, BOX, 3))
    assert 1.0 < often < 1.1


@pytest.mark.parametrize("habits", [(), HABITS[:1], (("drink", CUP), ("push", CUP)) * 5], ids=["no", "one", "the same"])
def test_events_that_tell_no_difference_change_nothing(habits: Sequence[Habit]) -> None:
    assert (learnt(*habits).ratios(LATER_NS, ["drink", "push", "wave"], [CUP, BOX, 3]) == 1.0).all()


def test_an_action_and_an_object_of_which_nothing_is_known_change_nothing() -> None:
    usual = learnt(*HABITS)
    assert ratio(usual, "wave", CUP) == 1.0
    assert ratio(usual, "drink", 3, objects=(CUP, BOX, 3)) == 1.0


def test_only_objects_that_are_there_are_compared() -> None:
    assert ratio(learnt(*HABITS, ("drink", 3)), "drink", CUP) == ratio(learnt(*HABITS), "drink", CUP)
    assert ratio(learnt(*HABITS), "drink", CUP, objects=(CUP,)) == 1.0


@pytest.mark.parametrize(
    "fields",
    [
        {"valid": False, "reason": "lost"},
        {"unknown": True},
        {"candidates": [ActedObject(id=n, name=str(n), distance_m=0.1) for n in (CUP, BOX)]},
    ],
    ids=["invalid", "unknown action", "several objects"],
)
def test_a_doubtful_event_changes_nothing(fields: dict[str, object]) -> None:
    usual = learnt(("push", BOX))
    usual.append(done("drink", CUP, SECOND_NS, **fields))
    assert (usual.ratios(LATER_NS, ["drink", "push"], [CUP, BOX]) == 1.0).all()


def test_an_action_counts_a_second_after_its_end() -> None:
    usual = learnt(("push", BOX), ("drink", CUP))
    assert usual.ratios(SECOND_NS + KNOWN_AFTER_NS - 1, ["drink"], [CUP])[0, 0] == 1.0
    assert usual.ratios(SECOND_NS + KNOWN_AFTER_NS, ["drink"], [CUP, BOX])[0, 0] > 1.0


def test_what_is_no_longer_usual_is_forgotten_and_no_more_is_kept() -> None:
    usual = learnt(*HABITS, *[("drink", BOX), ("push", CUP)] * MOST_EVENTS)
    assert ratio(usual, "drink", CUP) < 0.1
    assert len(usual._events) == MOST_EVENTS + LATE_EVENTS


@given(order=st.permutations(range(len(HABITS))))
def test_the_order_in_which_events_come_does_not_matter(order: list[int]) -> None:
    usual, events = UsualObjects(), [done(*habit, k * SECOND_NS) for k, habit in enumerate(HABITS)]
    for k in order:
        usual.append(events[k])
    for at_ns in range(0, 8 * SECOND_NS, SECOND_NS // 2):
        np.testing.assert_array_equal(
            usual.ratios(at_ns, ["drink", "push"], [CUP, BOX]),
            learnt(*HABITS).ratios(at_ns, ["drink", "push"], [CUP, BOX]),
        )


def test_of_an_uncertain_action_each_object_names_the_one_that_is_usual_for_it() -> None:
    found = learnt(*HABITS).done(LATER_NS, {"drink": 0.5, "push": 0.4}, [CUP, BOX])
    assert found.actions == ["drink", "push"]
    drinking, pushing = learnt(*HABITS).ratios(LATER_NS, ["drink", "push"], [CUP, BOX])[:, 0].tolist()
    assert found.shares[0] == pytest.approx(0.5 * drinking / (0.5 * drinking + 0.4 * pushing + 0.1))
    assert found.likelier[0] > 1.0 > found.likelier[1]


@given(
    habits=st.lists(st.tuples(st.sampled_from(["drink", "push", "wave"]), st.integers(1, 4)), max_size=30),
    confidence=st.floats(0, 1),
    activations=st.lists(st.floats(-1, 1), min_size=3, max_size=3),
)
def test_whatever_was_done_shares_are_probabilities(
    habits: list[Habit], confidence: float, activations: list[float]
) -> None:
    shares = shares_of("drink", confidence, dict(zip(("drink", "push", "wave"), activations, strict=True)))
    assert sum(shares.values()) <= 1 + 1e-6
    found = learnt(*habits).done(LATER_NS, shares, [1, 2, 3])
    assert (found.likelier >= 0).all()
    assert ((found.shares >= 0) & (found.shares <= 1 + 1e-6)).all()


def test_without_activations_the_named_action_stands_alone() -> None:
    assert shares_of("drink", 0.7, {}) == {"drink": 0.7}


def test_of_a_softmax_the_shares_are_found_again() -> None:
    cosines = {"push": 0.3, "drink": 0.5, "wave": 0.1}
    total = sum(math.exp(20 * cosine) for cosine in cosines.values())
    shares = shares_of("drink", math.exp(10) / total, cosines)
    assert [*shares] == ["drink", "push", "wave"]
    assert shares["push"] == pytest.approx(math.exp(6) / total, rel=1e-6)
    assert sum(shares.values()) == pytest.approx(1.0)


def test_the_named_action_keeps_its_confidence_and_is_never_less_likely_than_another() -> None:
    shares = shares_of("drink", 0.1, {"drink": 0.5, "push": 0.5, "wave": 0.9})
    assert shares["drink"] == 0.1
    assert max(shares.values()) == 0.1


def test_of_many_actions_the_likeliest_are_kept() -> None:
    shares = shares_of("action 99", 0.2, {f"action {n}": n / 100 for n in range(100)})
    assert [*shares] == [f"action {99 - n}" for n in range(MOST_SHARES + 1)]
