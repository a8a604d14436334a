"""The bridge as the source of a sensor: bodies that a ROS 2 node publishes arrive as skeletons, and postures."""

import math
import time
from collections.abc import Iterator

import numpy as np
import pytest
import zenoh
from zenoh import ext

import human_model
from actum import keys
from actum.bridge import Foreign
from actum.messages import Info, Posture, Skeleton, Status
from actum.runtime import Client
from actum.runtime.session import secret_config
from actum.skeletons import INDEX
from conftest import NEEDS_ROS2_EXTRA
from live import PATIENCE_S, Running, System, collect, wait_until
from people import FRAME_NS, STANDING

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from ros2_bodies import OPTICAL, frames, joint_states, one_frame, skeleton_2d, tf, tf_static, tracked, transform, urdf
from ros2_bridge.settings import Settings
from ros2_bridge.topics import node

pytestmark = pytest.mark.system
FLAGS = ("--ros-bodies", "--ros-frame-id", OPTICAL)
KEYS = {topic.name: topic.key for topic in node(Settings(ros_bodies=True, ros_frame_id=OPTICAL), "5e55").subscribes}


def key_of(foreign: Foreign) -> str:
    """The key on which a ROS 2 node puts a payload."""
    return KEYS[foreign.topic].replace("*", foreign.key.split("/")[3]) if "*" in foreign.topic else KEYS[foreign.topic]


@pytest.fixture
def detector(running: System) -> Iterator[zenoh.Session]:
    """A session as that of a node that detects bodies."""
    running.start_router()
    with zenoh.open(secret_config(running.settings)) as session:
        yield session


@pytest.fixture
def bridge(running: System, detector: zenoh.Session) -> Running:
    started = running.start("actum_command", "ros2", *FLAGS)
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
    return started


def put(session: zenoh.Session, *payloads: Foreign) -> None:
    for each in payloads:
        session.put(key_of(each), each.payload, congestion_control=zenoh.CongestionControl.BLOCK)


def put_until(client: Client, session: zenoh.Session) -> list[Skeleton]:
    """Put a person again and again, and return the skeletons once there are some."""
    listening = client.listen(keys.pattern(keys.SKELETON, "kinect0"))
    found: list[Skeleton] = []

    def came() -> bool:
        put(session, *one_frame(time.time_ns(), {"ab": STANDING}))
        while (received := listening.receive()) is not None:
            if isinstance(received.message, Skeleton):
                found.append(received.message)
        return len(found) > 5

    wait_until(came, "skeletons")
    return found


def test_bodies_of_a_ros_node_become_skeletons_and_postures(
    running: System, detector: zenoh.Session, bridge: Running
) -> None:
    with running.client() as client:
        running.start("pose_preprocessor")
        assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
        running.wait_for_services(client, "pose_preprocessor")
        postures = client.listen(keys.pattern(keys.POSTURE, "kinect0"))
        skeleton = put_until(client, detector)[-1]
        left_hand = INDEX["left_hand"]
        assert skeleton.agents[0].joints[left_hand] == pytest.approx(STANDING[left_hand])
        found = collect(postures, Posture, lambda seen: any(it.valid for it in seen))
    assert next(it for it in found if it.valid).agent == 1
    assert skeleton.session_id.startswith("ros2-")


def test_the_bridge_says_that_it_is_the_source(running: System, detector: zenoh.Session, bridge: Running) -> None:
    with running.client() as client:
        infos: list[Info] = []

        def described() -> bool:
            infos[:] = [info for info in client.infos() if info.service == "ros2_bridge"]
            return bool(infos)

        wait_until(described, "its description")
    assert infos[0].source == f"ROS 2, bodies of ROS4HRI in the frame {OPTICAL}"


def test_transforms_that_were_published_before_the_bridge_came_count(running: System, detector: zenoh.Session) -> None:
    static = tf_static(transform(0, OPTICAL, (0, 0, 1), (-0.5, 0.5, -0.5, 0.5), parent="base_link"))
    publisher = ext.declare_advanced_publisher(
        detector, key_of(static), cache=ext.CacheConfig(max_samples=1), publisher_detection=True
    )
    publisher.put(static.payload)
    running.start("ros2_bridge", *FLAGS)
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        ups: list[list[float] | None] = []

        def knows_the_robot() -> bool:
            ups.append(put_until(client, detector)[-1].up_in_camera)
            return ups[-1] is not None

        wait_until(knows_the_robot, "the robot's tree is known")
    assert ups[-1] == pytest.approx([0, -1, 0], abs=1e-6)
    publisher.undeclare()


