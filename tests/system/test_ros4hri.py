"""People of the simulated scene as ROS4HRI's bodies and persons, received by others that know nothing of the bridge."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
import zenoh
from zenoh import ext

from actum import keys
from actum.messages import Skeleton
from conftest import NEEDS_ROS2_EXTRA
from events import event
from live import PATIENCE_S, System, collect, wait_until

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from people import STANDING, skeleton
from ros2_bridge import message_types as types
from ros2_bridge.hri import types as hri
from ros2_bridge.settings import TopicName
from ros2_nodes import RosNode, config
from ros2_reading import read

pytestmark = pytest.mark.system
MAPPING = """
gestures: {wave: {gesture: WAVING}}
intents: {wave: {intent: BRING_OBJECT, object: "{object}", recipient: "{person}"}}
"""
OF_BODY = {
    "roi": hri.REGION,
    "skeleton2d": hri.SKELETON_2D,
    "cropped": hri.IMAGE,
    "joint_states": hri.JOINT_STATE,
    "urdf": types.STRING,
    "posture": hri.BODY_POSTURE,
    "gesture": hri.GESTURE,
}
OF_PERSON = {
    "body_id": types.STRING,
    "anonymous": hri.BOOL,
    "location_confidence": hri.FLOAT,
    "action": types.PERSON_ACTION,
}


@pytest.fixture
def node(running: System, tmp_path: Path) -> Iterator[RosNode]:
    """A ROS 2 node that sees the bridge."""
    (tmp_path / "mapping.yaml").write_text(MAPPING, encoding="utf-8")
    running.start_router()
    everything = ",".join(get_args(TopicName))
    running.start(
        "actum_command", "ros2", "--ros-hri-mapping", str(tmp_path / "mapping.yaml"), "--ros-topics", everything
    )
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        assert client.wait_for_subscriber(keys.SKELETON, PATIENCE_S)
    made = RosNode(running.settings.connect)
    wait_until(lambda: "%humans%bodies%tracked" in made.topics(), "the bridge's topics are announced")
    yield made
    made.session.close()


def somebody(node: RosNode, kind: str) -> str:
    """The id on the newest list of bodies or persons in which there is one."""
    listed: Any = node.wait_for(f"humans/{kind}/tracked", hri.IDS_LIST, lambda message: bool(message.ids))
    return str(listed.ids[0])


def of_people(node: RosNode) -> set[str]:
    return {topic for topic in node.topics() if topic.startswith(("%humans%bodies", "%humans%persons"))} - {
        "%humans%bodies%tracked",
        "%humans%persons%tracked",
    }


def test_each_topic_of_a_person_of_the_simulated_scene_is_received_and_listed(running: System, node: RosNode) -> None:
    with running.client() as client:
        listening = client.listen(keys.key(keys.SKELETON, "kinect0"))
        running.start("scene_simulator")
        seen = collect(listening, Skeleton, lambda found: any(it.agents for it in found))
        frame = next(it for it in seen if it.agents)
        body, person = somebody(node, "bodies"), somebody(node, "persons")
        node.wait_for(f"humans/bodies/{body}/skeleton2d", hri.SKELETON_2D)
        waving = event("wave-1", "wave", action="wave").model_copy(
            update={"agent": frame.agents[0].agent, "session_id": frame.session_id}
        )
        client.put(waving)
        for leaf, kind in OF_BODY.items():
            node.wait_for(f"humans/bodies/{body}/{leaf}", kind, lambda _: True)
        for leaf, kind in OF_PERSON.items():
            node.wait_for(f"humans/persons/{person}/{leaf}", kind, lambda _: True)
    assert node.wait_for("humans/candidate_matches", hri.IDS_MATCH).id1 == body
    assert json.loads(node.wait_for("intents", hri.INTENT).data) == {"object": "cup", "recipient": person}
    assert node.wait_for(f"humans/bodies/{body}/gesture", hri.GESTURE).gesture == 6
    assert of_people(node) == {f"%humans%bodies%{body}%{leaf}" for leaf in OF_BODY} | {
        f"%humans%persons%{person}%{leaf}" for leaf in OF_PERSON
    }

    def placed(message: Any) -> bool:
        return f"person_{person}" in {it.child_frame_id for it in message.transforms}

    frames = {it.child_frame_id for it in node.wait_for("tf", types.TF_MESSAGE, placed).transforms}
    assert {f"body_{body}", f"head_{body}", f"l_wrist_{body}", f"r_ankle_{body}"} <= frames


def test_topics_vanish_with_the_person_and_come_back_under_another_id(running: System, node: RosNode) -> None:
    with running.client() as client:
        client.put(skeleton(1, STANDING))
        first = somebody(node, "bodies")
        wait_until(lambda: f"%humans%bodies%{first}%posture" in node.topics(), "the body's topics are listed")
        wait_until(lambda: of_people(node) == set(), "they are gone with the person, who is seen no more")
        node.wait_for("humans/bodies/tracked", hri.IDS_LIST, lambda message: not message.ids)
        client.put(skeleton(2, STANDING))

        def another() -> bool:
            return any(it.ids and it.ids[0] != first for it in node.read("humans/bodies/tracked", hri.IDS_LIST))

        wait_until(another, "the person is another body")


@pytest.mark.pose_model
@pytest.mark.data
def test_a_person_in_a_webcams_clip_is_a_body_with_a_place_in_the_image(
    running: System, node: RosNode, data: Path
) -> None:
    clip = data / "florence3d_rgb" / "GestureRecording_Id1actor1idAction1category1.mp4"
    running.start("sensor_gateway", "--source", "camera", "--camera", str(clip))
    body = somebody(node, "bodies")
    points = node.wait_for(f"humans/bodies/{body}/skeleton2d", hri.SKELETON_2D).skeleton
    region = node.wait_for(f"humans/bodies/{body}/roi", hri.REGION)
    nose, right_shoulder, left_shoulder = points[0], points[2], points[5]
    assert nose.y < min(right_shoulder.y, left_shoulder.y)
    assert right_shoulder.x < left_shoulder.x, "the person faces the camera"
    assert region.xmin <= right_shoulder.x <= region.xmax
    assert region.ymin <= nose.y <= region.ymax
    assert node.wait_for(f"humans/bodies/{body}/joint_states", hri.JOINT_STATE).name


LISTENER = """
import sys, threading
from zenoh_ros2_sdk import ROS2Subscriber
from zenoh_ros2_sdk.session import ZenohSession

