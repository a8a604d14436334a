"""Skeletons that one bridge publishes as ROS4HRI's bodies, and another reads, are what they were."""

from collections.abc import Iterator

import numpy as np
import pytest

from conftest import NEEDS_ROS2_EXTRA

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from actum.bridge import Foreign
from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.standard_body import BONES
from people import FRAME_NS, STANDING, lacking, reaching, skeleton, turned
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings, TopicName

FRAME = "camera_optical_frame"
LIMBS = [
    *((parent, child) for parent, child, _ in BONES if not {INDEX["torso"], INDEX["neck"]} & {parent, child}),
    (INDEX["neck"], INDEX["head"]),
]
"""Arms, legs and head: the bones that the human model's angles turn."""
STRAIGHT = np.sin(np.radians(10))
"""A knee that is bent by less is published as straight."""
LEANING = STANDING + np.array(
    [[0, 0, -0.15 * (0.18 + 0.08 - y) / 0.8] if y < 0.08 else [0, 0, 0] for _, y, _ in STANDING]
)
"""A person whose trunk is bent towards the camera."""


SHRUGGING = STANDING + np.array([[0.1, 0, 0]]) * (STANDING[:, 1:2] < 0)
SHRUGGING[INDEX["left_shoulder"]] += [0.02, -0.06, -0.03]


def there_and_back(joints: np.ndarray, *chosen: TopicName, described: bool = True) -> np.ndarray:
    """The joints that come back last of a person who stands still, with the body's URDF or without."""
    read = ("/tf", "/tracked", "/joint_states", *(["/urdf"] if described else []))
    out = Ros2Bridge(Settings(ros_frame_id=FRAME, ros_topics=frozenset(chosen)))
    back = Ros2Bridge(Settings(ros_frame_id=FRAME, ros_bodies=True))
    out.foreign_node("out")
    back.foreign_node("back")

    def came() -> Iterator[Skeleton]:
        for i in range(8):
            for put in out.handle(skeleton(SECOND_NS + i * FRAME_NS, joints)):
                if isinstance(put, Foreign) and put.topic.endswith(read):
                    yield from back.receive(received(put))  # type: ignore[misc]

    *_, last = came()
    [agent] = last.agents
    return np.array([[np.nan] * 3 if joint is None else joint for joint in agent.joints])


def by_angles(joints: np.ndarray) -> np.ndarray:
    """The joints that come back by the angles of human_description's joints alone."""
    return there_and_back(joints, "tf", "bodies", described=False)


def received(put: Foreign) -> Foreign:
    leaf = put.topic.rpartition("/")[2]
    name = f"/humans/bodies/*/{leaf}" if leaf in ("joint_states", "urdf") else put.topic
    return Foreign(name, put.payload, f"0{put.topic}/type/hash")


def directions(joints: np.ndarray) -> np.ndarray:
    bones = np.array([joints[child] - joints[parent] for parent, child in LIMBS])
    return bones / np.linalg.norm(bones, axis=1, keepdims=True)


PEOPLE = {
    "standing": STANDING,
    "reaching": reaching(1.0),
    "turned away": turned(STANDING, 2.5),
    "a child": reaching(0.5, 0.7),
    "leaning": LEANING,
    "shrugging and leaning aside": SHRUGGING,
}


@pytest.mark.parametrize("joints", PEOPLE.values(), ids=PEOPLE)
def test_by_frames_every_joint_is_where_it_was(joints: np.ndarray) -> None:
    np.testing.assert_allclose(there_and_back(joints, "tf", "bodies", "body_links"), joints, atol=1e-6)


@pytest.mark.parametrize("joints", PEOPLE.values(), ids=PEOPLE)
def test_by_joint_states_and_the_urdf_every_joint_is_where_it_was(joints: np.ndarray) -> None:
    np.testing.assert_allclose(there_and_back(joints, "tf", "bodies"), joints, atol=1e-6)


@pytest.mark.parametrize("joints", PEOPLE.values(), ids=PEOPLE)
def test_by_angles_alone_every_limb_points_where_it_did(joints: np.ndarray) -> None:
    off = np.abs(directions(by_angles(joints)) - directions(joints)).max(axis=1)
    shanks = [child in (INDEX["left_foot"], INDEX["right_foot"]) for _, child in LIMBS]
    assert (off < np.where(shanks, STRAIGHT, 1e-6)).all(), off


def test_by_angles_a_straight_arm_keeps_its_hand() -> None:
    straight = STANDING.copy()
    shoulder, elbow = straight[INDEX["left_shoulder"]], straight[INDEX["left_elbow"]]
    straight[INDEX["left_hand"]] = elbow + (elbow - shoulder)
    np.testing.assert_allclose(directions(by_angles(straight))[:2], directions(straight)[:2], atol=1e-6)


def test_by_angles_a_trunk_that_is_bent_stays_so() -> None:
    def trunk(joints: np.ndarray) -> np.ndarray:
        hips = (joints[INDEX["left_hip"]] + joints[INDEX["right_hip"]]) / 2
        along = joints[INDEX["neck"]] - hips
        return np.asarray(along / np.linalg.norm(along))

    np.testing.assert_allclose(trunk(by_angles(LEANING)), trunk(LEANING), atol=0.01)


def test_a_joint_that_is_not_seen_is_not_made_up_on_the_way() -> None:
    partial = lacking(STANDING, "left_hand", "right_knee", "right_foot")
    for chosen in (("tf", "bodies", "body_links"), ("tf", "bodies")):
        found = there_and_back(partial, *chosen)
        assert np.isnan(found[INDEX["left_hand"]]).all()
        assert np.isnan(found[INDEX["right_foot"]]).all()
        assert not np.isnan(found[INDEX["left_elbow"]]).any()
