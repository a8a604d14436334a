from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from benchmarks.recognition.changes import (
    Change,
    Changed,
    childlike,
    dropped,
    mirrored,
    pitched,
    resampled,
    seated,
    turned,
)

from actum import keys
from actum.messages import Agent, Message, Segment, Skeleton
from actum.recorder import Recorder
from actum.recording import Recording
from actum.skeletons import INDEX, JOINTS
from actum.standard_body import BONES

pytestmark = pytest.mark.thorough

FRAMES, SECOND_NS = 9, 1_000_000_000
STANDING_M = {
    "head": (0.0, -0.7, 3.0),
    "neck": (0.0, -0.5, 3.0),
    "torso": (0.0, -0.2, 3.0),
    "left_shoulder": (0.2, -0.5, 3.0),
    "left_elbow": (0.3, -0.25, 3.0),
    "left_hand": (0.3, 0.0, 2.9),
    "right_shoulder": (-0.2, -0.5, 3.0),
    "right_elbow": (-0.3, -0.25, 3.0),
    "right_hand": (-0.5, -0.5, 3.0),
    "left_hip": (0.1, 0.0, 3.0),
    "left_knee": (0.1, 0.45, 3.0),
    "left_foot": (0.1, 0.85, 3.0),
    "right_hip": (-0.1, 0.0, 3.0),
    "right_knee": (-0.1, 0.45, 3.0),
    "right_foot": (-0.1, 0.85, 3.0),
}
"""Somebody who faces the camera: x to the actor's left, y down, z away from it."""


@pytest.fixture
def standing_m() -> np.ndarray:
    """Nine frames in which the right hand rises by 1 cm each."""
    joints_m = np.array([[STANDING_M[name] for name in JOINTS]] * FRAMES)
    joints_m[:, INDEX["right_hand"], 1] -= 0.01 * np.arange(FRAMES)
    return joints_m


