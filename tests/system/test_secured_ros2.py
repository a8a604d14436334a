"""The bridge to ROS 2 behind a router that asks: it does what it does without, and nobody else speaks there."""

import json
from collections.abc import Callable, Iterator
from typing import Any

import pytest
import zenoh

from actum import keys
from actum.messages import Segment
from actum.runtime import Listening
from actum.runtime.session import secret_config
from conftest import NEEDS_ROS2_EXTRA
from deployments import Deployed, deployed
from empty_messages import mark
from events import event
from live import PATIENCE_S, collect, wait_until
from third_session import received

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from ros2_bridge import message_types as types
from ros2_bridge.settings import Settings
from ros2_bridge.topics import node
from ros2_reading import read, text

pytestmark = pytest.mark.system
SEGMENT = keys.key(keys.SEGMENT, "kinect0")
FORBIDDEN = (keys.key(keys.EVENT, "kinect0", 1), keys.key(keys.SEGMENT, "kinect1"), keys.key(keys.COLOR, "kinect0"))
"""What the bridge of kinect0 may not put."""
DOMAIN = 3
NODE = node(Settings(ros_domain_id=DOMAIN), "5e55")
EVENT_JSON = next(topic.key for topic in NODE.publishes if topic.name == "event_json")
[MARK] = [topic.key for topic in NODE.subscribes]


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Deployed]:
    """A deployment with a bridge that has announced its topics."""
    with deployed(tmp_path_factory.mktemp("deployment"), ros_domain=DOMAIN, passwords=True) as made:
        bridge = made.start("ros2_bridge", "compute", "--ros-domain-id", str(DOMAIN))
        with Robot(made) as robot:
            wait_until(lambda: len(robot.tokens()) == 1 + len(NODE.publishes) + len(NODE.subscribes), "it is announced")
        yield made
        assert bridge.process.poll() is None


class Robot:
    """A session as that of a ROS 2 node, by default with the credentials of its role."""

    def __init__(self, running: Deployed, identity: str = "robot", host: str = "compute") -> None:
        config = secret_config(running.settings(identity, host))
        if identity == "robot":
            config.insert_json5("mode", json.dumps("peer"))
        self.session = zenoh.open(config)

    def __enter__(self) -> "Robot":
        return self

    def __exit__(self, *_: object) -> None:
        self.session.close()

    def tokens(self) -> list[str]:
        replies = self.session.liveliness().get(f"@ros2_lv/{DOMAIN}/**", timeout=1.0)
        return [str(reply.ok.key_expr) for reply in replies if reply.ok is not None]

    def hears(self, key: str) -> Callable[[], list[Any]]:
        subscriber = self.session.declare_subscriber(key, zenoh.handlers.FifoChannel(1000))

        def come() -> list[Any]:
            taken = []
            while (sample := subscriber.try_recv()) is not None:
                taken.append(sample)
            return taken

        return come


@pytest.mark.parametrize("host", ["compute", "camera"])
def test_a_node_reads_events_and_marks_on_either_host(running: Deployed, host: str) -> None:
    with Robot(running, host=host) as robot, running.client("viewer", "camera") as viewer:
        segments = viewer.listen(keys.key(keys.SEGMENT, "kinect0"))
        events = robot.hears(EVENT_JSON)
        heard: list[Any] = []
        with running.client("fusion.kinect0", "compute") as fusion:

            def an_event_comes() -> bool:
                fusion.put(event("push-1", "push object 1"))
                heard.extend(events())
                return bool(heard)

            wait_until(an_event_comes, "an event")
        assert json.loads(read(types.STRING, heard[0].payload.to_bytes()).data)["segment_id"] == "push-1"
        robot.session.put(MARK, text('{"kind": "start", "segment_id": "a"}'))
        assert [each.segment_id for each in collect(segments, Segment, bool)] == ["a"]


def until_marked(robot: Robot, segments: Listening) -> None:
    """Have the robot mark until a mark comes; whatever else came before is not right."""
    came: list[Segment] = []

    def one_comes() -> bool:
        robot.session.put(MARK, text('{"kind": "start", "segment_id": "right"}'))
        while (taken := segments.receive()) is not None:
            assert isinstance(taken.message, Segment)
            came.append(taken.message)
        return bool(came)

    wait_until(one_comes, "a mark")
    assert {each.segment_id for each in came} == {"right"}


@pytest.mark.parametrize("identity", ["viewer", "switch", "page.kinect0", "gateway.kinect0"])
def test_nobody_else_speaks_or_listens_on_ros_keys(running: Deployed, identity: str) -> None:
    with (
        Robot(running, identity) as other,
        Robot(running, identity) as listening,  # not the same: a session hears what it puts itself
        Robot(running) as robot,
        running.client("viewer", "compute") as viewer,
        running.client("fusion.kinect0", "compute") as fusion,
    ):
        segments = viewer.listen(SEGMENT)
        came, events = listening.hears(EVENT_JSON), robot.hears(EVENT_JSON)
        assert other.tokens() == []
        other.session.put(MARK, text('{"kind": "start", "segment_id": "forged"}'))
        other.session.put(EVENT_JSON, text("forged"))
        until_marked(robot, segments)
        heard: list[str] = []

        def an_event_comes() -> bool:
            fusion.put(event("right", "push object 1"))
            heard.extend(read(types.STRING, each.payload.to_bytes()).data for each in events())
            return bool(heard)

        wait_until(an_event_comes, "an event")
        assert "forged" not in heard
        assert came() == []


def test_a_robot_reads_and_puts_nothing_of_ours(running: Deployed) -> None:
    with (
        Robot(running) as robot,
        Robot(running) as listening,
        running.client("recorder", "compute") as third,
        running.client("viewer", "compute") as viewer,
    ):
        ours, events = listening.hears(keys.everything()), listening.hears(EVENT_JSON)
        heard, segments = third.listen(keys.key(keys.EVENT, "kinect0", 1)), viewer.listen(SEGMENT)
        wait_until(lambda: len(listening.tokens()) > 0, "the robot sees the bridge")
        before = [each.payload.to_bytes() for each in events()]
        robot.session.put(SEGMENT, b"a mark")
        robot.session.put(keys.key(keys.EVENT, "kinect0", 1), b"an event")
        robot.session.put(EVENT_JSON, text("forged"))
        until_marked(robot, segments)
        assert received(heard) == []
        assert ours() == []
        assert text("forged") not in [*before, *(each.payload.to_bytes() for each in events())]


def test_the_bridge_puts_no_events_and_marks_no_other_sensor(running: Deployed) -> None:
    with (
        zenoh.open(secret_config(running.settings("ros2.kinect0", "compute"))) as session,
        running.client("recorder", "compute") as third,
    ):
        heard = third.listen(keys.everything())
        for key in FORBIDDEN:
            session.put(key, b"forged")
        with running.client("ros2.kinect0", "compute") as client:
            assert client.wait_for_subscriber(keys.SEGMENT, PATIENCE_S)
            client.put(mark("start", 1))
        came: list[str] = []
        wait_until(lambda: came.extend(received(heard)) or SEGMENT in came, "its own mark")
        assert not {*FORBIDDEN} & {*came}