host, port, type_hash = sys.argv[1:]
session = ZenohSession.get_instance(host, int(port))
session.register_message_type("int32 sec\\nuint32 nanosec", "builtin_interfaces/msg/Time")
session.register_message_type("builtin_interfaces/Time stamp\\nstring frame_id", "std_msgs/msg/Header")
heard = threading.Event()
def tell(message):
    if message.ids:
        print("bodies", *message.ids, message.header.frame_id, flush=True)
        heard.set()
subscriber = ROS2Subscriber(topic="/humans/bodies/tracked", msg_type="hri_msgs/msg/IdsList", type_hash=type_hash,
                            msg_definition="std_msgs/Header header\\nstring[] ids", callback=tell,
                            router_ip=host, router_port=int(port), domain_id=0)
heard.wait()
sys.stdin.read()
"""
"""A node of zenoh-ros2-sdk that asks for the list of bodies."""
IDS_LIST_HASH = "RIHS01_7e0812d1ac945c98fd3e393568d581ad0ab567f37b24eff633eab778c1bfe62d"
"""That of hri_msgs 2.3.2."""


def test_a_node_of_another_implementation_reads_who_is_there(running: System, node: RosNode, tmp_path: Path) -> None:
    pytest.importorskip("zenoh_ros2_sdk", reason="zenoh-ros2-sdk is a ROS 2 node without ROS")
    (tmp_path / "listener.py").write_text(LISTENER, encoding="utf-8")
    running.start("scene_simulator")
    body = somebody(node, "bodies")
    host, port = running.settings.connect.removeprefix("tcp/").split(":")
    listener = running.start_script(tmp_path / "listener.py", host, port, IDS_LIST_HASH)
    wait_until(lambda: f"bodies {body} kinect0_optical_frame" in listener.said(), "the listener knows the body")


def test_who_asks_after_the_person_has_come_is_told_the_persons_body(running: System, node: RosNode) -> None:
    """By a subscriber as rmw_zenoh declares it for transient local ones, after the person's id is known."""
    running.start("scene_simulator")
    body, person = somebody(node, "bodies"), somebody(node, "persons")
    late = zenoh.open(config(running.settings.connect))
    history = ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
    key = f"0/humans/persons/{person}/body_id/**"
    subscriber = ext.declare_advanced_subscriber(late, key, zenoh.handlers.FifoChannel(10), history=history)
    told: list[str] = []

    def heard() -> bool:
        while (sample := subscriber.try_recv()) is not None:
            told.append(read(types.STRING, sample.payload.to_bytes()).data)
        return bool(told)

    wait_until(heard, "what was latched")
    assert told == [body]
    subscriber.undeclare()
    late.close()
