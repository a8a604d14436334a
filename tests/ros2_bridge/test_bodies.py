"""Bodies of ROS4HRI become skeletons: who, where, when, in which frame, and what is refused."""

import gc
import math
import tracemalloc
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

import human_model
from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.bridge import Foreign
from actum.messages import MOST_AGENTS, Skeleton
from actum.node import SECOND_NS, Tick
from actum.skeletons import INDEX, JOINTS
from actum.states import State
from people import FRAME_NS, STANDING, lacking
from ros2_bodies import (
    MODEL_FRAMES,
    OPTICAL,
    frames,
    joint_states,
    one_frame,
    skeleton_2d,
    tf,
    tf_static,
    tracked,
    transform,
    urdf,
)
from ros2_bridge import topics
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.hri.human_model import FOREARM_M, LINKS, NECK_M, TORSO_M, UPPER_ARM_M
from ros2_bridge.hri_in.body_reader import LONGEST_NAME
from ros2_bridge.hri_in.transform_tree import MOST_FRAMES
from ros2_bridge.settings import Settings

FIRST_NS = 1_700_000_000 * SECOND_NS
UPRIGHT = {link.joint: 0.0 for link in LINKS if link.joint is not None}
"""The angles (rad) of a body that stands."""
BESIDE = STANDING + np.array([1, 0, 0])
"""Another person, a metre to the right."""
LEANING = STANDING - np.array([[0, 0, 0.3]]) * (STANDING[:, 1:2] < STANDING[INDEX["torso"], 1])
"""The same with head, neck, shoulders and whatever else is above the torso 0.3 m ahead."""
OURS = {name: name for name in JOINTS}
"""Names as OpenNI's trackers have them."""
HALF_TURN = math.sqrt(0.5)
UPRIGHT_IN_OPTICAL = (HALF_TURN, 0.0, 0.0, HALF_TURN)
"""A body with x to the right of the image, y away from the camera and z up."""


def bridge() -> Ros2Bridge:
    made = Ros2Bridge(Settings(sensor="head", ros_bodies=True, ros_frame_id=OPTICAL))
    made.foreign_node("5e55")
    made.handle(Tick(0))
    return made


def given_to(made: Ros2Bridge, payloads: Iterable[Foreign]) -> list[Skeleton]:
    found = [message for payload in payloads for message in made.receive(payload)]
    assert all(isinstance(message, Skeleton) for message in found)
    return found  # type: ignore[return-value]


def stamps(count: int, first_ns: int = FIRST_NS) -> list[int]:
    return [first_ns + i * FRAME_NS for i in range(count)]


def stream(made: Ros2Bridge, people: dict[str, Any], count: int = 6, first_ns: int = FIRST_NS) -> list[Skeleton]:
    return given_to(made, (each for stamp_ns in stamps(count, first_ns) for each in one_frame(stamp_ns, people)))


def joints(skeleton: Skeleton, agent: int = 0) -> Any:
    listed = skeleton.agents[agent].joints
    return np.array([[np.nan] * 3 if joint is None else joint for joint in listed])


def stamped(arrived: Iterable[list[Skeleton]]) -> list[list[int]]:
    """The stamps of what arrived with each image."""
    return [[skeleton.stamp_ns for skeleton in each] for each in arrived]


def at_once(stamps_ns: Iterable[int]) -> list[list[int]]:
    """The same where the skeleton of each image arrives with it, not later."""
    return [[stamp_ns] for stamp_ns in stamps_ns]


def told(made: Ros2Bridge, after_s: int = 2) -> str:
    """The state once what came has been reviewed, some seconds after the start."""
    made.handle(Tick(after_s * SECOND_NS))
    return made.counters.state


def test_frames_of_a_body_become_joints_in_the_cameras_frame() -> None:
    skeletons = stream(bridge(), {"ab": STANDING})
    assert [it.stamp_ns for it in skeletons] == stamps(6)
    torso = INDEX["torso"]
    for skeleton in skeletons:
        assert skeleton.sensor == "head"
        assert [agent.agent for agent in skeleton.agents] == [1]
        np.testing.assert_allclose(np.delete(joints(skeleton), torso, 0), np.delete(STANDING, torso, 0), atol=1e-9)
        middle = (STANDING[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0) + STANDING[INDEX["neck"]]) / 2
        np.testing.assert_allclose(joints(skeleton)[torso], middle, atol=1e-9)


