import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum import geometry
from actum.messages import Posture, Skeleton
from actum.skeletons import INDEX, PARTS
from people import FRAME_NS, STANDING, reaches, reaching, skeleton
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.part_motion import TIME_CONSTANT_S
from pose_preprocessor.settings import Settings as PoseSettings


def postures(*frames: Skeleton, node: PosePreprocessor | None = None) -> list[Posture]:
    node = node or PosePreprocessor(PoseSettings.defaults())
    return [posture for frame in frames for posture in node.handle(frame) if isinstance(posture, Posture)]


def test_a_posture_holds_the_measured_and_the_scaled_joints_and_how_to_get_back() -> None:
    [posture] = postures(skeleton(5, STANDING))
    assert (posture.stamp_ns, posture.agent, posture.valid, posture.agents) == (5, 1, True, [1])
    assert posture.ego_from_camera and posture.joints_m and posture.joints
    back = geometry.apply(geometry.invert(geometry.from_flat(posture.ego_from_camera)), np.array(posture.joints_m))
    np.testing.assert_allclose(back, STANDING, atol=1e-12)
    upper_arm = np.array(posture.joints[INDEX["left_elbow"]]) - np.array(posture.joints[INDEX["left_shoulder"]])
    assert np.linalg.norm(upper_arm) == pytest.approx(0.28)


def test_motion_is_each_parts_low_passed_displacement_in_metres() -> None:
    moved = reaching(0.1)
    first, second = postures(skeleton(0, STANDING), skeleton(FRAME_NS, moved))
    assert first.motion == [0.0] * 5
    arm = list(PARTS["right_arm"])
    share = 1 - np.exp(-FRAME_NS / 1e9 / TIME_CONSTANT_S)
    expected = share * np.linalg.norm(moved[arm] - STANDING[arm], axis=1).mean()
    assert second.motion == pytest.approx([expected, 0, 0, 0, 0], abs=1e-9)


def test_motion_adds_up_to_the_way_a_part_has_gone() -> None:
    phases = np.minimum(np.linspace(0, 2, 90), 1)
    made = postures(*[skeleton(i * FRAME_NS, reaching(p) + 1e-9 * i) for i, p in enumerate(phases)])
    way = np.linalg.norm(reaching(1.0) - STANDING, axis=1)[list(PARTS["right_arm"])].mean()
    assert sum(posture.motion[0] for posture in made if posture.motion) == pytest.approx(way, rel=0.02)


def test_walking_is_no_motion_of_a_part() -> None:
    walked = STANDING + np.array([0.3, 0.0, -0.2])
    _, second = postures(skeleton(0, STANDING), skeleton(FRAME_NS, walked))
    assert second.motion == pytest.approx([0.0] * 5, abs=1e-12)


@given(st.integers(0, 100))
def test_noise_does_not_pass_for_movement(seed: int) -> None:
    rng = np.random.default_rng(seed)
    noise_m = np.where(np.isin(np.arange(15), [11, 14]), 0.03, 0.01)[:, None]
    frames = [
        skeleton(i * FRAME_NS, reaching(min(i / 25, 1.0)) + noise_m * rng.standard_normal((15, 3))) for i in range(60)
    ]
    motion = np.sum([posture.motion for posture in postures(*frames)], axis=0)
    assert int(np.argmax(motion)) == list(PARTS).index("right_arm")


def test_motion_starts_anew_after_a_gap_and_after_a_restart() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    late = skeleton(2_000_000_000, reaching(0.5))
    restarted = skeleton(2_000_000_000 + FRAME_NS, reaching(0.9), session_id="other")
    _, after_gap, after_restart = postures(skeleton(0, STANDING), late, restarted, node=node)
    assert after_gap.motion == after_restart.motion == [0.0] * 5


def test_each_posture_names_the_frame_before_it_and_the_first_one_of_a_source_none() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    frames = [skeleton(stamp_ns, reaching(stamp_ns / 10)) for stamp_ns in (7, 9)]
    restarted = [skeleton(stamp_ns, reaching(stamp_ns / 10), session_id="other") for stamp_ns in (5, 6)]
    found = postures(*frames, *restarted, node=node)
    assert [posture.previous_ns for posture in found] == [None, 7, None, 5]


def test_a_tracker_that_repeats_itself_has_lost_the_person() -> None:
    node = PosePreprocessor(PoseSettings.defaults())
    first, again, moved = postures(
        skeleton(0, STANDING), skeleton(FRAME_NS, STANDING), skeleton(2 * FRAME_NS, reaching(0.1)), node=node
    )
    assert (first.valid, again.valid, moved.valid) == (True, False, True)
    assert node.counters.rejects["repeated_joints"] == 1


def test_nobody_there_still_lets_time_pass() -> None:
    [posture] = postures(skeleton(7))
    assert (posture.agent, posture.valid, posture.reason) == (0, False, "no person")


def test_every_agent_has_a_posture_that_names_all_of_the_frame() -> None:
    two = postures(skeleton(7, STANDING, STANDING + np.array([1.0, 0.0, 0.5])))
    assert [(posture.agent, posture.agents) for posture in two] == [(1, [1, 2]), (2, [1, 2])]


@pytest.mark.parametrize("std_m", [0.15, None])
def test_a_posture_has_the_depth_uncertainty_of_its_skeleton(std_m: float | None) -> None:
    frame = skeleton(5, STANDING)
    agents = [frame.agents[0].model_copy(update={"depth_std_m": std_m})]
    [posture] = postures(frame.model_copy(update={"agents": agents}))
    assert posture.depth_std_m == std_m


def test_lost_frames_are_handed_on() -> None:
    frames = [frame for frame in reaches(10) if frame.seq not in (3, 4)]
    missed = {posture.stamp_ns // FRAME_NS: posture.missed for posture in postures(*frames)}
    assert missed[5] == 2
    assert sum(missed.values()) == 2


@given(st.floats(-np.pi, np.pi), st.floats(0.7, 1.3), st.floats(-1.5, 1.5), st.floats(0.5, 2.0))
def test_position_heading_and_size_of_the_actor_leave_the_scaled_joints_alone(
    heading: float, size: float, right_m: float, away_m: float
) -> None:
    c, s = np.cos(heading), np.sin(heading)
    middle = STANDING.mean(axis=0)
    turned = (reaching(0.6) - middle) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T
    elsewhere = middle + size * turned + [right_m, 0, away_m]
    here, there = postures(skeleton(0, reaching(0.6)), skeleton(1, elsewhere))
    np.testing.assert_allclose(np.array(there.joints), np.array(here.joints), atol=1e-9)
    np.testing.assert_allclose(np.array(there.joints_m), size * np.array(here.joints_m), atol=1e-9)
