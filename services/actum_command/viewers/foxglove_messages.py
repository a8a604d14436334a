"""Turns messages into what Foxglove takes: a topic and a message, of Foxglove's own kinds or one of ours as JSON.

A topic is the message's key, but for the agent: all topics of a sensor are known before anybody is seen.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from foxglove.messages import (
    CameraCalibration,
    CompressedImage,
    FrameTransforms,
    Log,
    LogLevel,
    RawImage,
    SceneUpdate,
)

from actum import keys
from actum.messages import Action, Event, Image, Intent, Message, Objects, Segment, Skeleton, Truth
from actum_command.viewers.contents import PIXEL_BYTES, Presence, log_line, misfit
from actum_command.viewers.foxglove_scene import deleted, of_image, of_object, person, thing, time_of, z_up

TRANSFORMS = "/tf"
"""The topic of all frames."""
RAW_ENCODINGS = {"bgr8": "bgr8", "depth16_mm": "16UC1"}
"""Foxglove's names of the formats that are not compressed."""
DISTORTIONS = {0: "plumb_bob", 4: "plumb_bob", 5: "plumb_bob", 8: "rational_polynomial"}
"""Foxglove's name for OpenCV's distortion of so many numbers; it has none for more."""
PLUMB_BOB = 5
"""How many numbers the smallest of Foxglove's models of a distortion has."""
CONTENTS: Mapping[str, type] = {
    "skeleton": SceneUpdate,
    "objects": SceneUpdate,
    "image/color": CompressedImage,
    "image/color/calibration": CameraCalibration,
    "image/depth": RawImage,
    "image/depth/calibration": CameraCalibration,
    "segment": Segment,
    "action": Action,
    "event": Event,
    "intent": Intent,
    "truth": Truth,
    "log": Log,
}
"""What is put on each topic below a sensor's; colour that is not compressed comes as a `RawImage`, too."""
AS_JSON = (Segment, Action, Event, Intent, Truth)
"""The messages that Foxglove has no schema for: they go as they are, as JSON."""


@dataclass(frozen=True)
class Put:
    """What is put on a topic: a message of Foxglove's, or one of ours that goes as JSON."""

    topic: str
    content: Any


class FoxgloveMessages:
    """Turns messages into those of Foxglove; who or what a sensor names no more is taken away."""

    def __init__(self) -> None:
        self._people, self._objects = Presence(), Presence()

    def of(self, message: Message) -> list[Put]:
        """Return what is put for one message; nothing for postures, which are skeletons turned, for status,
        and for what was held back."""
        return [*self._content(message), *_line(message)]

    def _content(self, message: Message) -> Iterator[Put]:
        sensor, topic = message.sensor, topic_of(message)
        match message:
            case Skeleton(valid=True):
                gone = self._people.departed(sensor, [agent.agent for agent in message.agents])
                yield Put(TRANSFORMS, FrameTransforms(transforms=[z_up(message)]))
                people = [person(message, agent) for agent in message.agents]
                yield Put(topic, SceneUpdate(entities=people, deletions=[deleted(message, f"agent {n}") for n in gone]))
            case Objects(valid=True):
                gone = self._objects.departed(sensor, [tracked.id for tracked in message.objects])
                frames = [of_object(message, tracked) for tracked in message.objects]
                yield Put(TRANSFORMS, FrameTransforms(transforms=frames))
                things = [thing(message, tracked) for tracked in message.objects]
                yield Put(
                    topic, SceneUpdate(entities=things, deletions=[deleted(message, f"object {n}") for n in gone])
                )
            case Image(valid=True) if misfit(message) is None:
                yield from _image(topic, message)
            case _ if isinstance(message, AS_JSON):
                yield Put(topic, message)


def topic_of(message: Message) -> str:
    """Return the topic of a message: `/actum/kinect0/event` of the key `actum/kinect0/event/1`."""
    return below(message.sensor, keys.address_of(message).topic.leaf.removesuffix("/{}"))


def below(sensor: str, leaf: str) -> str:
    """Return a topic of a sensor's."""
    return f"/{keys.BASE}/{sensor}/{leaf}"


def _image(topic: str, image: Image) -> Iterator[Put]:
    """Put an image, its camera, and where that is."""
    time, frame = time_of(image), topic.removeprefix(f"/{keys.BASE}/")
    yield Put(TRANSFORMS, FrameTransforms(transforms=[of_image(image, frame)]))
    yield Put(f"{topic}/calibration", _calibration(image, frame))
    if image.format == "jpeg":
        yield Put(topic, CompressedImage(timestamp=time, frame_id=frame, data=image.data, format="jpeg"))
        return
    yield Put(
        topic,
        RawImage(
            timestamp=time,
            frame_id=frame,
            width=image.width,
            height=image.height,
            encoding=RAW_ENCODINGS[image.format],
            step=PIXEL_BYTES[image.format] * image.width,
            data=image.data,
        ),
    )


def _calibration(image: Image, frame: str) -> CameraCalibration:
    """Describe an image's camera; a distortion that Foxglove has no model for is left out."""
    model = DISTORTIONS.get(len(image.distortion), "")
    missing = max(0, PLUMB_BOB - len(image.distortion))
    fx, _, cx, _, fy, cy, *_ = image.K
    return CameraCalibration(
        timestamp=time_of(image),
        frame_id=frame,
        width=image.width,
        height=image.height,
        distortion_model=model,
        D=[*image.distortion, *[0.0] * missing] if model else [],
        K=image.K,
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def _line(message: Message) -> Iterator[Put]:
    line = log_line(message)
    if line is not None:
        text, warns = line
        level = LogLevel.Warning if warns else LogLevel.Info
        log = Log(timestamp=time_of(message), level=level, message=text, name=topic_of(message))
        yield Put(below(message.sensor, "log"), log)