def test_only_the_first_frame_of_a_body_waits_for_more() -> None:
    made = bridge()
    arrived = [given_to(made, one_frame(stamp_ns, {"ab": STANDING})) for stamp_ns in stamps(8)]
    assert sum(map(len, arrived)) == 8
    assert stamped(arrived[-3:]) == at_once(stamps(8)[-3:])


@pytest.mark.parametrize(
    "names",
    [
        OURS,
        {**OURS, **{f"{joint}_{side}": f"{side}_{joint}" for side in ("left", "right") for joint in ("hand", "hip")}},
        {**MODEL_FRAMES, "spine_mid": "torso"},
        {**MODEL_FRAMES, "spine_mid": "torso", "r_head": "neck", "torso": "left_shoulder"},
    ],
    ids=["openni", "kinect", "human_description", "all links of human_description"],
)
def test_joints_are_known_by_the_names_of_several_trackers(names: dict[str, str]) -> None:
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (tracked(stamp_ns, "7"), tf(*frames(stamp_ns, STANDING, "7", names)))
    ))  # fmt: skip
    np.testing.assert_allclose(joints(found[-1]), STANDING, atol=1e-9)


def test_without_a_frame_of_its_own_the_torso_is_above_the_hips_along_the_bodys_z() -> None:
    made = bridge()
    hips = STANDING[[INDEX["left_hip"], INDEX["right_hip"]]].mean(axis=0)
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", hips, UPRIGHT_IN_OPTICAL), *frames(stamp_ns, LEANING, "ab")),
        )
    ))  # fmt: skip
    half_m = np.linalg.norm(LEANING[INDEX["neck"]] - hips) / 2
    assert joints(found[-1])[INDEX["torso"]] == pytest.approx(hips - [0, half_m, 0])


def test_links_are_followed_through_the_tree_of_the_body_and_through_that_of_the_robot() -> None:
    made = bridge()
    given_to(made, [
        tf_static(transform(0, OPTICAL, (0.1, 0, 0.2), UPRIGHT_IN_OPTICAL, parent="robot_head")),
        tf_static(transform(0, "l_wrist_ab", (0, 0, -0.3), parent="l_elbow_ab")),
    ])  # fmt: skip
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (
            tf(transform(stamp_ns - 10_000_000, "robot_head", (0, 0, 1.0), parent="map")),
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", (1, 0, 1.2), parent="map")),
            tf(transform(stamp_ns, "l_elbow_ab", (0, 0, 0.5), parent="body_ab")),
        )
    ))  # fmt: skip
    # in map, the elbow is at (1, 0, 1.7), the wrist at (1, 0, 1.4), and the camera at (0.1, 0, 1.2) with its axes along
    # x, z and -y
    assert joints(found[-1])[INDEX["left_elbow"]] == pytest.approx([0.9, 0.5, 0.0], abs=1e-9)
    assert joints(found[-1])[INDEX["left_hand"]] == pytest.approx([0.9, 0.2, 0.0], abs=1e-9)


def test_up_is_the_z_axis_of_the_root_of_the_robots_tree() -> None:
    made = bridge()
    given_to(made, [tf_static(transform(0, OPTICAL, (0, 0, 1), UPRIGHT_IN_OPTICAL, parent="base_link"))])
    assert stream(made, {"ab": STANDING})[-1].up_in_camera == pytest.approx([0, 1, 0], abs=1e-9)


def test_the_cameras_frame_is_the_same_with_a_slash_before_it() -> None:
    made = Ros2Bridge(Settings(sensor="head", ros_bodies=True, ros_frame_id=f"/{OPTICAL}"))
    made.foreign_node("5e55")
    assert len(stream(made, {"ab": STANDING})) == 6


def test_a_camera_without_a_robot_is_taken_for_level() -> None:
    assert stream(bridge(), {"ab": STANDING})[-1].up_in_camera is None


