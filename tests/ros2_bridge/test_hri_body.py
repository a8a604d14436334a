"""Angles of joints and poses of links are those of human_description's model, whose poses lead back to the bones."""

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.skeletons import INDEX
from human_model import MOVABLE, poses
from people import STANDING, lacking
from ros2_bridge.hri_out.body import LINKS, Body, body_of
from ros2_bridge.hri_out.limbs import LEAST_BENT, LEAST_TWIST, arm, head, leg

BONES = [
    (f"{side}_{start}", f"{side}_{end}")
    for side in "lr"
    for start, end in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"), ("knee", "ankle"))
]
directions = (
    st.tuples(*[st.floats(-1, 1)] * 3)
    .filter(lambda it: np.linalg.norm(it) > 0.1)
    .map(lambda it: (np.array(it) / np.linalg.norm(it)).tolist())
)


def bone(placed: dict[str, np.ndarray], start: str, end: str) -> np.ndarray:
    """The unit vector along a bone of the model."""
    along = placed[end][:3, 3] - placed[start][:3, 3]
    return along / np.linalg.norm(along)


@given(directions, directions, st.sampled_from("lr"))
def test_an_arms_angles_point_the_models_arm_as_the_bones_point(upper, fore, side) -> None:
    assume(np.hypot(*upper[:2]) > 0.06)
    placed = poses(arm(side, upper, fore).angles)
    assert bone(placed, f"{side}_shoulder", f"{side}_elbow") == pytest.approx(upper, abs=1e-6)
    assert bone(placed, f"{side}_elbow", f"{side}_wrist") == pytest.approx(fore, abs=2 * LEAST_TWIST), (
        "a straight or folded arm has no twist"
    )


@given(directions, directions, st.sampled_from("lr"))
@example([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], "l").via("a vertical knee axis: gimbal lock")
@example([1.0, 0.0, 0.0], [0.0, -1.0, 0.0], "r").via("the same, mirrored")
def test_a_legs_angles_point_the_models_leg_as_the_bones_point(thigh, shank, side) -> None:
    assume(np.linalg.norm(np.cross(thigh, shank)) > LEAST_BENT)
    limb = leg(side, thigh, shank)
    placed = poses(limb.angles)
    assert bone(placed, f"{side}_hip", f"{side}_knee") == pytest.approx(thigh, abs=1e-6)
    assert bone(placed, f"{side}_knee", f"{side}_ankle") == pytest.approx(shank, abs=1e-6)
    assert limb.angles[f"{side}_knee"] < 0, "the model's knee bends backwards at negative angles"


@given(directions)
def test_a_thigh_is_pointed_also_where_its_twist_is_not_known(thigh) -> None:
    for shank in (None, thigh):
        limb = leg("l", thigh, shank)
        assert bone(poses(limb.angles), "l_hip", "l_knee") == pytest.approx(thigh, abs=1e-6)
        assert limb.angles["l_y_hip"] == 0


@given(directions)
def test_the_heads_angles_point_the_models_head_and_leave_out_where_it_looks(direction) -> None:
    limb = head(direction)
    assert poses(limb.angles)["p_head"][:3, 2] == pytest.approx(direction, abs=1e-6)
    assert "y_head" not in limb.angles


def test_an_arm_hanging_or_a_straight_one_has_no_twist() -> None:
    hanging = arm("l", (0, 0, -1), (0, 0, -1))
    assert hanging.angles == pytest.approx({"l_y_shoulder": 0, "l_p_shoulder": 0, "l_elbow": 0})


@pytest.mark.parametrize("side", ["l", "r"])
@pytest.mark.parametrize("up", [-1, 1], ids=["hangs", "is raised"])
@pytest.mark.parametrize("aside_deg", [-2.5, 2.5])
def test_an_arm_that_hangs_or_is_raised_leans_to_the_side_to_which_it_was_seen_to_lean(side, up, aside_deg) -> None:
    """Whether it also leans ahead is left out: the first angle would turn about as an arm swings."""
    aside = np.radians(aside_deg)
    angles = arm(side, (0, np.sin(aside), up * np.cos(aside)), None).angles
    assert bone(poses(angles), f"{side}_shoulder", f"{side}_elbow") == pytest.approx(
        (0, np.sin(aside), up * np.cos(aside)), abs=1e-6
    )
    assert angles[f"{side}_y_shoulder"] == 0


