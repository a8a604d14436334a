"""The outcome comes from the object's own track, or from the hand that occludes it; it may contradict the action."""

from dataclasses import replace

import numpy as np
import pytest

import fused
from action_fusion.outcome.displacement import outcome
from actum.messages import Event
from scenes import Place, Scene, Stance, acting_on, action, moving, still

CUP: Place = (0.1, 0.0, 0.45)
OTHERS = {2: (-0.25, 0.0, 0.5), 3: (0.45, 0.0, 0.5)}


def event_of(scene: Scene, label: str, frame: str = "egocentric", **chosen: object) -> Event:
    postures = [posture.model_copy(update={"frame": frame}) for posture in scene.postures()]
    return fused.event_of(*postures, *scene.sightings(), action(label), **chosen)


@pytest.mark.parametrize(
    ("label", "then", "expected", "direction", "agrees"),
    [
        ("lift", (0.1, 0.18, 0.45), "lifted", "up", True),
        ("lift", (0.3, 0.1, 0.45), "lifted", "right", True),
        ("put", (0.1, -0.12, 0.45), "put down", "down", True),
        ("push", (0.1, 0.0, 0.66), "pushed", "away", True),
        ("push", (0.1, 0.0, 0.27), "pulled", "towards", False),
        ("pull", (0.1, 0.0, 0.27), "pulled", "towards", True),
        ("sweep", (0.35, 0.0, 0.45), "moved", "right", None),
        ("push", (0.35, 0.0, 0.45), "moved", "right", None),
        ("lift", (0.35, 0.0, 0.45), "moved", "right", False),
        ("push", CUP, "unmoved", None, False),
        ("touch", CUP, "unmoved", None, None),
    ],
)
def test_what_was_done_and_whether_it_is_what_the_action_is_to_do(label, then, expected, direction, agrees) -> None:
    event = event_of(acting_on(CUP, then, others=OTHERS), label)
    assert event.motion is not None
    assert (event.outcome, event.motion.direction, event.agrees) == (expected, direction, agrees)


def test_an_empty_reach_has_no_outcome_and_says_why() -> None:
    scene = Scene(right_hand=acting_on(CUP, CUP).right_hand, objects={1: still((0.0, 0.0, 2.0))})
    event = event_of(scene, "push")
    assert (event.object, event.outcome, event.agrees, event.why) == (None, None, None, "no object within reach")


@pytest.mark.parametrize(("displacement", "expected"), [((0.0, 0.04, 0.2), "pushed"), ((0.0, 0.06, 0.2), "lifted")])
def test_a_table_may_slope_a_little_in_the_cameras_eyes(displacement, expected) -> None:
    assert outcome(np.array(displacement), 0.03, has_front=True) == expected


def test_without_a_body_away_and_towards_mean_nothing() -> None:
    event = event_of(acting_on(CUP, (0.1, 0.0, 0.66)), "push", frame="world")
    assert (event.outcome, event.result, event.agrees) == ("moved", "0.21 m sideways", None)
    lifted = event_of(acting_on(CUP, (0.1, 0.2, 0.45)), "lift", frame="world")
    assert (lifted.outcome, lifted.result) == ("lifted", "0.20 m up")


@pytest.mark.parametrize("until_s", [9.0, 1.9])
@pytest.mark.parametrize("then", [(0.1, 0.18, 0.45), (0.1, 0.0, 0.66)])
def test_an_occluded_object_goes_with_the_hand_until_it_is_seen_again(then, until_s) -> None:
    covered = acting_on(CUP, then, others=OTHERS, hidden=lambda number, t: number == 1 and 0.75 < t < until_s)
    event = event_of(covered, "move")
    assert event.object is not None and event.motion is not None
    assert (event.object.id, event.object.carried) == (1, True)
    assert np.allclose(event.motion.displacement_m, np.subtract(then, CUP), atol=0.02)


