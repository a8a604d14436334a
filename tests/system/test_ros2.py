"""The bridge to ROS 2 as a process, and others that know nothing of it: sessions as rmw_zenoh opens them."""

import json
import struct
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh
from zenoh import ext

from actum import keys
from actum.messages import Objects, Segment, Skeleton, Status, TrackedObject
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from conftest import NEEDS_ROS2_EXTRA
from events import event
from live import PATIENCE_S, Running, System, collect, free_endpoint, wait_until
from people import STANDING, skeleton

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from ros2_bridge import message_types as types
from ros2_nodes import RosNode, config
from ros2_reading import read, text

pytestmark = pytest.mark.system
STRING = f"std_msgs::msg::dds_::String_/{types.type_hash(types.STRING)}"
MARK = f"0/actum/kinect0/mark/{STRING}"
EVENT_JSON = f"0/actum/kinect0/event_json/{STRING}"
TOPICS = {
    *("skeletons", "%tf", "%tf_static", "objects", "event", "event_json", "intent", "mark"),
    *("%humans%bodies%tracked", "%humans%persons%tracked", "%humans%candidate_matches", "%intents"),
}
CUP = TrackedObject(
    id=3, name="cup", position_m=[0.1, 0.2, 1.5], quaternion_xyzw=[0, 0, 0, 1], confidence=0.75, seen=True
)


@pytest.fixture
def bridge(running: System) -> Running:
    running.start_router()
    return running.start("actum_command", "ros2")


@pytest.fixture
def node(running: System, bridge: Running) -> Iterator[RosNode]:
    """A ROS 2 node that sees the bridge."""
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
    made = RosNode(running.settings.connect)
    wait_until(lambda: made.topics() == TOPICS, "the bridge's topics are announced")
    yield made
    made.session.close()


def test_a_node_sees_the_bridge_and_its_topics_and_that_it_leaves(node: RosNode, bridge: Running) -> None:
    assert {token[8] for token in node.tokens()} == {"bridge"}
    assert {token[5] for token in node.tokens()} == {"NN", "MP", "MS"}
    assert len({token[2] for token in node.tokens()}) == 1
    bridge.terminate()
    assert bridge.process.returncode == 0, bridge.said()
    wait_until(lambda: node.tokens() == [], "its tokens are gone")


def test_skeletons_objects_and_events_arrive_as_ros_messages(running: System, node: RosNode) -> None:
    with running.client() as client:
        for topic in (keys.SKELETON, keys.OBJECTS):
            assert client.wait_for_subscriber(topic, PATIENCE_S)
        client.put(skeleton(5 * SECOND_NS, STANDING))
        client.put(Objects(stamp_ns=6 * SECOND_NS, sensor="kinect0", objects=[CUP]))
        client.put(event("push-1", "push object 1"))
        markers = node.wait_for("actum/kinect0/skeletons", types.MARKER_ARRAY).markers
        assert markers[0].header.stamp.sec == 5
        assert len(markers[0].points) == 15
        frames = {it.child_frame_id: it.transform for it in node.wait_for("tf", types.TF_MESSAGE).transforms}
        assert frames["kinect0_person_1_left_hand"].translation.z == STANDING[INDEX["left_hand"], 2]
        detections = node.wait_for("actum/kinect0/objects", types.DETECTION_3D_ARRAY).detections
        assert detections[0].results[0].hypothesis.class_id == "cup"
        assert node.wait_for("actum/kinect0/event", types.ACTION_EVENT).sentence == "push object 1"
        as_json = json.loads(node.wait_for("actum/kinect0/event_json", types.STRING).data)
        assert as_json["segment_id"] == "push-1"


def test_the_simulated_scenes_people_stand_where_they_are_seen(running: System, node: RosNode) -> None:
    with running.client() as client:
        listening = client.listen(keys.key(keys.SKELETON, "kinect0"))
        running.start("scene_simulator")
        seen = collect(listening, Skeleton, lambda found: any(it.agents for it in found))
        frame = next(it for it in seen if it.agents)
    agent, head = frame.agents[0].agent, frame.agents[0].joints[INDEX["head"]]
    stamp = divmod(frame.stamp_ns, SECOND_NS)

    def of_that_frame(message: Any) -> bool:
        at = message.transforms[0].header.stamp
        return (at.sec, at.nanosec) == stamp

    placed = {it.child_frame_id: it.transform for it in node.wait_for("tf", types.TF_MESSAGE, of_that_frame).transforms}
    there = placed[f"kinect0_person_{agent}_head"].translation
    assert [there.x, there.y, there.z] == head


def test_each_message_carries_its_number_the_time_and_who_put_it(running: System, node: RosNode) -> None:
    with running.client() as client:
        before_ns = time.time_ns()
        for name in ("one", "two"):
            client.put(event(name, name))
        node.wait_for("actum/kinect0/event_json", types.STRING, lambda message: "two" in message.data)
    attachments = [it.attachment.to_bytes() for it in node.samples if str(it.key_expr) == EVENT_JSON]
    numbers, times_ns, lengths, senders = zip(*(struct.unpack("<qqB16s", each) for each in attachments), strict=True)
    assert numbers == (1, 2)
    assert before_ns <= times_ns[0] <= times_ns[1] <= time.time_ns()
    assert lengths == (16, 16)
    assert len(set(senders)) == 1


