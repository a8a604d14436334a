"""What one event says about an action whose scene is known exactly."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum.messages import Event
from actum.node import Tick
from fused import event_in, event_of
from scenes import ELBOW_RIGHT, HEAD, NAMES, REST_RIGHT, SHOULDER_RIGHT, Scene, Stance, acting_on, action, moving, still

CUP = (0.1, 0.0, 0.45)
OTHERS = {2: (-0.25, 0.0, 0.5), 3: (0.45, 0.0, 0.5)}


@pytest.mark.parametrize(
    ("label", "then", "result"),
    [
        ("push", (0.1, 0.0, 0.66), "0.21 m away"),
        ("pull", (0.1, 0.0, 0.27), "0.18 m towards"),
        ("lift", (0.1, 0.18, 0.45), "0.18 m up"),
        ("put", (0.1, -0.12, 0.45), "0.12 m down"),
        ("sweep", (0.35, 0.0, 0.45), "0.25 m right"),
        ("sweep", (-0.1, 0.0, 0.45), "0.20 m left"),
        ("touch", (0.11, 0.01, 0.45), "unmoved"),
    ],
)
def test_the_object_in_the_hand_is_named_with_what_became_of_it(label, then, result) -> None:
    event = event_in(acting_on(CUP, then, others=OTHERS), action(label))
    assert event.object is not None and (event.object.id, event.object.name) == (1, "cup")
    assert event.motion is not None
    assert np.allclose(event.motion.displacement_m, np.subtract(then, CUP), atol=1e-9)
    assert event.result == result
    assert event.sentence == f'{label} object 1 "cup", {result}, 0.94'


def test_distances_are_the_smallest_from_hand_to_object() -> None:
    event = event_in(acting_on(CUP, (0.1, 0.0, 0.65), hand_above_m=0.08, others={3: (0.1, 0.0, 0.85)}), action("push"))
    assert event.distances_m == pytest.approx({"1": 0.08, "3": np.hypot(0.2, 0.08)})
    assert event.object is not None and event.object.distance_m == event.distances_m["1"]
    assert event.objects_present == [1, 3]


def test_what_the_action_says_is_copied() -> None:
    act = action("push", activations={"push": 0.94, "pull": 0.1}, familiarity=0.7, frames=61, missed=2)
    event = event_in(acting_on(CUP, CUP), act)
    kept = "stamp_ns sensor agent segment_id start_ns end_ns action confidence familiarity activations frames"
    assert {name: getattr(event, name) for name in kept.split()} == {name: getattr(act, name) for name in kept.split()}
    assert (event.valid, event.missed, event.held) == (True, 2, None)


def test_an_object_occluded_by_the_hand_is_known_between_its_sightings() -> None:
    covered = acting_on(CUP, (0.1, 0.0, 0.65), others=OTHERS, hidden=lambda number, t: number == 1 and 0.7 < t < 1.7)
    event = event_in(covered, action("push"))
    assert event.object is not None and event.object.id == 1
    assert event.result == "0.20 m away"
    assert event.objects_present == [1, 2, 3]


def test_an_object_only_seen_long_before_the_segment_is_not_present() -> None:
    scene = acting_on(CUP, CUP, others=OTHERS, hidden=lambda number, t: number == 2 and t > -0.95)
    assert event_in(scene, action("touch")).objects_present == [1, 3]


def test_nothing_within_reach_and_nothing_moved_is_a_pantomime() -> None:
    far = {number: (0.0, 0.0, 1.5 + number) for number in (1, 2)}
    scene = Scene(right_hand=acting_on(CUP, (0.1, 0.0, 0.65)).right_hand, objects={k: still(v) for k, v in far.items()})
    event = event_in(scene, action("push"))
    assert (event.object, event.motion, event.result) == (None, None, None)
    assert (event.objects_present, set(event.distances_m)) == ([1, 2], {"1", "2"})
    assert event.sentence == "push, no object within reach, 0.94"


def test_without_objects_the_sentence_is_the_action_alone() -> None:
    event = event_in(Scene(), action("high arm wave"))
    assert (event.object, event.distances_m, event.objects_present) == (None, {}, [])
    assert event.sentence == "high arm wave, 0.94"


@pytest.mark.parametrize(
    ("fields", "hand", "chosen"),
    [
        ({"hand": "left", "part": "right_arm"}, "left", 2),
        ({"part": "left_arm"}, "left", 2),
        ({"part": "right_arm"}, "right", 3),
        ({"part": "body"}, "right", 3),
        ({"part": None}, "right", 3),
    ],
)
def test_the_hand_is_the_marked_one_or_the_moving_arms_or_the_nearer(fields, hand, chosen) -> None:
    scene = Scene(objects={2: still((-0.2, 0.0, 0.3)), 3: still((0.2, 0.02, 0.2))})
    event = event_in(scene, action("touch", **fields))
    assert event.hand == hand
    assert event.object is not None and event.object.id == chosen


def test_no_hand_is_named_where_either_may_have_acted_on_nothing() -> None:
    assert event_in(Scene(), action("bow", part="body")).hand is None


def pointing_at(target: tuple[float, float, float], share: float) -> Scene:
    """Stretch the arm: the fingertip, a decimetre beyond the hand, is on the line from the head to the target."""
    tip = np.array(HEAD) + share * np.subtract(target, HEAD)
    forearm = tip - ELBOW_RIGHT
    hand = tuple((tip - 0.1 * forearm / np.linalg.norm(forearm)).tolist())
    places = {1: (-0.3, 0.0, 0.9), 2: (0.1, 0.0, 0.9), 3: (0.5, 0.0, 0.9)}
    return Scene(
        right_hand=moving((0.0, REST_RIGHT), (1.0, hand), (1.9, hand), (2.0, REST_RIGHT)),
        objects={number: still(place) for number, place in places.items()},
    )


@pytest.mark.parametrize(("target", "pointed_at"), [((-0.3, 0.0, 0.9), 1), ((0.1, 0.0, 0.9), 2), ((0.5, 0.0, 0.9), 3)])
@pytest.mark.parametrize("share", [0.4, 0.7])
def test_pointing_is_resolved_by_the_line_from_the_head_through_the_fingertip(target, pointed_at, share) -> None:
    event = event_in(pointing_at(target, share), action("point"))
    assert event.object is not None and event.object.id == pointed_at
    assert event.object.distance_m == event.distances_m[str(pointed_at)]
    assert event.sentence == f'point object {pointed_at} "{NAMES[pointed_at]}", unmoved, 0.94'


@pytest.mark.parametrize(("target", "pointed_at"), [((-0.3, 0.0, 0.9), 1), ((0.1, 0.0, 0.9), 2), ((0.5, 0.0, 0.9), 3)])
def test_pointing_is_resolved_by_the_ray_of_the_arm(target, pointed_at) -> None:
    ray = np.subtract(target, SHOULDER_RIGHT)
    elbow, hand = (tuple((SHOULDER_RIGHT + metres * ray / np.linalg.norm(ray)).tolist()) for metres in (0.3, 0.55))
    arm = {
        "right_hand": moving((0.0, REST_RIGHT), (1.0, hand)),
        "right_elbow": moving((0.0, ELBOW_RIGHT), (1.0, elbow)),
    }
    event = event_in(Scene(**arm, objects=pointing_at(target, 0.5).objects), action("point"))
    assert event.object is not None and event.object.id == pointed_at
    assert event.pointing is not None and event.pointing.angle_deg == pytest.approx(0.0, abs=1e-5)


def test_pointing_may_choose_an_object_that_is_not_the_nearest() -> None:
    behind = (0.1, 0.0, 1.6)
    scene = pointing_at(behind, 0.4)
    nearer = {**scene.objects, 1: still((0.1, -0.1, 0.5)), 2: still(behind)}
    event = event_in(Scene(right_hand=scene.right_hand, objects=nearer), action("point"))
    assert event.distances_m["1"] < event.distances_m["2"]
    assert event.object is not None and event.object.id == 2


def test_the_pointing_hand_is_named_where_it_may_have_been_either() -> None:
    event = event_in(pointing_at((0.1, 0.0, 0.9), 0.6), action("point", part="body"))
    assert event.hand == "right"


def test_pointing_at_the_ceiling_is_at_no_object() -> None:
    event = event_in(pointing_at((0.1, 2.0, 0.5), 0.5), action("point"))
    assert event.object is None
    assert event.sentence == "point, no object along the arm, 0.94"


def test_a_leaning_torso_moves_no_object() -> None:
    leaning = acting_on(CUP, CUP, others=OTHERS, lean=lambda t: 0.5 * np.clip(t, 0.0, 1.0))
    event = event_in(leaning, action("touch"))
    assert event.motion is not None
    assert np.allclose(event.motion.displacement_m, 0.0, atol=1e-9)
    assert event.result == "unmoved"
    assert event.distances_m["1"] == pytest.approx(0.08)


def test_up_is_against_gravity_where_the_camera_is_not_level() -> None:
    lifted, tilt = acting_on(CUP, (0.1, 0.2, 0.45)), np.radians(20)
    up = [0.0, -float(np.cos(tilt)), float(np.sin(tilt))]
    told = [posture.model_copy(update={"up_in_camera": up}) for posture in lifted.postures()]
    event = event_of(*told, *lifted.sightings(), action("lift"))
    assert event.motion is not None
    # The true rise, seen by a camera that believes to look 20 degrees upwards at an actor who faces it.
    assert np.allclose(event.motion.displacement_m, [0.0, 0.2 * np.cos(tilt), 0.2 * np.sin(tilt)], atol=1e-9)


@cache
def pushed_from(stance: Stance) -> Event:
    bowed = acting_on(CUP, (0.15, 0.05, 0.65), others=OTHERS, lean=lambda _: 0.3, stance=stance)
    return event_in(bowed, action("push"))


@settings(max_examples=25)
@given(st.floats(-1.5, 1.5), st.floats(1.0, 4.0), st.floats(-np.pi, np.pi))
def test_where_the_actor_stands_and_faces_changes_nothing(x_m, z_m, heading_rad) -> None:
    plain, moved = pushed_from(Stance()), pushed_from(Stance(x_m, z_m, heading_rad))
    assert moved.motion is not None
    assert np.allclose(moved.motion.displacement_m, [0.05, 0.05, 0.2], atol=1e-9)
    assert moved.distances_m == pytest.approx(plain.distances_m, abs=1e-9)
    assert (moved.sentence, moved.hand, moved.objects_present) == (plain.sentence, plain.hand, plain.objects_present)


def test_postures_lost_on_the_way_to_fusion_are_added_to_the_missed() -> None:
    scene = acting_on(CUP, CUP)
    inside = [posture for posture in scene.postures() if 0.5 < (posture.stamp_ns - action("x").start_ns) / 1e9 < 0.65]
    kept = [posture for posture in scene.postures() if posture not in inside]
    event = event_of(*kept, *scene.sightings(), action("touch", missed=2))
    assert len(inside) > 0
    assert event.missed == 2 + len(inside)


def test_numbers_that_start_anew_are_no_gap() -> None:
    scene = acting_on(CUP, CUP)
    renumbered = [
        posture.model_copy(update={"seq": i if i < 50 else i - 50}) for i, posture in enumerate(scene.postures())
    ]
    event = event_of(*renumbered, *scene.sightings(), action("touch"))
    assert event.missed == 0


def test_it_has_nothing_to_say_to_ticks_and_partial_actions() -> None:
    node = ActionFusion(Settings())
    partial = action("push").model_copy(update={"final": False, "end_ns": None})
    assert [*node.handle(Tick(0)), *node.handle(partial)] == []


def test_pointing_tells_its_angle_and_its_margin_over_the_runner_up() -> None:
    event = event_in(pointing_at((0.1, 0.0, 0.9), 0.5), action("point"))
    assert event.pointing is not None and event.pointing.margin_deg is not None
    assert event.pointing.angle_deg == pytest.approx(0.0, abs=1e-5)
    sights = [np.subtract(place, HEAD) for place in ((0.1, 0.0, 0.9), (0.5, 0.0, 0.9), (-0.3, 0.0, 0.9))]
    units = [sight / np.linalg.norm(sight) for sight in sights]
    assert event.pointing.margin_deg == pytest.approx(np.degrees(np.arccos(max(units[0] @ u for u in units[1:]))))
    assert event.candidates == []


def test_pointing_between_two_objects_names_both() -> None:
    event = event_in(pointing_at((-0.1, 0.0, 0.9), 0.5), action("point"))
    assert event.object is not None
    assert {candidate.id for candidate in event.candidates} == {1, 2}
    assert event.candidates[0].id == event.object.id
    assert " or object " in event.sentence


def test_with_one_object_there_is_no_margin() -> None:
    scene = pointing_at((0.1, 0.0, 0.9), 0.5)
    event = event_in(Scene(right_hand=scene.right_hand, objects={2: scene.objects[2]}), action("point"))
    assert event.pointing is not None and event.pointing.margin_deg is None
