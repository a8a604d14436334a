"""What the page draws ahead of time: bodies half a second later, and the ways of hands and objects."""

from collections.abc import Callable
from typing import Any

import pytest

from actum.node import SECOND_NS
from dashboards import Colleague, served
from empty_messages import contact, intent
from page_scenes import maps, risen
from people import STANDING, skeleton

pytestmark = pytest.mark.browser
Open = Callable[..., Any]
HAND_M = STANDING[8].tolist()
NOW = skeleton(SECOND_NS, STANDING)
DRAWN = """async ([name, skeleton, messages]) => {
  const expected = await import("/page/live/expected.js");
  return expected[name](skeleton, new Map(messages.map((message) => [message.agent, message])));
}"""
OF_OBJECTS = """async (objects) => (await import("/page/live/expected.js")).waysOfObjects(objects)"""


@pytest.fixture
def page(open_page: Open) -> Any:
    with served(Colleague(maps)) as service:
        yield open_page(service.address)


def bodies(page: Any, **fields: Any) -> list[Any]:
    message = risen(NOW, 0.4).model_copy(update=fields)
    return page.evaluate(DRAWN, ["bodiesAhead", NOW.model_dump(), [message.model_dump()]])


def ways_of_hands(page: Any, probability: float, **fields: Any) -> list[Any]:
    coming = contact(probability / 2, soon_probability=probability)
    message = intent(SECOND_NS, coming, session_id="test").model_copy(update=fields)
    return page.evaluate(DRAWN, ["waysOfHands", NOW.model_dump(), [message.model_dump()]])


def ways_of_objects(page: Any, **fields: Any) -> list[Any]:
    thing = {"position_m": [0.1, 0.2, 1.5], "velocity_mps": [0.4, 0.0, -0.2], "seen": True, "predicted": False}
    return page.evaluate(OF_OBJECTS, [{**thing, "followed": False, **fields}])


def test_a_body_is_that_of_half_a_second_later(page: Any) -> None:
    [joints] = bodies(page)
    assert joints == risen(NOW, 0.4).ahead[0].joints_m


@pytest.mark.parametrize("fields", [{"stamp_ns": SECOND_NS // 2}, {"agent": 2}, {"session_id": "before"}])
def test_what_is_late_or_of_another_person_or_run_is_not_drawn(fields: dict[str, Any], page: Any) -> None:
    assert bodies(page, **fields) == []
    assert ways_of_hands(page, 0.9, **fields) == []


def test_a_hand_goes_to_the_place_of_a_likely_contact(page: Any) -> None:
    assert ways_of_hands(page, 0.9) == [[pytest.approx(HAND_M), [0.1, 0.2, 1.5]]]
    assert ways_of_hands(page, 0.4) != [], "one of two things that are as likely"
    assert ways_of_hands(page, 0.2) == []
    assert ways_of_hands(page, 0.9, intended=[]) == []


def test_an_object_that_moves_goes_on_at_its_speed(page: Any) -> None:
    assert ways_of_objects(page) == [[[0.1, 0.2, 1.5], pytest.approx([0.3, 0.2, 1.4])]]
    assert ways_of_objects(page, seen=False, followed=True) != []


@pytest.mark.parametrize("fields", [{"velocity_mps": None}, {"velocity_mps": [0.02, 0.0, 0.01]}, {"seen": False}])
def test_an_object_that_rests_or_whose_motion_nobody_sees_goes_nowhere(fields: dict[str, Any], page: Any) -> None:
    assert ways_of_objects(page, **fields) == []
