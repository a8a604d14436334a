"""The processor time of the bridge's step for four people: with ROS4HRI's topics, without, and with cut-out images."""

import time
from collections.abc import Iterable, Iterator, Set
from typing import get_args

import cv2
import numpy as np
from benchmarks.many.scenes import crowd

from actum import keys
from actum.bridge import Foreign
from actum.messages import Image, Message, Skeleton
from ros2_bridge.bridge import Ros2Bridge
from ros2_bridge.settings import Settings, TopicName

PEOPLE = 4
SECONDS = 20.0
"""Length of the scene (s), 30 frames each."""
SEED = 0
BLOBS = np.random.default_rng(SEED).integers(0, 256, (24, 32, 3), dtype=np.uint8)
"""Colours of the picture, 20 pixels apart."""
VIEW = Image(
    sensor="kinect0",
    stamp_ns=0,
    format="jpeg",
    width=640,
    height=480,
    data=cv2.imencode(".jpg", cv2.resize(BLOBS, (640, 480), interpolation=cv2.INTER_CUBIC))[1].tobytes(),
    K=[525.0, 0.0, 320.0, 0.0, 525.0, 240.0, 0.0, 0.0, 1.0],
    distortion=[],
    skeleton_from_image=np.eye(4).ravel().tolist(),
)
"""What the sensor's camera sees, of 80 kB."""
OF_ROS4HRI: frozenset[TopicName] = frozenset({"bodies", "body_links", "persons", "intents", "cropped"})
"""The words of ROS4HRI's topics."""


def of_cost() -> Iterator[str]:
    """Yield a line for each choice of topics: how much of a core the step takes, without what Zenoh takes."""
    usual = Settings().ros_topics
    everything = frozenset(get_args(TopicName))
    choices: dict[str, Set[TopicName]] = {
        "usual topics": usual, "without ROS4HRI": usual - OF_ROS4HRI, "usual topics and cropped": everything
    }  # fmt: skip
    crowded = crowd("kinect0", PEOPLE, SEED, SECONDS)
    assert usual < everything
    for name, chosen in choices.items():
        bridge = Ros2Bridge(Settings(ros_topics=frozenset(chosen)))
        bridge.foreign_node("of the benchmark")
        messages = [*_with_images(crowded)] if keys.COLOR in bridge.inputs else crowded
        began_s = time.process_time()
        sizes = [len(put.payload) for message in messages for put in bridge.handle(message) if isinstance(put, Foreign)]
        share = (time.process_time() - began_s) / SECONDS
        yield (
            f"{PEOPLE} people, {name}: {len(sizes) / SECONDS:.0f} payloads and {sum(sizes) / SECONDS / 1e6:.1f} MB a "
            f"second, {100 * share:.1f} % of a core"
        )


def _with_images(messages: Iterable[Message]) -> Iterator[Message]:
    """Yield messages with the image of each skeleton before it."""
    for message in messages:
        if isinstance(message, Skeleton):
            yield VIEW.model_copy(update={"stamp_ns": message.stamp_ns})
        yield message
