"""Joint angles of ROS4HRI's human model become places, as its URDF says."""

import math

import numpy as np
import pytest

from human_model import poses
from ros2_bridge.hri.human_model import (
    FOREARM_M,
    HEAD_RADIUS_M,
    LINKS,
    NECK_M,
    NECK_TO_SHOULDER_M,
    SHANK_M,
    THIGH_M,
    TORSO_M,
    UPPER_ARM_M,
    WAIST_M,
    link_places,
)
from ros2_bridge.hri.placements import Placement, placement
from ros2_bridge.rotations import about, rotated

UPRIGHT = {link.joint: 0.0 for link in LINKS if link.joint is not None}
QUARTER = math.pi / 2


def places(**angles_rad: float) -> dict[str, tuple[float, float, float]]:
    return link_places({**UPRIGHT, **angles_rad})


def test_the_model_has_the_twenty_joints_that_detectors_publish() -> None:
    head = {"waist", "r_head", "y_head", "p_head"}
    arms = {f"{side}_{joint}" for side in "lr" for joint in ("y_shoulder", "p_shoulder", "r_shoulder", "elbow")}
    legs = {f"{side}_{joint}" for side in "lr" for joint in ("y_hip", "p_hip", "r_hip", "knee")}
    assert {*UPRIGHT} == head | arms | legs


def test_links_lie_where_another_reading_of_the_model_has_them() -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        angles = {joint: float(angle) for joint, angle in zip(UPRIGHT, rng.uniform(-2, 2, len(UPRIGHT)), strict=True)}
        ours, theirs = link_places(angles), poses(angles)
        for link in theirs:
            assert np.array(ours[link]) / FOREARM_M == pytest.approx(theirs[link][:3, 3]), link


def test_without_angles_a_body_stands_with_hanging_arms() -> None:
    found = places()
    assert found["torso"] == pytest.approx((0, 0, TORSO_M))
    assert found["head"] == pytest.approx((0, 0, TORSO_M + NECK_M + HEAD_RADIUS_M))
    assert found["l_wrist"] == pytest.approx((0, NECK_TO_SHOULDER_M, TORSO_M - UPPER_ARM_M - FOREARM_M))
    assert found["r_ankle"] == pytest.approx((0, -WAIST_M / 2, -THIGH_M - SHANK_M))


@pytest.mark.parametrize(("side", "out"), [("l", 1), ("r", -1)])
def test_the_shoulders_pitch_lifts_an_arm_to_its_own_side(side: str, out: int) -> None:
    wrist = places(**{f"{side}_p_shoulder": QUARTER})[f"{side}_wrist"]
    assert wrist == pytest.approx((0, out * (NECK_TO_SHOULDER_M + UPPER_ARM_M + FOREARM_M), TORSO_M))


@pytest.mark.parametrize(("side", "out"), [("l", 1), ("r", -1)])
def test_an_elbow_bends_forward_and_a_knee_backward(side: str, out: int) -> None:
    found = places(**{f"{side}_elbow": QUARTER, f"{side}_knee": -QUARTER})
    assert found[f"{side}_wrist"] == pytest.approx((FOREARM_M, out * NECK_TO_SHOULDER_M, TORSO_M - UPPER_ARM_M))
    assert found[f"{side}_ankle"] == pytest.approx((-SHANK_M, out * WAIST_M / 2, -THIGH_M))


@pytest.mark.parametrize(("side", "out"), [("l", 1), ("r", -1)])
def test_angles_of_a_shoulder_turn_one_after_the_other(side: str, out: int) -> None:
    lifted_ahead = {f"{side}_y_shoulder": QUARTER, f"{side}_p_shoulder": QUARTER}
    shoulder, wrist = (places(**lifted_ahead)[f"{side}_{name}"] for name in ("shoulder", "wrist"))
    assert [end - start for end, start in zip(wrist, shoulder, strict=True)] == pytest.approx(
        [UPPER_ARM_M + FOREARM_M, 0, 0]
    )
    forearm_in = places(**lifted_ahead, **{f"{side}_r_shoulder": QUARTER, f"{side}_elbow": QUARTER})
    along = [end - start for end, start in zip(forearm_in[f"{side}_wrist"], forearm_in[f"{side}_elbow"], strict=True)]
    assert math.hypot(*along) == pytest.approx(FOREARM_M)
    assert along[0] == pytest.approx(0, abs=1e-9), "the upper arm points ahead, and the forearm across"


def test_the_waist_bends_the_trunk_forward_and_leaves_the_legs() -> None:
    found = places(waist=QUARTER)
    assert found["torso"] == pytest.approx((TORSO_M, 0, 0))
    assert found["l_ankle"] == places()["l_ankle"]


def test_what_hangs_on_an_unknown_angle_has_no_place() -> None:
    without_elbow = {name: angle for name, angle in UPRIGHT.items() if name != "l_elbow"}
    assert {*places()} - {*link_places(without_elbow)} == {"l_wrist"}
    assert {*places()} - {*places(r_p_hip=math.nan)} == {"r_hip", "r_knee", "r_ankle"}
    assert {*places()} - {*places(waist=math.nan)} >= {"torso", "head", "l_wrist"}


def test_a_straight_arm_whose_twist_nobody_sees_keeps_its_hand() -> None:
    lifted = {"l_p_shoulder": QUARTER, "l_y_shoulder": 0.3}
    known, unknown = places(**lifted, l_r_shoulder=0.8), places(**lifted, l_r_shoulder=math.nan)
    for link in ("l_elbow", "l_wrist"):
        assert unknown[link] == pytest.approx(known[link])


def test_where_a_head_looks_need_not_be_known() -> None:
    tilted = {"r_head": 0.4, "p_head": -0.3}
    assert places(**tilted, y_head=math.nan)["head"] == places(**tilted)["head"]


def test_a_placement_and_its_inverse_lead_back() -> None:
    there = Placement((1.0, -2.0, 3.0), about((0.6, 0.0, 0.8), 0.7))
    assert there.inverse().at(there.at((0.3, 0.2, 0.1))) == pytest.approx((0.3, 0.2, 0.1))
    back = there.inverse().of(there)
    assert back.position_m == pytest.approx((0, 0, 0))
    assert back.xyzw == pytest.approx((0, 0, 0, 1))


def test_a_turn_is_right_handed() -> None:
    assert rotated(about((0, 0, 1), QUARTER), (1, 0, 0)) == pytest.approx((0, 1, 0))


@pytest.mark.parametrize("xyzw", [(0, 0, 0, 0), (0, 0, 0, 2), (math.nan, 0, 0, 1), (1, 1, 0, 0)])
def test_what_is_no_rotation_places_nothing(xyzw: tuple[float, float, float, float]) -> None:
    assert placement((0, 0, 0), xyzw, 10) is None


@pytest.mark.parametrize("x_m", [math.nan, math.inf, -11.0])
def test_a_frame_that_is_nowhere_or_too_far_away_is_not_placed(x_m: float) -> None:
    assert placement((0, x_m, 0), (0, 0, 0, 1), 10) is None
