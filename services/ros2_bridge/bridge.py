"""The bridge's pure step: messages of ours become ROS 2's; marks from ROS 2 become segments, and bodies skeletons."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from actum import keys
from actum.arrays import Array, joints_to_array
from actum.bridge import Foreign, ForeignNode, Output
from actum.limits import MAX_COORDINATE_M
from actum.messages import Agent, Event, Image, Intent, Message, Objects, Skeleton
from actum.node import Counters, Tick
from actum.skeletons import JOINTS
from ros2_bridge import conversion, frames, topics
from ros2_bridge.hri_in.body_reader import BodyReader
from ros2_bridge.hri_out.humans import Humans
from ros2_bridge.marks import BadMarkError, segment_of
from ros2_bridge.message_types import to_cdr
from ros2_bridge.settings import Settings
from ros2_bridge.topics import RosTopic


class Ros2Bridge:
    """Republishes skeletons, objects, events and intents on ROS 2 topics, and takes marks and bodies from others.

    Of images the camera is used, to say where bodies are in them. Their pixels are used only for the topic `cropped`.

    Raises:
        MappingError: the mapping file cannot be used.
    """

    name = "ros2_bridge"

    def __init__(self, settings: Settings) -> None:
        self.inputs: tuple[keys.Topic, ...] = (keys.SKELETON, keys.OBJECTS, keys.EVENT, keys.INTENT)
        if {"bodies", "cropped"} & settings.chosen_topics:
            self.inputs += (keys.COLOR,)
        self.counters = Counters()
        self._settings = settings
        self._humans = Humans(settings, self.counters)
        # with ros_frame_id the frames are the robot's, and the robot publishes where they lie
        self._camera_published = settings.ros_frame_id is not None
        self._bodies = BodyReader(settings.sensor, settings.frame_id, self.counters) if settings.ros_bodies else None

    def foreign_node(self, session_id: str) -> ForeignNode:
        """Return the ROS 2 node that the bridge is in the Zenoh session of this id."""
        if self._bodies is not None:
            self._bodies.begin(f"ros2-{session_id}")
        node = topics.node(self._settings, session_id)
        self._humans.begin(session_id, node.publishes)
        return node

    def handle(self, message: Message | Tick) -> Iterable[Output]:
        """Turn a message into one for each of its topics that is chosen; the first tick says how the camera lies."""
        if isinstance(message, Tick):
            if self._bodies is not None:
                self._bodies.tick(message)
            return [*self._camera(), *self._humans.tick(message.monotonic_ns)]
        if isinstance(message, Image):
            return [*self._humans.look(message)]
        if not isinstance(message, Skeleton | Objects | Event | Intent):
            return []
        if not isinstance(message, Event) and not message.valid:
            self.counters.counts["not valid, left out"] += 1
        elif _latest_ns(message) >= frames.LATEST_NS:
            self.counters.reject("stamp_beyond_ros", f"{_latest_ns(message)} ns on {keys.key_of(message)}")
        else:
            return self._converted(message)
        return []

    def receive(self, foreign: Foreign) -> Iterable[Message]:
        """Turn a mark into a segment, and bodies into skeletons."""
        if self._bodies is not None and foreign.topic != topics.MARK.name:
            return self._bodies.receive(foreign)
        try:
            mark = segment_of(foreign.payload, self._settings.sensor)
        except BadMarkError as error:
            self.counters.reject("bad_mark", str(error))
            return []
        self.counters.counts["marks"] += 1
        return [mark]

    def _camera(self) -> list[Foreign]:
        """Return how the camera lies, once."""
        if self._camera_published:
            return []
        self._camera_published = True
        return self._on(topics.TF_STATIC, conversion.optical_in_link, self._settings.sensor)

    def _converted(self, message: Skeleton | Objects | Event | Intent) -> list[Output]:
        match message:
            case Skeleton():
                people = [(agent.agent, self._usable(agent, message.stamp_ns)) for agent in message.agents]
                shown = self._on(topics.SKELETONS, conversion.markers, message, people)
                placed = self._on(topics.TF, conversion.transforms, message, people)
                return [*shown, *placed, *self._humans.see(message, [joints for _, joints in people])]
            case Objects():
                return [*self._on(topics.OBJECTS, conversion.detections, message)]
            case Event():
                typed = self._on(topics.EVENT, conversion.action_event, message)
                as_json = self._on(topics.EVENT_JSON, conversion.event_json, message)
                return [*typed, *as_json, *self._humans.hear(message)]
            case Intent():
                return [*self._on(topics.INTENT, conversion.action_intent, message)]

    def _on(self, topic: RosTopic, convert: Callable[..., Any], *given: Any) -> list[Foreign]:
        """Return what is converted for a topic; nothing where that is not chosen."""
        if topic.chosen_by not in self._settings.chosen_topics:
            return []
        return [Foreign(topic.name, to_cdr(convert(*given, self._settings.frame_id)))]

    def _usable(self, agent: Agent, stamp_ns: int) -> Array:
        """Return an agent's joints (15, 3), NaN where one is missing, not finite or absurdly far away."""
        joints = joints_to_array(agent.joints)
        bad = [i for i, joint in enumerate(agent.joints) if joint and not (np.abs(joints[i]) <= MAX_COORDINATE_M).all()]
        for i in bad:
            self.counters.reject("bad_joint", f"{JOINTS[i]} of agent {agent.agent} at {stamp_ns}: {agent.joints[i]}")
        joints[bad] = np.nan
        return joints


def _latest_ns(message: Skeleton | Objects | Event | Intent) -> int:
    """Return the latest of the stamps that a message's conversion writes (ns)."""
    return max(message.stamp_ns, message.start_ns, message.end_ns) if isinstance(message, Event) else message.stamp_ns
