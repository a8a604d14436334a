"""A person's own model: human_description's with prismatic joints, so that links lie where the person's joints are.

Angles alone do not say how long the bones are, or how shoulders, trunk and neck move. With this URDF, a
`robot_state_publisher` places all links as the bridge does.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from xml.etree.ElementTree import Element, SubElement, tostring

from ros2_bridge.hri.human_model import LINKS, TORSO_M, Link
from ros2_bridge.rotations import NOT_TURNED, X_AXIS, Y_AXIS, Z_AXIS, Point, Quaternion, Vector, inverse, rotated

AXES: Mapping[str, Point] = {"x": X_AXIS, "y": Y_AXIS, "z": Z_AXIS}
PRISMATIC: Mapping[str, tuple[str, str]] = {
    "torso": ("torso", "yz"),
    "spine": ("spine", "yz"),
    "head": ("head", "z"),
    **{
        f"{side}_{link}": (f"{side}_{part}", axes)
        for side in "lr"
        for link, part, axes in (
            *(("y_shoulder", "shoulder", "xyz"), ("elbow", "elbow", "z"), ("wrist", "wrist", "z")),
            *(("y_hip", "hip", "y"), ("knee", "knee", "z"), ("ankle", "ankle", "xyz")),
        )
    },
}
"""The links with prismatic joints: for each, its body part and the axes of these joints."""
SPINE = Link("spine", "body", (0.0, 0.0, TORSO_M / 2))
"""The middle of the trunk, which human_description lacks."""
_FURTHEST_M = 2.0
"""The limit of prismatic joints (m), which a URDF has to give."""
_BONES = (
    ("head", "torso", "head", 1.0),
    *(
        (f"{side}_{end}", f"{side}_{start}", f"{side}_{end}", -1.0)
        for side in "lr"
        for start, end in (("shoulder", "elbow"), ("elbow", "wrist"), ("hip", "knee"))
    ),
)
"""The bones along z of their parents: part, link at the start, link at the end, and their direction."""


def _personal(link: Link) -> Iterator[Link]:
    """Yield a link of human_description as a person's own model has it: prismatic joints first, then its own."""
    if link.name == "r_head":
        link = replace(link, origin_m=(0.0, 0.0, 0.0))
    part, axes = PRISMATIC.get(link.name, ("", ""))
    for axis in axes:
        name = f"{part}_along_{axis}"
        yield Link(name, link.parent, link.origin_m, name, AXES[axis], prismatic=True)
        link = replace(link, parent=name, origin_m=(0.0, 0.0, 0.0))
    yield link


PERSONAL_LINKS: tuple[Link, ...] = tuple(own for link in (*LINKS, SPINE) for own in _personal(link))
"""The links in an order in which parents come first. The torso is a person's neck, where the head begins."""
_USUAL_M = {PRISMATIC[link.name][0]: link.origin_m for link in (*LINKS, SPINE) if link.name in PRISMATIC}
"""Where each part lies in its parent in human_description (m)."""
_SHIFTS = [
    (f"{part}_along_{axis}", part, "xyz".index(axis), _USUAL_M[part]["xyz".index(axis)])
    for part, axes in PRISMATIC.values()
    for axis in axes
]
"""For each prismatic joint: its name, its part, its axis' index, and human_description's place of the part (m)."""


def shifts_m(
    at: Mapping[str, Vector], trunk_from_body: Quaternion, turned: Mapping[str, Quaternion]
) -> dict[str, float]:
    """Return by how much each known part is off from where human_description has it in its parent (m).

    Args:
        at: the places of links in the body's frame (m), NaN where unknown.
        trunk_from_body: the bend of the waist.
        turned: the orientations of links in the body's frame, as far as known.
    """
    neck = at["torso"] if not math.isnan(at["torso"][0]) else (0.0, 0.0, TORSO_M)
    places: dict[str, Vector] = {"torso": rotated(trunk_from_body, at["torso"]), "spine": at["spine"]}
    for side in "lr":
        places[f"{side}_shoulder"] = rotated(trunk_from_body, _between(neck, at[f"{side}_shoulder"]))
        places[f"{side}_hip"] = at[f"{side}_hip"]
        shank = _between(at[f"{side}_knee"], at[f"{side}_ankle"])
        places[f"{side}_ankle"] = rotated(inverse(turned.get(f"{side}_ankle", NOT_TURNED)), shank)
    for part, start, end, direction in _BONES:
        places[part] = (0.0, 0.0, direction * math.dist(at[start], at[end]))
    shifts = ((name, places[part][axis] - usual_m) for name, part, axis, usual_m in _SHIFTS)
    return {name: shift_m for name, shift_m in shifts if not math.isnan(shift_m)}


def _between(start: Vector, end: Vector) -> Vector:
    return [b - a for a, b in zip(start, end, strict=True)]


def urdf(body_id: str) -> str:
    """Return the model of the body with an id as an URDF."""
    robot = Element("robot", name="human")
    for name in ("body", *(link.name for link in PERSONAL_LINKS)):
        SubElement(robot, "link", name=f"{name}_{body_id}")
    for link in PERSONAL_LINKS:
        joint_type = "fixed" if link.joint is None else "prismatic" if link.prismatic else "continuous"
        joint = SubElement(robot, "joint", name=f"{link.joint or link.name}_{body_id}", type=joint_type)
        SubElement(joint, "parent", link=f"{link.parent}_{body_id}")
        SubElement(joint, "child", link=f"{link.name}_{body_id}")
        SubElement(joint, "origin", xyz=_written(link.origin_m))
        if link.joint is not None:
            SubElement(joint, "axis", xyz=_written(link.axis))
        if link.prismatic:
            most = str(_FURTHEST_M)
            SubElement(joint, "limit", lower=f"-{most}", upper=most, effort="0", velocity="0")
    return tostring(robot, encoding="unicode")


def _written(numbers: Vector) -> str:
    return " ".join(f"{each:.6g}" for each in numbers)