def test_joint_states_become_joints_by_the_human_model() -> None:
    made = bridge()
    pose = {**UPRIGHT, "r_elbow": math.pi / 2}
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", (0.5, 0.2, 2.0), UPRIGHT_IN_OPTICAL)),
            joint_states(stamp_ns, "ab", pose),
        )
    ))  # fmt: skip
    seen = joints(found[-1]) - [0.5, 0.2, 2.0]
    assert not np.isnan(seen).any()
    assert seen[INDEX["neck"]] == pytest.approx([0, -TORSO_M - NECK_M, 0])
    assert seen[INDEX["torso"]] == pytest.approx([0, -(TORSO_M + NECK_M) / 2, 0])
    assert np.linalg.norm(seen[INDEX["right_elbow"]] - seen[INDEX["right_shoulder"]]) == pytest.approx(UPPER_ARM_M)
    assert seen[INDEX["right_hand"]] - seen[INDEX["right_elbow"]] == pytest.approx([FOREARM_M, 0, 0])


@pytest.mark.parametrize("is_tracked", [False, True], ids=["before its body", "after its body"])
def test_a_bodys_urdf_gives_the_lengths_of_its_bones(is_tracked: bool) -> None:
    made = bridge()
    if is_tracked:
        given_to(made, [tracked(FIRST_NS, "ab")])
    given_to(made, [urdf("ab", human_model.urdf("ab", unit_m=0.2)), urdf("cd", human_model.urdf("cd", unit_m=0.3))])
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", (0.5, 0.2, 2.0), UPRIGHT_IN_OPTICAL)),
            joint_states(stamp_ns, "ab", UPRIGHT),
        )
    ))  # fmt: skip
    seen = joints(found[-1])
    assert np.linalg.norm(seen[INDEX["right_hand"]] - seen[INDEX["right_elbow"]]) == pytest.approx(0.2)
    assert np.linalg.norm(seen[INDEX["left_hip"]] - seen[INDEX["right_hip"]]) == pytest.approx(0.24)


def test_models_of_bodies_that_never_come_are_forgotten() -> None:
    made = bridge()
    text = human_model.urdf("", unit_m=0.2)
    flood = [urdf(f"b{i}", text.replace('_"', f'_b{i}"')) for i in range(3 * MOST_AGENTS)]
    given_to(made, flood[:MOST_AGENTS])
    gc.collect()
    tracemalloc.start()
    given_to(made, flood[MOST_AGENTS:])
    gc.collect()
    kept_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert made.counters.rejects == {}
    assert kept_bytes < MOST_AGENTS * 50_000


def test_the_model_of_a_body_that_is_there_is_kept_however_many_others_have_come_since() -> None:
    made = bridge()
    given_to(made, [urdf("ab", human_model.urdf("ab", unit_m=0.3))])
    text = human_model.urdf("", unit_m=0.2)
    for i in range(MOST_AGENTS):
        given_to(made, [tracked(FIRST_NS, "ab", f"b{i}"), urdf(f"b{i}", text.replace('_"', f'_b{i}"'))])
    given_to(made, [tracked(FIRST_NS)])
    found = given_to(made, (
        each for stamp_ns in stamps(5, FIRST_NS + SECOND_NS)
        for each in (
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", (0, 0, 2.0), UPRIGHT_IN_OPTICAL)),
            joint_states(stamp_ns, "ab", UPRIGHT),
        )
    ))  # fmt: skip
    seen = joints(found[-1])
    assert np.linalg.norm(seen[INDEX["right_hand"]] - seen[INDEX["right_elbow"]]) == pytest.approx(0.3)


def test_frames_count_more_than_joint_states() -> None:
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(6)
        for each in (
            tracked(stamp_ns, "ab"),
            tf(transform(stamp_ns, "body_ab", (0, 0, 2.0), UPRIGHT_IN_OPTICAL)),
            joint_states(stamp_ns, "ab", UPRIGHT),
            tf(*frames(stamp_ns, STANDING, "ab")),
        )
    ))  # fmt: skip
    for skeleton in found:
        np.testing.assert_allclose(joints(skeleton)[INDEX["neck"]], STANDING[INDEX["neck"]], atol=1e-9)


