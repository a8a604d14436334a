"""What the services and the bridge to ROS 2 put for one simulated scene: some actions are marked, others are found."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.rig.chain import Chain

from actum.bridge import Foreign
from actum.messages import Image, Intent, Message, Skeleton, Truth
from actum.node import TICK_NS, Tick
from actum_command.scene_marks import mark_of
from actum_command.simulated_model import SIMULATED_MODEL
from approving import Approve
from conftest import NEEDS_ROS2_EXTRA
from scene_simulator.everyday import Everyday
from scene_simulator.programme import balanced_programme
from scene_simulator.simulator import Simulator
from som_classifier.model_loading import load_model

MARKED = (1, 3)
TO_ROS = "skeletons,tf,objects,event,event_json,intent,bodies,cropped"
MAPPING = """
gestures: {point: {gesture: POINTING_UP}, lift: {gesture: CLOSED_FIST}}
intents: {put: {intent: PLACE_OBJECT, object: "{object}", agent: "{person}"}}
"""


def scene() -> Iterator[Message | Tick]:
    """Yield skeletons, images and truths of five actions and other doings, marks of some actions, and ticks."""
    simulator = Simulator(balanced_programme(1, 4), 1, 4, image_hz=3, everyday=Everyday(pauses="short"))
    ticks = 0
    for messages in simulator.frames():
        for message in messages:
            if isinstance(message, Truth) and int(message.segment_id[-1]) in MARKED:
                yield mark_of(message)
            yield message
        while messages[-1].stamp_ns > ticks * TICK_NS:
            ticks += 1
            yield Tick(ticks * TICK_NS)


@pytest.fixture(scope="module")
def put() -> list[Message]:
    chain = Chain(load_model(SIMULATED_MODEL))
    return [output for message in scene() for output in chain.feed(message)]


def of_each_type(messages: Iterable[object]) -> dict[str, list[object]]:
    sorted_: dict[str, list[object]] = {}
    for message in messages:
        sorted_.setdefault(type(message).__name__, []).append(message)
    return sorted_


def test_the_services_put_what_is_approved(put: list[Message], approve: Approve) -> None:
    """With the shipped model; after `make simulated-model` other answers are approved."""
    approve("services", of_each_type(put), 1e-5)


def test_the_scene_looks_as_approved(put: list[Message], approve: Approve) -> None:
    """The mean grey of each of 16 x 12 fields of each picture."""
    images = [np.frombuffer(message.data, np.uint8) for message in put if isinstance(message, Image)][::6]
    pictures = [cv2.imdecode(each, cv2.IMREAD_GRAYSCALE) for each in images]
    approve("scene-pictures", [cv2.resize(each, (16, 12), interpolation=cv2.INTER_AREA) for each in pictures], 1e-3)


def test_ros_gets_what_is_approved(put: list[Message], tmp_path: Path, approve: Approve) -> None:
    pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
    from humans import Room

    (tmp_path / "mapping.yaml").write_text(MAPPING)
    room = Room(ros_topics=TO_ROS, ros_hri_mapping=tmp_path / "mapping.yaml")
    for i, message in enumerate(put):
        if not isinstance(message, Skeleton | Intent) or i % 12 == 0:
            room.handle(message)
    room.wait(3)
    said = {**room.said, "event_json": [json.loads(each.data) for each in room.said["event_json"]]}
    approve("ros2", {"said": said, "withdrawn": room.withdrawn, "topics": sorted(room.declared)}, 1e-5)


def test_bodies_come_back_from_ros_as_approved(put: list[Message], approve: Approve) -> None:
    pytest.importorskip("rosbags", reason=NEEDS_ROS2_EXTRA)
    from ros2_bridge.bridge import Ros2Bridge
    from ros2_bridge.settings import Settings

    out = Ros2Bridge(Settings(ros_frame_id="camera", ros_topics=frozenset({"tf", "bodies"})))
    back = Ros2Bridge(Settings(ros_frame_id="camera", ros_bodies=True))
    out.foreign_node("out")
    back.foreign_node("back")
    skeletons = [message for message in put if isinstance(message, Skeleton)][:300:3]
    sent = [each for skeleton in skeletons for each in out.handle(skeleton) if is_of_bodies(each)]
    approve("ros2-bodies", [skeleton for each in sent for skeleton in back.receive(received(each))], 1e-6)


def is_of_bodies(output: object) -> bool:
    return isinstance(output, Foreign) and output.topic.endswith(("/tf", "/tracked", "/joint_states", "/urdf"))


def received(put: Foreign) -> Foreign:
    """Name a payload as a bridge does that subscribes to the topics of all bodies."""
    leaf = put.topic.rpartition("/")[2]
    name = f"/humans/bodies/*/{leaf}" if leaf in ("joint_states", "urdf") else put.topic
    return Foreign(name, put.payload, f"0{put.topic}/type/hash")
