"""The bridge's ROS4HRI side for tests: what a subscriber to its topics knows after some messages."""

from typing import Any

from actum.bridge import Foreign, ForeignTopic, Output, Withdrawn
from actum.messages import Image, Message
from actum.node import SECOND_NS, TICK_NS, Tick
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings
from ros2_reading import read

NEAR = [525.0, 0.0, 320.0, 0.0, 525.0, 240.0, 0.0, 0.0, 1.0]
"""A camera matrix for images of 640 x 480 px."""
SAME = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]


def image(**fields: Any) -> Image:
    given = {"K": NEAR, "distortion": [], "skeleton_from_image": SAME, "width": 640, "height": 480, **fields}
    return Image(stamp_ns=1, sensor="kinect0", format="jpeg", data=b"", **given)


class Room:
    """A bridge, and what its topics have said: the open ones, and all messages on each, by name."""

    def __init__(self, **settings: Any) -> None:
        self.bridge = Ros2Bridge(Settings(**settings))
        self.said: dict[str, list[Any]] = {}
        self.order: list[str] = []
        self.withdrawn: list[str] = []
        self.begin("5e55")
        self._now_ns = 0

    def begin(self, session_id: str) -> None:
        self.declared: dict[str, ForeignTopic] = {
            topic.name: topic for topic in self.bridge.foreign_node(session_id).publishes
        }

    def handle(self, *messages: Message | Tick) -> "Room":
        for message in messages:
            for output in self.bridge.handle(message):
                self._take(output)
        return self

    def wait(self, seconds: float) -> "Room":
        """Let ticks pass."""
        for _ in range(round(seconds * SECOND_NS / TICK_NS)):
            self._now_ns += TICK_NS
            self.handle(Tick(self._now_ns))
        return self

    def _take(self, output: Output) -> None:
        match output:
            case ForeignTopic():
                assert output.name not in self.declared
                assert output.token not in [topic.token for topic in self.declared.values()]
                self.declared[output.name] = output
            case Withdrawn():
                del self.declared[output.topic]
                self.withdrawn.append(output.topic)
            case Foreign():
                self.order.append(output.topic)
                self.said.setdefault(output.topic, []).append(
                    read(type_of(self.declared[output.topic]), output.payload)
                )

    def last(self, topic: str) -> Any:
        return self.said[topic][-1]

    @property
    def bodies(self) -> list[str]:
        """The ids on /humans/bodies/tracked."""
        return list(self.last("/humans/bodies/tracked").ids)

    @property
    def persons(self) -> list[str]:
        return list(self.last("/humans/persons/tracked").ids)

    def of_body(self, leaf: str, index: int = 0) -> Any:
        return self.last(f"/humans/bodies/{self.bodies[index]}/{leaf}")

    def of_person(self, leaf: str, index: int = 0) -> Any:
        return self.last(f"/humans/persons/{self.persons[index]}/{leaf}")

    def frames(self) -> dict[str, Any]:
        """The newest transform of each frame."""
        return {it.child_frame_id: it for message in self.said["/tf"] for it in message.transforms}


def type_of(topic: ForeignTopic) -> str:
    """The type's name, from the key: `0/tf/tf2_msgs::msg::dds_::TFMessage_/RIHS01_…`."""
    package, kind, _, name = topic.key.split("/")[-2].split("::")
    return f"{package}/{kind}/{name.removesuffix('_')}"
