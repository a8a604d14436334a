"""What every viewer shows of a message: a person's figure, a line of words, and who or what is there no more."""

import math
from collections.abc import Collection
from dataclasses import dataclass

from rich.text import Text

from actum.messages import Action, Agent, Event, Image, Message, Objects, Point, Segment, Skeleton, Truth
from actum.skeletons import JOINTS
from actum.standard_body import BONES
from actum_command.describing import describe
from actum_command.skeleton_overlay import MIDDLE, side_colour

PIXEL_BYTES = {"bgr8": 3, "depth16_mm": 2}
"""Bytes of a pixel of the formats that are not compressed."""
Rgb = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""
TRUNK: Rgb = (150, 150, 150)
"""The colour of head, neck and torso: grey, which is seen on black and on white."""

JOINT_M = 0.02
"""Radius (m) of a joint: a wrist's."""
BONE_M = 0.01
"""Radius (m) of a bone: thinner than its joints, so that these are seen."""
AXIS_M = 0.1
"""Length (m) of an object's axes: about that of a thing that a hand takes."""


@dataclass(frozen=True)
class Figure:
    """The joints that are known, and the bones between them (m, camera frame); colours tell the person's sides."""

    names: list[str]
    joints: list[Point]
    joint_colours: list[Rgb]
    bones: list[tuple[Point, Point]]
    bone_colours: list[Rgb]


def figure(agent: Agent) -> Figure:
    """Return a person's figure; joints that are missing or not finite have no place in it, nor have their bones."""
    known = {i: joint for i, joint in enumerate(agent.joints) if joint is not None and all(map(math.isfinite, joint))}
    bones = [(parent, child) for parent, child, _ in BONES if parent in known and child in known]
    return Figure(
        names=[JOINTS[i] for i in known],
        joints=list(known.values()),
        joint_colours=[_rgb(i) for i in known],
        bones=[(known[parent], known[child]) for parent, child in bones],
        bone_colours=[_rgb(child) for _, child in bones],
    )


def _rgb(joint: int) -> Rgb:
    blue, green, red = side_colour(joint)
    return TRUNK if (blue, green, red) == MIDDLE else (red, green, blue)


def log_line(message: Message) -> tuple[str, bool] | None:
    """Describe a mark, an answer, or why what was captured is not valid, and tell whether the line is a warning.

    None for all that a log need not have. Partial actions are courses, not lines: there is one with every frame.
    """
    match message:
        case Segment() | Truth() | Event():
            pass
        case Action() if message.final or not message.valid:
            pass
        case Skeleton() | Objects() | Image() if not message.valid:
            pass
        case Image() if (problem := misfit(message)) is not None:
            return problem, True
        case _:
            return None
    return Text.from_markup(describe(message)).plain, not message.valid


def misfit(image: Image) -> str | None:
    """Say what is wrong with an image whose bytes are not as many as its size asks for, so that none can be shown."""
    if image.format == "jpeg":
        return None
    expected = image.height * image.width * PIXEL_BYTES[image.format]
    if len(image.data) == expected:
        return None
    return (
        f"a {image.format} image of {image.width}x{image.height} has {expected} bytes, but this one has "
        f"{len(image.data)}"
    )


class Presence:
    """The numbers of the people, or of the objects, that each sensor named last."""

    def __init__(self) -> None:
        self._last: dict[str, set[int]] = {}

    def departed(self, sensor: str, present: Collection[int]) -> list[int]:
        """Note who is present; return, sorted, the numbers that the sensor named before and names no more."""
        before, self._last[sensor] = self._last.get(sensor, set()), {*present}
        return sorted(before - self._last[sensor])
