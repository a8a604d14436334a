"""A hand that acts where nothing is acts on nothing, though things are near; one that touches a thing is at it."""

import pytest

from actum.messages import Event
from fused import event_in
from scenes import REST_RIGHT, Place, Scene, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
BOX: Place = (-0.1, 0.0, 0.45)


def event_after(*stops: tuple[float, Place], label: str = "act", **fields: object) -> Event:
    """The right hand goes through its stops, waiting 0.2 s at each but the last."""
    waits = [stop for time, place in stops for stop in ((time, place), (time + 0.2, place))]
    scene = Scene(
        right_hand=moving((0.0, REST_RIGHT), *waits), objects={1: still(CUP), 2: still(BOX)}, **fields  # type: ignore[arg-type]
    )  # fmt: skip
    return event_in(scene, action(label))


@pytest.mark.parametrize(
    ("taken", "left"),
    [
        ((0.25, 0.05, 0.45), (0.25, 0.2, 0.45)),
        ((0.25, 0.05, 0.45), (0.25, 0.05, 0.28)),
        ((0.25, 0.05, 0.3), (0.25, 0.05, 0.47)),
        ((0.1, 0.3, 0.45), (0.1, 0.15, 0.45)),
        ((0.1, 0.05, 0.15), (0.1, 0.05, 0.3)),
    ],
    ids=["lift", "pull", "push", "put", "push towards a thing"],
)
def test_what_is_done_beside_things_is_done_to_none(taken, left) -> None:
    event = event_after((0.7, taken), (1.5, left), label="push")
    assert (event.object, event.outcome, event.why) == (None, None, "no object within reach was acted on")


def test_a_hand_that_stays_where_it_reached_to_is_at_the_thing() -> None:
    event = event_after((0.9, (0.1, 0.08, 0.36)))
    assert event.object is not None and (event.object.id, event.outcome) == (1, "unmoved")


def test_a_hand_that_touched_a_thing_and_went_back_was_at_the_thing() -> None:
    event = event_after((0.8, (0.1, 0.08, 0.36)), (1.6, REST_RIGHT))
    assert event.object is not None and event.object.id == 1


def test_a_hand_that_hesitated_on_its_way_is_at_the_thing() -> None:
    event = event_after((0.7, (0.15, 0.1, 0.29)), (1.2, (0.1, 0.08, 0.36)))
    assert event.object is not None and event.object.id == 1


def test_of_two_things_touched_the_last_counts() -> None:
    event = event_after((0.6, (0.1, 0.06, 0.38)), (1.0, (0.0, 0.2, 0.3)), (1.5, (-0.1, 0.06, 0.38)))
    assert event.object is not None and event.object.id == 2


def test_a_hand_that_rests_beyond_a_grasp_has_not_reached() -> None:
    event = event_after((0.9, (0.1, 0.1, 0.26)))
    assert (event.object, event.why) == (None, "no object within reach was acted on")
