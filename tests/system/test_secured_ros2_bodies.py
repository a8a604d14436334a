"""Behind a router that asks, detectors alone put the bodies of which the bridge makes skeletons."""

import json
import time
from collections.abc import Iterator

import pytest
import zenoh

from actum import keys
from actum.messages import Skeleton
from actum.runtime import Client
from actum.runtime.session import secret_config
from conftest import NEEDS_ROS2_EXTRA
from deployments import Deployed, deployed
from live import wait_until
from people import STANDING

pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)

from ros2_bodies import OPTICAL, one_frame
from ros2_bridge.settings import Settings
from ros2_bridge.topics import node

pytestmark = pytest.mark.system
DOMAIN = 3
BODIES = Settings(ros_domain_id=DOMAIN, ros_bodies=True, ros_frame_id=OPTICAL)
KEYS = {topic.name: topic.key for topic in node(BODIES, "5e55").subscribes}


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Deployed]:
    """A deployment with a bridge that reads bodies."""
    root = tmp_path_factory.mktemp("deployment")
    with deployed(root, ros_domain=DOMAIN, ros_bodies=OPTICAL, passwords=True) as made:
        flags = ("--ros-domain-id", str(DOMAIN), "--ros-bodies", "--ros-frame-id", OPTICAL)
        bridge = made.start("ros2_bridge", "compute", *flags)
        yield made
        assert bridge.process.poll() is None


def ros_node(running: Deployed, identity: str, host: str) -> zenoh.Session:
    config = secret_config(running.settings(identity, host))
    config.insert_json5("mode", json.dumps("peer"))
    return zenoh.open(config)


def put(session: zenoh.Session, body_id: str) -> None:
    for each in one_frame(time.time_ns(), {body_id: STANDING}):
        session.put(KEYS[each.topic], each.payload, congestion_control=zenoh.CongestionControl.BLOCK)


def skeletons(client: Client, *sources: tuple[zenoh.Session, str]) -> list[Skeleton]:
    """Have nodes put bodies in turns until some skeletons have come, and return these."""
    listening = client.listen(keys.key(keys.SKELETON, "kinect0"))
    found: list[Skeleton] = []

    def come() -> bool:
        for session, body_id in sources:
            put(session, body_id)
        while (received := listening.receive()) is not None:
            assert isinstance(received.message, Skeleton)
            found.append(received.message)
        return len(found) >= 10

    wait_until(come, "skeletons")
    return found


@pytest.mark.parametrize("host", ["compute", "camera"])
def test_bodies_of_a_detector_on_either_host_become_skeletons(running: Deployed, host: str) -> None:
    with ros_node(running, "detector", host) as detector, running.client("viewer", "camera") as viewer:
        seen = skeletons(viewer, (detector, "ab"))
    assert seen[-1].agents[0].joints[0] == pytest.approx(STANDING[0])


@pytest.mark.parametrize("identity", ["robot", "viewer", "switch", "fusion.kinect0"])
def test_bodies_of_nobody_else_do(running: Deployed, identity: str) -> None:
    with (
        ros_node(running, "detector", "compute") as detector,
        ros_node(running, identity, "compute") as forger,
        running.client("viewer", "compute") as viewer,
    ):
        seen = skeletons(viewer, (forger, "forged"), (detector, "ab"))
        assert {agent.agent for it in seen for agent in it.agents} == {1}, "the one body that the detector put"


def test_a_detector_puts_no_skeletons_itself(running: Deployed) -> None:
    with (
        ros_node(running, "detector", "compute") as detector,
        running.client("viewer", "compute") as viewer,
    ):
        listening = viewer.listen(keys.everything())
        detector.put(keys.key(keys.SKELETON, "kinect0"), b"forged")
        skeletons(viewer, (detector, "ab"))
        came = []
        while (received := listening.receive()) is not None:
            came.append(received)
    assert came
    assert all(it.error is None for it in came if it.key == keys.key(keys.SKELETON, "kinect0"))
