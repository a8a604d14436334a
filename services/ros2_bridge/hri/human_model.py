"""The forward kinematics of ROS4HRI's model of the human body: joint angles in, places of joints out.

The links and joints, their axes and proportions are those of `urdf/human-tpl.xacro` in the package human_description
1.0.1 (github.com/ros4hri/human_description, commit a0fcf79f, BSD licence, Copyright 2022 PAL Robotics). The frame of
the body lies between the hips: x forward, y left, z to the head. One link differs: `head` is the middle of the sphere
that the model draws, from which the model's link lies 5 cm ahead.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ros2_bridge.hri.placements import Placement
from ros2_bridge.rotations import NOT_TURNED, Point, Quaternion, about, product

HEIGHT_M = 1.65
"""Body height (m) that the model has by default, and with which ROS4HRI's detectors start it."""
_UNIT_M = HEIGHT_M / 7.5
"""The height of the model's head (m), of which its lengths are multiples."""
HEAD_RADIUS_M = _UNIT_M / 2
"""From the lower end of the head to its middle (m)."""
NECK_M = _UNIT_M * 0.25
"""From the line of the shoulders to the lower end of the head (m)."""
NECK_TO_SHOULDER_M = _UNIT_M * 0.8
"""From the middle of the shoulders to either (m)."""
UPPER_ARM_M = _UNIT_M * 1.6
"""From the shoulder to the elbow (m)."""
FOREARM_M = _UNIT_M
"""From the elbow to the wrist (m)."""
TORSO_M = _UNIT_M * 2.75
"""From the middle of the hips to that of the shoulders (m)."""
WAIST_M = _UNIT_M * 1.2
"""From hip to hip (m)."""
THIGH_M = _UNIT_M * 1.5
"""From the hip to the knee (m)."""
SHANK_M = _UNIT_M * 2
"""From the knee to the ankle (m)."""


@dataclass(frozen=True)
class Link:
    """A link of a model: its parent, where it begins in it (m), and the joint between them with its axis.

    Names are without the body's id. The joint is None where the link is fixed. A link turns about the axis by an angle
    (rad), or, if the joint is prismatic, moves along it by a length (m). `turned` is its orientation in its parent
    while the joint is at 0.
    """

    name: str
    parent: str
    origin_m: Point
    joint: str | None = None
    axis: Point = (0.0, 0.0, 0.0)
    prismatic: bool = False
    turned: Quaternion = NOT_TURNED

    def placement_at(self, position: float) -> Placement:
        """Return the link's placement in its parent for an angle (rad) or a shift (m) of its joint."""
        if not self.prismatic:
            return Placement(self.origin_m, product(self.turned, about(self.axis, position)))
        x, y, z = (position * each for each in self.axis)
        return Placement(Placement(self.origin_m, self.turned).at((x, y, z)), self.turned)


def _arm(side: str, out: int) -> Iterator[Link]:
    """Yield the links of an arm; `out` is 1 on the left and -1 on the right."""
    yield Link(f"{side}_y_shoulder", "torso", (0, out * NECK_TO_SHOULDER_M, 0), f"{side}_y_shoulder", (0, 0, -out))
    yield Link(f"{side}_p_shoulder", f"{side}_y_shoulder", (0, 0, 0), f"{side}_p_shoulder", (out, 0, 0))
    yield Link(f"{side}_shoulder", f"{side}_p_shoulder", (0, 0, 0), f"{side}_r_shoulder", (0, 0, out))
    yield Link(f"{side}_elbow", f"{side}_shoulder", (0, 0, -UPPER_ARM_M), f"{side}_elbow", (0, -1, 0))
    yield Link(f"{side}_wrist", f"{side}_elbow", (0, 0, -FOREARM_M))


def _leg(side: str, out: int) -> Iterator[Link]:
    """Yield the links of a leg."""
    yield Link(f"{side}_y_hip", "body", (0, out * WAIST_M / 2, 0), f"{side}_y_hip", (0, 0, -1))
    yield Link(f"{side}_p_hip", f"{side}_y_hip", (0, 0, 0), f"{side}_p_hip", (out, 0, 0))
    yield Link(f"{side}_hip", f"{side}_p_hip", (0, 0, 0), f"{side}_r_hip", (0, -1, 0))
    yield Link(f"{side}_knee", f"{side}_hip", (0, 0, -THIGH_M), f"{side}_knee", (0, -1, 0))
    yield Link(f"{side}_ankle", f"{side}_knee", (0, 0, -SHANK_M))


LINKS: tuple[Link, ...] = (
    Link("waist", "body", (0, 0, 0), "waist", (0, 1, 0)),
    Link("torso", "waist", (0, 0, TORSO_M)),
    Link("r_head", "torso", (0, 0, NECK_M), "r_head", (1, 0, 0)),
    Link("y_head", "r_head", (0, 0, 0), "y_head", (0, 0, 1)),
    Link("p_head", "y_head", (0, 0, 0), "p_head", (0, -1, 0)),
    Link("head", "p_head", (0, 0, HEAD_RADIUS_M)),
    *_arm("l", 1),
    *_arm("r", -1),
    *_leg("l", 1),
    *_leg("r", -1),
)
"""The links in an order in which parents come first; the body is their root."""
TWISTS = frozenset(("y_head", "l_r_shoulder", "r_r_shoulder"))
"""Joints that count as 0 where they are unknown. Trackers that do not see where somebody looks measure how the head is
tilted as if it were ahead; and an arm's twist cannot be seen only while the arm is straight, when it moves no hand."""


def joints_of_model(links: Sequence[Link]) -> frozenset[str]:
    """Return the names of a model's joints that move."""
    return frozenset(link.joint for link in links if link.joint is not None)


def link_places(positions: Mapping[str, float], links: Sequence[Link] = LINKS) -> dict[str, Point]:
    """Return where links begin (m) in the body's frame, by their name; what no angles determine is left out.

    Args:
        positions: the angle (rad) or the shift (m) of each joint, by its name without the body's id; NaN where it is
            unknown. Unknown shifts count as 0.
        links: of the model, parents before their children; the root is the body.
    """
    placed = {"body": Placement()}
    places = {"body": (0.0, 0.0, 0.0)}
    for link in links:
        parent = placed.get(link.parent)
        if parent is None:
            continue
        position = 0.0 if link.joint is None else positions.get(link.joint, math.nan)
        if not math.isfinite(position) and (link.prismatic or link.joint in TWISTS):
            position = 0.0
        if math.isfinite(position):
            placed[link.name] = parent.of(link.placement_at(position))
            places[link.name] = placed[link.name].position_m
        else:
            places[link.name] = parent.at(link.origin_m)
    return places