@pytest.mark.parametrize("ids", [("ab", "cd"), ("1", "0_1")], ids=["different", "one ends in the other"])
def test_everybody_who_is_tracked_stands_in_one_skeleton_though_they_come_apart(ids: tuple[str, str]) -> None:
    there = dict(zip(ids, (STANDING, BESIDE), strict=True))
    found = given_to(bridge(), (
        each for stamp_ns in stamps(8)
        for each in (
            tracked(stamp_ns, *there),
            *(tf(*frames(stamp_ns, body, body_id)) for body_id, body in there.items()),
        )
    ))  # fmt: skip
    assert [[agent.agent for agent in skeleton.agents] for skeleton in found] == [[1, 2]] * 8


def test_numbers_of_people_are_never_used_again_and_a_body_that_comes_back_has_its_own() -> None:
    made = bridge()
    numbers = []
    for i, body_id in enumerate(["ab", "cd", "ab", "ef"]):
        found = stream(made, {body_id: STANDING}, first_ns=FIRST_NS + i * SECOND_NS)
        numbers.append({agent.agent for skeleton in found for agent in skeleton.agents})
    assert numbers[:3] == [{1}, {2}, {1}]
    assert numbers[3] == {3}


def test_who_has_left_is_in_no_skeleton_and_that_nobody_is_there_is_one() -> None:
    made = bridge()
    stream(made, {"ab": STANDING})
    [*_, last] = given_to(made, [tracked(FIRST_NS + SECOND_NS, *())])
    assert last.stamp_ns == FIRST_NS + SECOND_NS
    assert last.agents == []


def test_a_joint_that_is_not_seen_is_null_and_does_not_hold_the_others_up_for_long() -> None:
    made = bridge()
    stream(made, {"ab": STANDING})
    arrived = [
        given_to(made, one_frame(stamp_ns, {"ab": lacking(STANDING, "left_hand")}))
        for stamp_ns in stamps(8, FIRST_NS + SECOND_NS)
    ]
    assert sum(map(len, arrived)) == 8
    assert stamped(arrived[-3:]) == at_once(stamps(8, FIRST_NS + SECOND_NS)[-3:])
    agent = arrived[-1][0].agents[0]
    assert agent.joints[INDEX["left_hand"]] is None
    assert agent.confidence[INDEX["left_hand"]] == 0
    assert agent.joints[INDEX["left_elbow"]] is not None


def test_whoever_is_a_little_late_is_waited_for() -> None:
    made = bridge()
    there = {"ab": STANDING, "slow": BESIDE}
    found: list[Skeleton] = []
    for i, (before_ns, stamp_ns) in enumerate(zip([FIRST_NS - FRAME_NS, *stamps(30)], stamps(30), strict=False)):
        found += given_to(made, [tracked(stamp_ns, *there), tf(*frames(stamp_ns, STANDING, "ab"))])
        if i > 10:
            found += given_to(made, [tf(*frames(before_ns, there["slow"], "slow"))])
    assert {len(skeleton.agents) for skeleton in found[:10]} == {1}
    assert {len(skeleton.agents) for skeleton in found[-10:]} == {2}


@pytest.mark.parametrize(
    "newer",
    [
        lambda stamp_ns: tracked(stamp_ns, "1"),
        lambda stamp_ns: tf(transform(stamp_ns, "wheel_1", (0, 0, 0), parent="base_link")),
    ],
    ids=["list", "frame of the robot"],
)
def test_joints_are_used_though_lists_and_frames_of_the_robot_are_far_newer(newer: Callable[[int], Foreign]) -> None:
    """A slow detector, such as hri_fullbody, may depend on the list of a fast one."""
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(30)
        for each in (
            tracked(stamp_ns, "1"), newer(stamp_ns + 200_000_000), newer(stamp_ns + 210_000_000),
            tf(*frames(stamp_ns, STANDING, "1")),
        )
    ))  # fmt: skip
    assert [it.stamp_ns for it in found] == stamps(30)


