"""Sources that lack joints, always or at times: what is known is published, what is not is null."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from actum import standard_body
from actum.messages import Joint, Posture
from actum.skeletons import INDEX, JOINTS
from people import FRAME_NS, STANDING, lacking, reaching, skeleton
from pose_preprocessor.bridging import BRIDGED_NS
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.part_motion import TIME_CONSTANT_S
from pose_preprocessor.settings import Settings as PoseSettings

Array = NDArray[np.float64]

HIPS, SHOULDERS = {"left_hip", "right_hip"}, {"left_shoulder", "right_shoulder"}
KNEES, FEET = {"left_knee", "right_knee"}, {"left_foot", "right_foot"}
RIGHT_ARM = ("right_shoulder", "right_elbow", "right_hand")
LEGS = {"no feet": FEET, "no legs": HIPS | KNEES | FEET, "no hips": HIPS, "one hip": {"left_hip"}}
PARENT = {JOINTS[child]: JOINTS[parent] for parent, child, _ in standard_body.BONES}
SUBSETS = st.sets(st.sampled_from(JOINTS))


def postures(frames: list[Array], node: PosePreprocessor | None = None, first_ns: int = 0) -> list[Posture]:
    node = node or PosePreprocessor(PoseSettings.defaults())
    made = [p for i, joints in enumerate(frames) for p in node.handle(skeleton(first_ns + i * FRAME_NS, joints))]
    return [posture for posture in made if isinstance(posture, Posture)]


def reaching_frames(frames: int = 30) -> list[Array]:
    """A person who reaches, and never holds any joint quite still."""
    return [reaching(i / frames) + 1e-9 * i for i in range(frames)]


def known(joints: list[Joint] | None) -> set[str]:
    assert joints is not None
    return {name for name, joint in zip(JOINTS, joints, strict=True) if joint is not None}


def reachable(missing: set[str]) -> set[str]:
    """The joints whose every step back to the torso is there."""
    there = {"torso"} - missing
    for name, parent in PARENT.items():
        if parent in there and name not in missing:
            there.add(name)
    return there


def usable(missing: set[str]) -> bool:
    trunk = not missing & {"torso", "neck"}
    return trunk and (not missing & HIPS or not missing & SHOULDERS)


def same_where_known(partial: list[Joint] | None, whole: list[Joint] | None) -> None:
    assert partial is not None and whole is not None
    for some, all_ in zip(partial, whole, strict=True):
        if some is not None:
            np.testing.assert_allclose(some, all_, atol=1e-12)


@given(SUBSETS)
def test_whatever_is_missing_the_rest_is_published_or_the_frame_is_named_unusable(missing: set[str]) -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    made = postures([lacking(joints, *missing) for joints in reaching_frames(2)], node)
    for posture in made:
        json.dumps(posture.model_dump(), allow_nan=False)
        assert posture.valid is usable(missing)
        if posture.valid:
            assert known(posture.joints_m) == set(JOINTS) - missing
            assert known(posture.joints) == known(posture.upright) == reachable(missing)
        else:
            named = ", ".join(name for name in JOINTS if name in missing)
            assert posture.reason == (
                f"missing_joint: the skeleton lacks the joints {named}: let the camera see the person's trunk"
            )
    assert node.counters.rejects == ({} if usable(missing) else {"missing_joint": 2})


@given(SUBSETS.filter(lambda missing: usable(missing) and not missing & (HIPS | SHOULDERS)))
def test_limbs_that_are_not_there_change_nothing_of_the_others(missing: set[str]) -> None:
    frames = reaching_frames(2)
    for partial, whole in zip(postures([lacking(f, *missing) for f in frames]), postures(frames), strict=True):
        for field in ("joints_m", "joints", "upright"):
            same_where_known(getattr(partial, field), getattr(whole, field))
        assert partial.ego_from_camera == whole.ego_from_camera


@pytest.mark.parametrize("missing", LEGS.values(), ids=LEGS.keys())
def test_legs_out_of_view_leave_the_arms(missing: set[str]) -> None:
    """Without hips the shoulders' line stands in for theirs: the axes turn a little, the posture stays."""
    frames = reaching_frames()
    partial, whole = postures([lacking(f, *missing) for f in frames])[-1], postures(frames)[-1]
    for name in RIGHT_ARM:
        for field, tolerance_m in (("joints_m", 0.07), ("joints", 0.03), ("upright", 0.005)):
            some, every = (np.array(getattr(posture, field)[INDEX[name]]) for posture in (partial, whole))
            assert np.linalg.norm(some - every) < tolerance_m
    assert partial.motion and whole.motion
    assert partial.motion[0] == pytest.approx(whole.motion[0])


