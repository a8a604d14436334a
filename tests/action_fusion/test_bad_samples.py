"""Postures and objects that cannot be true are counted and survived; a missing hand is no hand."""

import math

import pytest

from actum.skeletons import INDEX
from fused import events_of
from scenes import Scene, acting_on, action, still

TOUCH = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.45))


@pytest.mark.parametrize("joint", [None, [math.nan, 0.0, 0.0], [2.0**31, 0.0, 0.0], [math.inf, -math.inf, 0.0]])
def test_a_hand_that_is_never_known_was_near_nothing(node, joint) -> None:
    def handless(posture):
        joints = list(posture.joints_m)
        joints[INDEX["right_hand"]] = joint
        return posture.model_copy(update={"joints_m": joints})

    postures = [handless(posture) for posture in TOUCH.postures()]
    (event,) = events_of(node, *postures, *TOUCH.sightings(), action("touch"))
    assert (event.object, event.distances_m, event.objects_present) == (None, {}, [1])


@pytest.mark.parametrize("far_m", [2.0**31, 1e308, -1e200])
def test_an_absurdly_far_object_is_counted_and_left_out(node, far_m) -> None:
    scene = Scene(right_hand=TOUCH.right_hand, objects={1: still((0.1, 0.0, 0.45)), 2: still((far_m, 0.0, 0.0))})
    (event,) = events_of(node, *scene.postures(), *scene.sightings(), action("touch"))
    assert event.objects_present == [1]
    assert node.counters.rejects == {"bad_object": len(scene.sightings())}


def test_two_objects_of_one_number_are_counted_and_the_last_one_is_used(node) -> None:
    elsewhere = Scene(objects={1: still((2.0, 0.0, 2.0))})
    doubled = [
        m.model_copy(update={"objects": [*far.objects, *m.objects]})
        for m, far in zip(TOUCH.sightings(), elsewhere.sightings(), strict=True)
    ]
    (event,) = events_of(node, *TOUCH.postures(), *doubled, action("touch"))
    assert event.object is not None
    assert node.counters.rejects == {"repeated_object": len(doubled)}


def test_an_actor_who_lies_down_has_no_forward(node) -> None:
    lying = acting_on((0.1, 0.0, 0.45), (0.1, 0.0, 0.65), lean=lambda _: math.pi / 2)
    (event,) = events_of(node, *lying.postures(), *lying.sightings(), action("push"))
    assert event.object is not None
    assert (event.motion, event.result, event.sentence) == (None, None, 'push object 1 "cup", 0.94')


def test_a_crowd_takes_no_more_than_so_many_streams(node) -> None:
    for agent in range(1, 200):
        events_of(node, TOUCH.posture(agent / 100, agent=agent))
    events_of(node, *TOUCH.postures(start_s=0.0), *TOUCH.sightings())
    assert len(events_of(node, action("touch"))) == 1
