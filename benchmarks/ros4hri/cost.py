"""The processor time of the bridge's step for four people, with ROS4HRI's topics and without."""

import time
from collections.abc import Iterator, Set
from typing import get_args

import numpy as np
from benchmarks.many.scenes import crowd

from actum.messages import Image
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings, TopicName

PEOPLE = 4
SECONDS = 20.0
"""Length of the scene (s), 30 frames each."""
SEED = 0
VIEW = Image(
    sensor="kinect0",
    stamp_ns=0,
    format="jpeg",
    width=640,
    height=480,
    data=b"",
    K=[525.0, 0.0, 320.0, 0.0, 525.0, 240.0, 0.0, 0.0, 1.0],
    distortion=[],
    skeleton_from_image=np.eye(4).ravel().tolist(),
)
"""What the sensor's camera is; the bridge reads no more of it."""
OF_ROS4HRI: frozenset[TopicName] = frozenset({"bodies", "body_links", "persons", "intents", "cropped"})
"""The words of ROS4HRI's topics."""


def of_cost() -> Iterator[str]:
    """Yield a line for each choice of topics: how much of a core the step takes, without what Zenoh takes."""
    usual = Settings().ros_topics
    choices: dict[str, Set[TopicName]] = {"usual topics": usual, "without ROS4HRI": usual - OF_ROS4HRI}
    messages = crowd("kinect0", PEOPLE, SEED, SECONDS)
    assert usual < frozenset(get_args(TopicName))
    for name, chosen in choices.items():
        bridge = Ros2Bridge(Settings(ros_topics=frozenset(chosen)))
        bridge.foreign_node("of the benchmark")
        [*bridge.handle(VIEW)]
        began_s = time.process_time()
        payloads = sum(1 for message in messages for _ in bridge.handle(message))
        share = (time.process_time() - began_s) / SECONDS
        yield f"{PEOPLE} people, {name}: {payloads / SECONDS:.0f} payloads a second, {100 * share:.1f} % of a core"