def test_an_object_occluded_by_a_hand_that_moves_another_stays() -> None:
    covered = acting_on(
        CUP, (0.1, 0.0, 0.66), others={2: (0.2, 0.0, 0.45)}, hidden=lambda number, t: number == 2 and t > 0.7
    )
    event = event_of(covered, "push")
    assert event.object is not None
    assert (event.object.id, event.object.carried, event.outcome) == (1, False, "pushed")


def test_an_object_that_is_seen_again_where_it_was_has_stayed() -> None:
    touched = Scene(
        right_hand=moving((0.5, (0.2, 0.1, 0.2)), (1.0, (0.1, 0.08, 0.45)), (1.6, (0.2, 0.1, 0.2))),
        objects={1: still(CUP)},
        hidden=lambda _, t: 0.8 < t < 1.3,
    )
    event = event_of(touched, "touch")
    assert event.object is not None
    assert (event.object.carried, event.outcome) == (False, "unmoved")


def test_an_object_out_of_reach_when_it_was_seen_last_is_not_in_the_hand() -> None:
    scene = Scene(
        right_hand=moving((0.5, (0.2, 0.1, 0.2)), (1.5, (0.2, 0.1, 0.5))),
        objects={1: still((0.8, 0.0, 0.5))},
        hidden=lambda _, t: t > 0.3,
    )
    event = event_of(scene, "push")
    assert event.object is None


def test_one_sighting_where_it_was_left_tells_all() -> None:
    then = (0.1, 0.0, 0.66)
    seen_at = 1.94
    covered = acting_on(
        CUP, then, others=OTHERS, hidden=lambda number, t: number == 1 and t > 0.75 and abs(t - seen_at) > 0.02
    )
    crooked = Scene(
        right_hand=lambda t: tuple(np.add(covered.right_hand(t), (0.03, 0.02, 0.0) if t > 1.2 else 0.0).tolist()),
        objects=covered.objects,
        hidden=covered.hidden,
    )
    event = event_of(crooked, "push")
    assert event.motion is not None
    assert np.allclose(event.motion.displacement_m, np.subtract(then, CUP), atol=1e-9)


def test_an_object_not_seen_since_before_the_hand_came_goes_with_it() -> None:
    covered = acting_on(CUP, (0.1, 0.0, 0.66), others=OTHERS, hidden=lambda number, t: number == 1 and t > 0.1)
    event = event_of(covered, "push")
    assert event.object is not None
    assert (event.object.id, event.object.carried, event.outcome) == (1, True, "pushed")


def test_what_was_moved_before_the_segment_has_not_moved_in_it() -> None:
    """It is seen last while it is being set down, and again when the segment has begun."""
    scene = Scene(
        right_hand=moving((0.3, (0.2, 0.1, 0.2)), (1.0, (0.1, 0.08, 0.45))),
        objects={1: moving((-0.9, (0.1, 0.1, 0.45)), (-0.2, CUP))},
        hidden=lambda _, t: -0.5 < t < 0.1,
    )
    event = event_of(scene, "touch")
    assert event.object is not None
    assert (event.object.id, event.outcome) == (1, "unmoved")


def test_one_crooked_posture_at_the_start_turns_no_direction() -> None:
    scene = acting_on(CUP, (0.1, 0.0, 0.66), others=OTHERS)
    aside = replace(scene, stance=Stance(heading_rad=0.6))
    first = min(p.stamp_ns for p in scene.postures() if p.stamp_ns >= action("push").start_ns)
    turned = {p.stamp_ns: p for p in aside.postures()}
    postures = [
        turned[p.stamp_ns].model_copy(update={"joints_m": p.joints_m}) if p.stamp_ns == first else p
        for p in scene.postures()
    ]
    event = fused.event_of(*postures, *scene.sightings(), action("push"))
    assert event.motion is not None
    assert np.allclose(event.motion.displacement_m, (0.0, 0.0, 0.21), atol=0.01)