def test_who_comes_late_gets_the_last_event_and_the_cameras_place(running: System, node: RosNode) -> None:
    with running.client() as client:
        for name in ("one", "two"):
            client.put(event(name, name))
        node.wait_for("actum/kinect0/event_json", types.STRING, lambda message: "two" in message.data)
    late = zenoh.open(config(running.settings.connect))
    history = ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
    static = f"0/tf_static/tf2_msgs::msg::dds_::TFMessage_/{types.type_hash(types.TF_MESSAGE)}"
    subscribers = [
        ext.declare_advanced_subscriber(late, key, zenoh.handlers.FifoChannel(10), history=history)
        for key in (EVENT_JSON, static)
    ]
    found: dict[str, bytes] = {}

    def both() -> bool:
        for subscriber in subscribers:
            while (sample := subscriber.try_recv()) is not None:
                assert str(sample.key_expr) not in found, "only the last is kept"
                found[str(sample.key_expr)] = sample.payload.to_bytes()
        return len(found) == len(subscribers)

    wait_until(both, "what was latched")
    assert json.loads(read(types.STRING, found[EVENT_JSON]).data)["segment_id"] == "two"
    assert read(types.TF_MESSAGE, found[static]).transforms[0].child_frame_id == "kinect0_optical_frame"
    for subscriber in subscribers:
        subscriber.undeclare()
    late.close()


def test_marks_become_segments_and_what_is_none_is_counted(running: System, node: RosNode) -> None:
    with running.client() as client:
        segments = client.listen(keys.key(keys.SEGMENT, "kinect0"))
        statuses = client.listen(keys.key(keys.STATUS, "kinect0", "ros2_bridge"))
        start = text('{"kind": "start", "segment_id": "a", "agent": 1}')
        end = text('{"kind": "end", "segment_id": "a", "stamp_ns": 5}')
        node.put(MARK, text("start!"), b"\xff\x00garbage", start, end)
        marks = collect(segments, Segment, lambda found: len(found) == 2)
        assert [(it.kind, it.segment_id, it.agent, it.stamp_ns) for it in marks] == [
            ("start", "a", 1, None), ("end", "a", None, 5)
        ]  # fmt: skip
        told = collect(statuses, Status, lambda found: bool(found) and found[-1].counts.get("marks") == 2)[-1]
    assert told.rejects == {"bad_mark": 2}
    assert told.last_error is not None
    assert "not a std_msgs/String" in told.last_error


def test_the_bridge_survives_its_routers_death(running: System, node: RosNode, bridge: Running) -> None:
    running.routers.pop().close()
    running.start_router()
    wait_until(lambda: node.topics() == TOPICS, "the topics are announced again")
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        client.put(event("after", "after"))
    node.wait_for("actum/kinect0/event_json", types.STRING, lambda message: "after" in message.data)
    assert bridge.process.poll() is None


def test_a_robots_own_router_is_joined_to_ours(running: System, bridge: Running) -> None:
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        robots = free_endpoint()
        router = zenoh.open(config(running.settings.connect, mode="router", listen=robots))
        node = RosNode(robots)
        wait_until(lambda: node.topics() == TOPICS, "the bridge's topics are announced")
        client.put(event("over two routers", "push"))
        node.wait_for("actum/kinect0/event_json", types.STRING)
        segments = client.listen(keys.key(keys.SEGMENT, "kinect0"))
        node.put(MARK, text('{"kind": "start", "segment_id": "a"}'))
        assert collect(segments, Segment, bool)[0].segment_id == "a"
    node.session.close()
    router.close()


PEER = """
import json, sys, threading
from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber
from zenoh_ros2_sdk.qos import QosProfile, QosDurability

host, port, type_hash = sys.argv[1:]
common = dict(msg_type="std_msgs/msg/String", msg_definition="string data", type_hash=type_hash,
              router_ip=host, router_port=int(port), domain_id=7)
ended = threading.Event()
def tell(message):
    print("event", json.loads(message.data)["segment_id"], flush=True)
    ended.set()
latched = QosProfile(durability=QosDurability.TRANSIENT_LOCAL, history_depth=1)
subscriber = ROS2Subscriber(topic="/event_json", callback=tell, qos=latched, **common)
publisher = ROS2Publisher(topic="/mark", **common)
while not ended.wait(0.1):
    pass
for kind in ("start", "end"):
    publisher.publish(data=json.dumps({"kind": kind, "segment_id": "from the peer"}))
print("marked", flush=True)
sys.stdin.read()
"""
"""A node of zenoh-ros2-sdk: it is told the last event, though it came late, and answers with marks."""


def test_a_node_of_another_implementation_reads_the_last_event_and_marks(running: System, tmp_path: Path) -> None:
    pytest.importorskip("zenoh_ros2_sdk", reason="zenoh-ros2-sdk is a ROS 2 node without ROS")
    running.start_router()
    running.start("ros2_bridge", "--ros-domain-id", "7", "--ros-namespace", "")
    (tmp_path / "peer.py").write_text(PEER)
    with running.client() as client:
        running.wait_for_services(client, "ros2_bridge")
        client.put(event("before it came", "push"))
        segments = client.listen(keys.key(keys.SEGMENT, "kinect0"))
        host, port = running.settings.connect.removeprefix("tcp/").split(":")
        peer = running.start_script(tmp_path / "peer.py", host, port, types.type_hash(types.STRING))
        wait_until(lambda: "event before it came" in peer.said(), "the peer has the last event")
        marks = collect(segments, Segment, lambda found: len(found) == 2)
    assert [(it.kind, it.segment_id) for it in marks] == [("start", "from the peer"), ("end", "from the peer")]