def test_bodies_are_known_also_by_lists_without_a_stamp_which_libhri_does_not_read() -> None:
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(10) for each in (tracked(0, "ab"), tf(*frames(stamp_ns, STANDING, "ab")))
    ))  # fmt: skip
    assert [it.stamp_ns for it in found] == stamps(10)
    assert given_to(made, [tracked(0), tf(*frames(stamps(11)[-1], STANDING, "ab"))]) == []


def test_a_body_that_has_points_in_the_image_alone_gives_no_skeleton_and_the_state_says_what_to_do() -> None:
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(10) for each in (tracked(stamp_ns, "ab"), skeleton_2d(stamp_ns, "ab"))
    ))  # fmt: skip
    assert found == []
    assert "the bodies ab have only points in the image (skeleton2d) and no depth" in told(made)
    assert "use a depth camera and publish joint_states" in made.counters.state


def test_a_body_without_depth_does_not_hold_others_up() -> None:
    made = bridge()
    arrived = [
        given_to(made, [
            tracked(stamp_ns, "ab", "flat"), tf(*frames(stamp_ns, STANDING, "ab")), skeleton_2d(stamp_ns, "flat"),
        ])
        for stamp_ns in stamps(10)
    ]  # fmt: skip
    assert stamped(arrived[-3:]) == at_once(stamps(10)[-3:])
    assert "the bodies flat have only points" in told(made)


def test_the_state_says_that_nobody_tracks_bodies() -> None:
    made = bridge()
    assert "nobody publishes /humans/bodies/tracked" in told(made)
    stream(made, {"ab": STANDING})
    assert told(made, 4) == State.RUNNING


def test_the_state_says_that_no_transforms_lead_to_the_camera() -> None:
    made = bridge()
    given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (tracked(stamp_ns, "ab"), tf(transform(stamp_ns, "head_ab", (0, 0, 1), parent="elsewhere")))
    ))  # fmt: skip
    assert f"no transforms lead from the joints of the bodies ab to the frame {OPTICAL}" in told(made)


def test_the_state_says_that_a_detector_has_gone_silent() -> None:
    made = bridge()
    stream(made, {"ab": STANDING})
    assert told(made, 2) == State.RUNNING
    assert "nothing is published any more about the bodies ab" in told(made, 4)


def test_a_recording_that_is_played_again_is_a_new_run_in_which_numbers_go_on() -> None:
    made = bridge()
    first = stream(made, {"ab": STANDING}, first_ns=FIRST_NS + 100 * SECOND_NS)
    again = stream(made, {"cd": STANDING}, count=12)
    assert {it.session_id for it in first} == {"ros2-5e55.0"}
    assert {it.session_id for it in again} == {"ros2-5e55.1"}
    assert {agent.agent for it in again for agent in it.agents} == {2}


def test_a_short_recording_that_is_played_in_a_loop_gives_skeletons_each_time() -> None:
    made = bridge()
    runs = [stream(made, {"ab": STANDING}, count=90) for _ in range(3)]
    assert [len(run) >= 85 for run in runs] == [True] * 3
    assert [run[-1].session_id for run in runs] == ["ros2-5e55.0", "ros2-5e55.1", "ros2-5e55.2"]


def test_one_stamp_of_the_future_does_not_end_the_stream() -> None:
    made = bridge()
    stream(made, {"ab": STANDING})
    given_to(made, [tf(*frames(FIRST_NS + 10**17, STANDING, "ab"))])
    assert len(stream(made, {"ab": STANDING}, count=20, first_ns=FIRST_NS + SECOND_NS)) >= 15