@pytest.mark.parametrize(
    ("side", "upper", "angles"),
    [
        ("l", (0, 1, 0), {"l_y_shoulder": 0, "l_p_shoulder": np.pi / 2}),
        ("r", (0, -1, 0), {"r_y_shoulder": 0, "r_p_shoulder": np.pi / 2}),
        ("l", (1, 0, 0), {"l_y_shoulder": np.pi / 2, "l_p_shoulder": np.pi / 2}),
        ("r", (1, 0, 0), {"r_y_shoulder": np.pi / 2, "r_p_shoulder": np.pi / 2}),
    ],
)
def test_an_arm_to_the_side_or_ahead_has_the_same_angles_left_and_right(side, upper, angles) -> None:
    assert arm(side, upper, None).angles == pytest.approx(angles)


def standing() -> Body:
    body = body_of(STANDING)
    assert body is not None
    return body


def leaning() -> np.ndarray:
    """Who stands with the torso 6 cm beside the middle of the hips."""
    joints = STANDING.copy()
    joints[INDEX["torso"], 0] += 0.06
    return joints


def test_the_bodys_frame_lies_between_the_hips_with_x_ahead_and_z_to_the_head() -> None:
    aside = body_of(leaning())
    assert aside is not None
    middle = (STANDING[INDEX["left_hip"]] + STANDING[INDEX["right_hip"]]) / 2
    assert aside.optical_from_body[:3, 3] == pytest.approx(middle)
    placed = standing().optical_from_body
    assert placed[:3, 3] == pytest.approx((STANDING[INDEX["left_hip"]] + STANDING[INDEX["right_hip"]]) / 2)
    assert placed[:3, 0] == pytest.approx([0, 0, -1], abs=0.05)
    assert placed[:3, 2] == pytest.approx([0, -1, 0], abs=0.05)


def test_each_link_lies_at_its_joint_in_the_bodys_frame() -> None:
    joints = leaning()
    body = body_of(joints)
    assert body is not None
    assert body.links.keys() == LINKS.keys()
    for link, joint in LINKS.items():
        placed = body.optical_from_body @ [*body.links[link][0], 1]
        assert placed[:3] == pytest.approx(joints[INDEX[joint]])


def test_each_link_is_turned_as_the_models() -> None:
    body = standing()
    model = poses(body.angles)
    for link in (name for pair in BONES for name in pair):
        x, y, z, w = body.links[link][1]
        down = [-2 * (x * z + w * y), -2 * (y * z - w * x), -(1 - 2 * (x * x + y * y))]
        assert -model[link][:3, 2] == pytest.approx(down, abs=1e-6), link


def test_all_angles_are_of_joints_of_the_model_and_only_where_the_head_looks_is_missing() -> None:
    bent = STANDING + np.where(np.arange(15)[:, None] == INDEX["left_knee"], [[0, 0, -0.3]], 0)
    bent[INDEX["right_knee"], 2] -= 0.3
    body = body_of(bent)
    assert body is not None
    assert MOVABLE - body.angles.keys() == {"y_head"}
    assert body.angles.keys() <= MOVABLE


@pytest.mark.parametrize(
    ("missing", "left_out"),
    [
        ("left_elbow", {"l_y_shoulder", "l_p_shoulder", "l_r_shoulder", "l_elbow"}),
        ("left_hand", {"l_r_shoulder", "l_elbow"}),
        ("right_foot", {"r_knee"}),
        ("head", {"r_head", "p_head"}),
    ],
)
def test_what_is_not_observed_is_left_out(missing, left_out) -> None:
    body = body_of(lacking(STANDING, missing))
    assert body is not None
    assert standing().angles.keys() - body.angles.keys() == left_out
    assert {link for link, joint in LINKS.items() if joint == missing} == LINKS.keys() - body.links.keys()


def test_without_hips_or_torso_there_is_no_frame() -> None:
    for missing in ("left_hip", "torso"):
        assert body_of(lacking(STANDING, missing)) is None