def test_points_in_the_image_alone_are_refused_with_the_remedy(
    running: System, detector: zenoh.Session, bridge: Running
) -> None:
    with running.client() as client:
        skeletons = client.listen(keys.pattern(keys.SKELETON, "kinect0"))
        statuses = client.listen(keys.key(keys.STATUS, "kinect0", "ros2_bridge"))
        states: list[str] = []

        def refused() -> bool:
            stamp_ns = time.time_ns()
            put(detector, tracked(stamp_ns, "ab"), skeleton_2d(stamp_ns, "ab"))
            while (received := statuses.receive()) is not None:
                if isinstance(received.message, Status):
                    states.append(received.message.state)
            return any("the bodies ab have only points in the image (skeleton2d)" in state for state in states)

        wait_until(refused, "the state")
        assert skeletons.receive() is None


def test_a_late_body_and_a_stamp_between_frames_do_no_harm(
    running: System, detector: zenoh.Session, bridge: Running
) -> None:
    with running.client() as client:
        put_until(client, detector)
        put(detector, tf(*frames(time.time_ns() - 10 * FRAME_NS, STANDING, "ab")))
        late = put_until(client, detector)
    stamps = [it.stamp_ns for it in late]
    assert stamps == sorted(stamps)
    assert np.all(np.diff(stamps) > 0)


def test_people_of_one_sensor_go_over_ros_to_another_sensor(running: System) -> None:
    running.start_router()
    with running.client() as client, running.client(sensor="robot") as robot:
        seen = client.listen(keys.pattern(keys.SKELETON, "kinect0"))
        came = robot.listen(keys.pattern(keys.SKELETON, "robot"))
        running.start("ros2_bridge")
        running.start("ros2_bridge", "--sensor", "robot", "--ros-bodies", "--ros-frame-id", "kinect0_optical_frame")
        running.wait_for_services(client, "ros2_bridge")
        running.wait_for_services(robot, "ros2_bridge")
        running.start("scene_simulator")
        found = collect(came, Skeleton, lambda them: sum(bool(it.agents) for it in them) >= 30)
        sent = {it.stamp_ns: it for it in collect(seen, Skeleton, bool)}
        while (received := seen.receive()) is not None:
            if isinstance(received.message, Skeleton):
                sent[received.message.stamp_ns] = received.message
    for skeleton in (it for it in found if it.agents):
        theirs, ours = (it.agents[0].joints for it in (sent[skeleton.stamp_ns], skeleton))
        np.testing.assert_allclose(np.array(ours), np.array(theirs), atol=1e-5)
        assert skeleton.up_in_camera == pytest.approx([0, -1, 0], abs=1e-6)


def test_a_bodys_urdf_that_was_published_before_the_bridge_came_counts(
    running: System, detector: zenoh.Session
) -> None:
    described = urdf("ab", human_model.urdf("ab", unit_m=0.3))
    publisher = ext.declare_advanced_publisher(
        detector, key_of(described), cache=ext.CacheConfig(max_samples=1), publisher_detection=True
    )
    publisher.put(described.payload)
    running.start("ros2_bridge", *FLAGS)
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        listening = client.listen(keys.pattern(keys.SKELETON, "kinect0"))

        def has_the_bodys_bones() -> bool:
            stamp_ns = time.time_ns()
            put(detector, tracked(stamp_ns, "ab"), tf(transform(stamp_ns, "body_ab", (0, 0, 2))))
            put(detector, joint_states(stamp_ns, "ab", dict.fromkeys(human_model.MOVABLE, 0.0)))
            forearms_m: list[float] = []
            while (received := listening.receive()) is not None:
                if isinstance(received.message, Skeleton) and received.message.agents:
                    joints = received.message.agents[0].joints
                    forearms_m.append(math.dist(joints[INDEX["left_elbow"]] or (), joints[INDEX["left_hand"]] or ()))
            return forearms_m[-1:] == [pytest.approx(0.3)]

        wait_until(has_the_bodys_bones, "the body's bones are known")
    publisher.undeclare()
