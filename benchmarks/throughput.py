"""Frames per second that preprocessor and classifier sustain on one core, with everything but the transport."""

import time
from collections.abc import Sequence

from actum.codec import Frame, decode, encode
from actum.messages import Message
from actum.node import Node, Numbering


class Stage:
    """A node between its codec's ends, as it runs live."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._numbering = Numbering()
        self._inputs = tuple(topic.message for topic in node.inputs)

    def step(self, frame: Frame) -> list[Frame]:
        """Decode, handle, encode."""
        message = decode(frame.key, frame.payload, frame.encoding)
        if not isinstance(message, self._inputs):
            return []
        return [encode(output, seq=self._numbering.number(output)) for output in self._node.handle(message)]


def frames_per_second(messages: Sequence[Message], preprocessor: Node, classifier: Node) -> float:
    """Feed skeletons and marks as fast as they are taken."""
    stream = [encode(message) for message in messages]
    skeletons = sum(frame.key.endswith("skeleton") for frame in stream)
    first, second = Stage(preprocessor), Stage(classifier)
    began_s = time.perf_counter()
    for frame in stream:
        for posture in first.step(frame) or [frame]:
            second.step(posture)
    return skeletons / (time.perf_counter() - began_s)