def test_a_part_moves_as_its_known_joints_do_on_average() -> None:
    moved = STANDING.copy()
    moved[INDEX["right_elbow"]] += [0.0, 0.0, -0.03]
    moved[INDEX["left_hand"]] += [0.0, 0.06, 0.0]
    missing = ("right_hand", "left_foot", "left_knee", "left_hip")
    _, second = postures([lacking(STANDING, *missing), lacking(moved, *missing)])
    share = 1 - np.exp(-FRAME_NS / 1e9 / TIME_CONSTANT_S)
    assert second.motion == pytest.approx([share * 0.03 / 2, share * 0.06 / 3, 0.0, 0.0, 0.0])


def test_a_joint_that_comes_back_has_not_jumped() -> None:
    """The hand is away for longer than it follows the body, while the arm is stretched; then it counts anew."""
    away = [lacking(reaching(0.0) + 1e-9 * i, "right_hand") for i in range(BRIDGED_NS // FRAME_NS + 1)]
    first, back, after = postures([reaching(0.0), *away, reaching(1.0), reaching(1.0) + 1e-9])[-3:]
    assert first.motion and back.motion and after.motion
    share = 1 - np.exp(-FRAME_NS / 1e9 / TIME_CONSTANT_S)
    elbow_m = float(np.linalg.norm(reaching(1.0) - reaching(0.0), axis=1)[INDEX["right_elbow"]])
    assert first.motion == pytest.approx([0.0] * 5, abs=1e-12)
    assert back.motion[0] == pytest.approx(share * elbow_m / 2)
    assert after.motion[0] == pytest.approx(share * (1 - share) * elbow_m / 3, abs=1e-8)


def test_a_joint_that_flickers_moves_its_part_as_far_as_one_that_is_always_there() -> None:
    whole = reaching_frames()
    flickering = [lacking(joints, "right_hand") if i % 3 else joints for i, joints in enumerate(whole)]
    ways_m = [np.sum([posture.motion for posture in postures(frames)], axis=0) for frames in (whole, flickering)]
    assert ways_m[1] == pytest.approx(ways_m[0], rel=0.1, abs=1e-6)


def test_what_is_there_is_still_checked() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    far_knee, far_hand = lacking(STANDING, "left_foot"), lacking(STANDING, *RIGHT_ARM)
    far_knee[INDEX["left_knee"], 1] += 2.0
    far_hand[INDEX["left_hand"], 2] += 20.0
    folded = lacking(STANDING, "left_foot")
    folded[INDEX["right_hand"]] = folded[INDEX["right_elbow"]]
    made = postures([far_knee, far_hand, folded, lacking(reaching(0.5), "left_foot")], node)
    assert [posture.valid for posture in made] == [False, False, False, True]
    assert node.counters.rejects == {"absurd_bone": 1, "absurd_joint": 1, "coincident_joints": 1}


def test_the_state_names_what_was_missing_lately_and_nothing_is_rejected() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    postures([lacking(reaching(0.1), *FEET), reaching(0.2)], node)
    assert node.counters.state == "running without left_foot, right_foot"
    postures([lacking(reaching(0.3), "head")], node, first_ns=10**9)
    assert node.counters.state == "running without head, left_foot, right_foot"
    postures([reaching(0.4)], node, first_ns=25 * 10**8)
    assert node.counters.state == "running without head"
    list(node.handle(skeleton(4 * 10**9)))
    assert (node.counters.state, node.counters.rejects) == ("running", {})


def test_the_state_does_not_outlive_a_restart_of_the_source() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    list(node.handle(skeleton(10**12, lacking(STANDING, "head"))))
    list(node.handle(skeleton(0, STANDING, session_id="other")))
    assert node.counters.state == "running"
