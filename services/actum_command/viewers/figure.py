"""A person's known joints and bones, and the sizes at which viewers draw people and things."""

import math
from dataclasses import dataclass

from actum.messages import Agent, Point
from actum.skeletons import JOINTS
from actum.standard_body import BONES
from actum_command.skeleton_overlay import MIDDLE, side_colour

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