@pytest.mark.parametrize(
    ("payload", "kind"),
    [
        (Foreign(topics.OTHERS_TF.name, b"\x00\x01garbage", ""), "bad_body_message"),
        (Foreign(topics.OTHERS_TRACKED.name, b"", ""), "bad_body_message"),
        (Foreign(topics.OTHERS_TF.name, b"\x00\x01\x00\x00" + bytes(300_000), ""), "bad_body_message"),
        (tf(transform(FIRST_NS, "head_ab", (math.nan, 0, 0))), "bad_transform"),
        (tf(transform(FIRST_NS, "head_ab", (0, 0, 0), (0, 0, 0, 0))), "bad_transform"),
        (tf(transform(FIRST_NS, "f" * (LONGEST_NAME + 1), (0, 0, 0))), "bad_transform"),
        (tf_static(transform(0, "f", (0, 0, 0), parent="p" * (LONGEST_NAME + 1))), "bad_transform"),
        (tf(transform(0, "head_ab", (0, 0, 0))), "bad_body_stamp"),
        (tracked(0, "ab"), "bad_body_stamp"),
        (tracked(FIRST_NS, "a/b"), "bad_body_id"),
        (urdf("ab", "<robot"), "bad_body_description"),
        (tracked(FIRST_NS, "a" * 65), "bad_body_id"),
        (tracked(FIRST_NS, *(f"b{i}" for i in range(MOST_AGENTS + 1))), "too_many_bodies"),
    ],
    ids=lambda each: each if isinstance(each, str) else "",
)
def test_what_cannot_be_used_is_counted_by_its_kind(payload: Foreign, kind: str) -> None:
    made = bridge()
    given_to(made, [payload])
    assert made.counters.rejects == {kind: 1}
    assert made.counters.last_error is not None


def test_transforms_in_a_circle_lead_nowhere() -> None:
    made = bridge()
    found = given_to(made, (
        each for stamp_ns in stamps(5)
        for each in (tracked(stamp_ns, "ab"), tf(
            transform(stamp_ns, "head_ab", (0, 0, 1), parent="neck_ab"),
            transform(stamp_ns, "neck_ab", (0, 0, 1), parent="head_ab"),
        ))
    ))  # fmt: skip
    assert found == []


def test_names_that_are_no_joints_of_the_model_are_not_kept() -> None:
    made = bridge()
    given_to(made, [tracked(FIRST_NS, *(f"b{i}" for i in range(MOST_AGENTS)))])
    names = {f"j{i}": 0.0 for i in range(4000)}
    payloads = [joint_states(stamp_ns, "b0", names) for stamp_ns in stamps(3)]
    gc.collect()
    tracemalloc.start()
    given_to(made, payloads)
    gc.collect()
    kept_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept_bytes < 100_000


def test_frames_without_end_are_forgotten_and_the_way_to_the_camera_is_not() -> None:
    made = bridge()
    given_to(made, [tf_static(transform(0, OPTICAL, (0, 0, 1), parent="robot"))])
    for i in range(2 * MOST_FRAMES // 500 + 1):
        flood = [transform(0, f"f{i}_{k}", (0, 0, 0), parent="robot") for k in range(500)]
        given_to(made, [tf_static(*flood)])
        found = stream(made, {"ab": STANDING}, first_ns=FIRST_NS + i * SECOND_NS)
    assert found[-1].up_in_camera == pytest.approx([0, 0, 1]), "the root is still the robot"


@given(st.lists(st.tuples(st.sampled_from(topics.SUBSCRIBED[1:]), st.binary(max_size=200)), max_size=10))
def test_no_payload_ends_the_bridge(payloads: list[tuple[topics.RosTopic, bytes]]) -> None:
    made = bridge()
    for topic, payload in payloads:
        made.receive(Foreign(topic.name, b"\x00\x01\x00\x00" + payload, "0/humans/bodies/ab/x/type/hash"))


def test_bodies_are_subscribed_to_only_if_they_are_wanted() -> None:
    def keys_of(settings: Settings) -> list[str]:
        return [
            topic.key.split("::")[0].rpartition("/")[0]
            for topic in Ros2Bridge(settings).foreign_node("5e55").subscribes
        ]

    assert keys_of(Settings()) == ["0/actum/kinect0/mark"]
    assert keys_of(Settings(ros_bodies=True, ros_frame_id=OPTICAL, ros_topics="event")) == [
        "0/humans/bodies/tracked", "0/tf", "0/tf_static", "0/humans/bodies/*/joint_states",
        "0/humans/bodies/*/skeleton2d", "0/humans/bodies/*/urdf",
    ]  # fmt: skip


def test_bodies_need_the_name_of_the_cameras_frame() -> None:
    with pytest.raises(
        ValidationError, match="--ros-bodies needs --ros-frame-id: set --ros-frame-id to the optical frame"
    ):
        Settings(ros_bodies=True)