@pytest.fixture
def recording(tmp_path: Path, standing_m: np.ndarray) -> Recording:
    """The nine frames at 0.1 s, from 5 s on, all of them one segment."""
    with Recorder(tmp_path / "raise.mcap", person="1", source="test") as recorder:
        for i, frame_m in enumerate(standing_m):
            agent = Agent(agent=1, joints=frame_m.tolist(), confidence=[1.0] * 15)
            recorder.write(Skeleton(stamp_ns=5 * SECOND_NS + i * SECOND_NS // 10, sensor="kinect0", agents=[agent]))
        for kind, at_ns, label in (("start", 5 * SECOND_NS, "raise"), ("end", 58 * SECOND_NS // 10, None)):
            mark = Segment(stamp_ns=at_ns, sensor="kinect0", kind=kind, segment_id="1", label=label)
            recorder.write(mark)
    return Recording(tmp_path / "raise.mcap")


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def places(joints_m: np.ndarray, name: str) -> np.ndarray:
    return joints_m[:, INDEX[name]]


def bones_m(joints_m: np.ndarray) -> np.ndarray:
    ends = np.array([(parent, child) for parent, child, _ in BONES])
    return np.linalg.norm(joints_m[:, ends[:, 1]] - joints_m[:, ends[:, 0]], axis=2)


def test_a_quarter_turn_to_the_right_shows_the_left_side(standing_m: np.ndarray) -> None:
    seen_m = turned(90)(standing_m, rng())
    np.testing.assert_allclose(places(seen_m, "left_hip"), [[0.0, 0.0, 2.9]] * FRAMES, atol=1e-12)
    np.testing.assert_allclose(places(seen_m, "left_hand")[0], [-0.1, 0.0, 2.7], atol=1e-12)
    np.testing.assert_allclose(places(seen_m, "torso"), places(standing_m, "torso"), atol=1e-12)


def test_turns_undo_each_other(standing_m: np.ndarray) -> None:
    there = turned(60)(standing_m, rng())
    np.testing.assert_allclose(turned(-60)(there, rng()), standing_m, atol=1e-12)


def test_what_lies_straight_ahead_rises_before_a_camera_that_looks_down() -> None:
    ahead_m = np.full((1, 15, 3), (0.0, 0.0, 2.0))
    expected = [0.0, -2 * np.sin(np.radians(20)), 2 * np.cos(np.radians(20))]
    np.testing.assert_allclose(pitched(20)(ahead_m, rng())[0, 0], expected, atol=1e-12)


def test_in_a_mirror_the_other_hand_rises(standing_m: np.ndarray) -> None:
    image_m = mirrored(standing_m, rng())
    np.testing.assert_allclose(places(image_m, "left_hand"), places(standing_m, "right_hand") * [-1, 1, 1])
    np.testing.assert_allclose(places(image_m, "head"), places(standing_m, "head"))
    np.testing.assert_allclose(mirrored(image_m, rng()), standing_m)


def test_who_is_seated_has_the_knees_before_the_hips_and_the_feet_on_the_floor(standing_m: np.ndarray) -> None:
    sitting_m = seated(standing_m, rng())
    np.testing.assert_allclose(places(sitting_m, "left_hip"), [[0.1, 0.45, 3.0]] * FRAMES)
    np.testing.assert_allclose(places(sitting_m, "left_knee"), [[0.1, 0.45, 2.55]] * FRAMES)
    np.testing.assert_allclose(places(sitting_m, "left_foot"), [[0.1, 0.85, 2.55]] * FRAMES)
    lowered_m = np.array([0.0, 0.45, 0.0])
    np.testing.assert_allclose(places(sitting_m, "right_hand"), places(standing_m, "right_hand") + lowered_m)
    np.testing.assert_allclose(bones_m(sitting_m), bones_m(standing_m))


def test_who_is_seated_faces_where_they_faced(standing_m: np.ndarray) -> None:
    turned_m = turned(90)(standing_m, rng())
    np.testing.assert_allclose(seated(turned_m, rng()), turned(90)(seated(standing_m, rng()), rng()), atol=1e-12)


def test_a_child_has_shorter_bones_and_stands_on_the_same_floor(standing_m: np.ndarray) -> None:
    child_m = childlike(standing_m, rng())
    shares = dict(
        zip((JOINTS[child] for _, child, _ in BONES), (bones_m(child_m) / bones_m(standing_m))[0], strict=True)
    )
    expected = {"head": 0.85, "left_hand": 0.6, "right_elbow": 0.6, "left_knee": 0.55, "right_foot": 0.55, "neck": 0.65}
    assert {name: shares[name] for name in expected} == pytest.approx(expected)
    np.testing.assert_allclose(places(child_m, "left_foot")[:, 1], 0.85)


def test_so_many_joints_are_dropped_whole() -> None:
    seen_m = dropped(0.3)(np.zeros((2000, 15, 3)), rng())
    missing = np.isnan(seen_m)
    assert (missing.all(axis=2) == missing.any(axis=2)).all()
    assert missing.mean() == pytest.approx(0.3, abs=0.01)


def test_frames_between_lie_between() -> None:
    stamps_ns = np.array([0, SECOND_NS // 10, 2 * SECOND_NS // 10])
    joints_m = np.array([0.0, 1.0, 4.0])[:, None, None] * np.ones((3, 15, 3))
    at_ns, seen_m = resampled(stamps_ns, joints_m, 20)
    assert at_ns.tolist() == [0, 50_000_000, 100_000_000, 150_000_000, 200_000_000]
    np.testing.assert_allclose(seen_m[:, 0, 0], [0.0, 0.5, 1.0, 2.5, 4.0])


def test_nothing_is_made_up_in_a_long_gap() -> None:
    stamps_ns = np.array([0, SECOND_NS // 10, 2 * SECOND_NS, 21 * SECOND_NS // 10])
    at_ns, _ = resampled(stamps_ns, np.zeros((4, 15, 3)), 10)
    assert at_ns.tolist() == stamps_ns.tolist()


def skeletons(recording: Recording) -> list[Skeleton]:
    return [message for message in recording.messages() if isinstance(message, Skeleton)]


def test_without_a_change_a_recording_is_as_it_was(recording: Recording) -> None:
    def told(message: Message) -> Message:
        return message.model_copy(update={"seq": None})

    streams = (keys.SKELETON, keys.SEGMENT)
    assert [told(m) for m in Changed(recording, Change()).messages(streams)] == [
        told(m) for m in recording.messages(streams)
    ]


@pytest.mark.parametrize(
    ("pace", "frames", "last_ns"), [(0.5, 17, 66 * SECOND_NS // 10), (2.0, 5, 54 * SECOND_NS // 10)]
)
def test_pace_stretches_frames_and_marks_alike(recording: Recording, pace: float, frames: int, last_ns: int) -> None:
    messages = list(Changed(recording, Change(pace=pace, frames_per_second=10)).messages())
    assert isinstance(messages[0], Segment)
    assert isinstance(messages[-1], Segment)
    assert (messages[0].stamp_ns, messages[-1].stamp_ns) == (5 * SECOND_NS, last_ns)
    seen = [message for message in messages if isinstance(message, Skeleton)]
    assert len(seen) == frames
    assert {b.stamp_ns - a.stamp_ns for a, b in pairwise(seen)} == {SECOND_NS // 10}
    assert seen[-1].agents[0].joints == skeletons(recording)[-1].agents[0].joints


def test_dropped_joints_are_missing_and_always_the_same(recording: Recording) -> None:
    change = Change(dropped(0.5))
    seen = [frame.agents[0].joints for frame in skeletons(Changed(recording, change))]
    assert 0 < sum(joint is None for joints in seen for joint in joints) < FRAMES * len(JOINTS)
    assert seen == [frame.agents[0].joints for frame in skeletons(Changed(recording, change))]
