from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.arrays import Array
from actum.skeletons import INDEX, JOINTS
from scene_simulator.actor import FOREARM, UPPER_ARM, Actor, draw_actor
from scene_simulator.inverse_kinematics import Stance, eye, fingertip, pose
from scene_simulator.parameters import load_parameters
from scene_simulator.pointing import pointing_palm

PARAMETERS = load_parameters().actor
PELVIS = np.array([0.0, 0.4, 2.3])
RESTING = np.array([[0.12, 0.38, 2.0], [-0.12, 0.38, 2.0]])
MIRROR = np.array([-1.0, 1.0, 1.0])

places = st.tuples(st.floats(-0.3, 0.3), st.floats(0.1, 0.4), st.floats(1.65, 1.95)).map(np.array)
on_the_table = st.tuples(st.floats(-0.27, 0.27), st.floats(0.15, 0.37), st.floats(1.6, 1.74)).map(np.array)
persons = st.integers(0, 500).map(lambda seed: draw_actor(PARAMETERS, seed))


def standing(actor: Actor, heading_rad: float = 0.0, pelvis_m: Array = PELVIS) -> Stance:
    return Stance(pelvis_m[None], np.array([heading_rad]), np.array([actor.lean_rad]))


def hands_of(actor: Actor, place: Array) -> Array:
    hands = RESTING.copy()
    hands[0 if actor.hand == "left" else 1] = place
    return hands[None]


def length(joints: Array, first: str, second: str) -> float:
    return float(np.linalg.norm(joints[INDEX[first]] - joints[INDEX[second]]))


@given(persons, places)
def test_the_acting_hand_gets_where_it_should_with_bones_of_their_length(actor: Actor, place: Array) -> None:
    joints = pose(actor, standing(actor), hands_of(actor, place))[0]

    np.testing.assert_allclose(joints[INDEX[f"{actor.hand}_hand"]], place, atol=1e-6)
    for side in ("left", "right"):
        assert length(joints, f"{side}_shoulder", f"{side}_elbow") == pytest.approx(UPPER_ARM * actor.height_m)
        assert length(joints, f"{side}_elbow", f"{side}_hand") == pytest.approx(FOREARM * actor.height_m)


@given(persons, places, st.floats(-1, 1))
def test_a_person_who_turns_on_the_spot_takes_the_posture_along(actor: Actor, place: Array, turn: float) -> None:
    sin, cos = np.sin(turn), np.cos(turn)
    rotation = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    hands = hands_of(actor, place)
    joints = pose(actor, standing(actor), hands)

    turned = pose(actor, standing(actor, turn), (hands - PELVIS) @ rotation.T + PELVIS)

    np.testing.assert_allclose(turned, (joints - PELVIS) @ rotation.T + PELVIS, atol=1e-6)


@given(persons, places)
def test_a_left_handed_person_is_the_mirror_image_of_a_right_handed_one(actor: Actor, place: Array) -> None:
    mirrored = replace(actor, hand="left" if actor.hand == "right" else "right")
    hands = hands_of(actor, place)
    swapped = [INDEX[name.replace("left", "*").replace("right", "left").replace("*", "right")] for name in JOINTS]

    joints = pose(mirrored, standing(actor), hands[:, ::-1] * MIRROR)

    np.testing.assert_allclose(joints[:, swapped] * MIRROR, pose(actor, standing(actor), hands), atol=1e-9)


def test_left_and_right_are_the_actors_own() -> None:
    actor = draw_actor(PARAMETERS, 0)
    joints = pose(actor, standing(actor), RESTING[None])[0]

    assert joints[INDEX["left_shoulder"], 0] > 0 > joints[INDEX["right_shoulder"], 0]
    assert joints[INDEX["head"], 1] < joints[INDEX["torso"], 1] < joints[INDEX["left_foot"], 1]


def test_a_hand_out_of_reach_is_drawn_back_to_the_stretched_arm() -> None:
    actor = draw_actor(PARAMETERS, 0)
    joints = pose(actor, standing(actor), hands_of(actor, np.array([0.0, 0.0, 0.2])))[0]

    reached = length(joints, f"{actor.hand}_shoulder", f"{actor.hand}_hand")
    assert reached == pytest.approx(actor.arm_m, rel=0.01)


@settings(max_examples=25)
@given(persons, on_the_table, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1))
def test_pointing_puts_the_fingertip_on_the_line_from_the_eye(
    actor: Actor, target: Array, azimuth: float, elevation: float
) -> None:
    stance = standing(actor)
    hand = pointing_palm(actor, stance, RESTING[None], target, np.array([azimuth, elevation]), stand_off_m=0.15)
    joints = pose(actor, stance, hands_of(actor, hand))

    towards, tip = target - eye(actor, stance, joints)[0], fingertip(actor, joints)[0]
    line = tip - eye(actor, stance, joints)[0]
    missed = np.arctan2(np.linalg.norm(np.cross(line, towards)), line @ towards)
    wanted = np.arctan(np.hypot(np.tan(azimuth), np.tan(elevation)))
    assert missed == pytest.approx(wanted, abs=np.deg2rad(0.2))
    assert np.linalg.norm(tip - target) > 0.145


@settings(max_examples=3)
@given(persons)
def test_at_something_far_people_point_with_an_arm_that_is_not_quite_straight(actor: Actor) -> None:
    stance = standing(actor)
    hand = pointing_palm(actor, stance, RESTING[None], np.array([0.0, 0.0, 0.3]), np.zeros(2), stand_off_m=0.15)
    joints = pose(actor, stance, hands_of(actor, hand))
    reached = np.linalg.norm(fingertip(actor, joints)[0] - joints[0, INDEX[f"{actor.hand}_shoulder"]])
    assert reached / (actor.arm_m + actor.finger_m) == pytest.approx(0.97, abs=0.01)


def test_people_differ_and_the_same_seed_is_the_same_person() -> None:
    people = [draw_actor(PARAMETERS, seed) for seed in range(300)]

    assert repr(people[5]) == repr(draw_actor(PARAMETERS, 5))
    assert people[0].hand == "right"
    assert np.mean([p.hand == "left" for p in people]) == pytest.approx(PARAMETERS.left_handed_probability, abs=0.06)
    bias = np.rad2deg([p.bias_rad for p in people])
    assert bias.std() == pytest.approx(PARAMETERS.pointing_bias_sd_deg, rel=0.15)
