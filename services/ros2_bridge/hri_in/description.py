"""The URDF of a body, as ROS4HRI's detectors publish it: which links it has, where, and what moves them."""

import math
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import replace
from xml.etree.ElementTree import Element, ParseError, fromstring

from ros2_bridge.hri.human_model import LINKS, Link
from ros2_bridge.hri_in.body_joints import BODY, MODEL_SHOULDERS
from ros2_bridge.rotations import X_AXIS, Y_AXIS, Z_AXIS, Point, Quaternion, about, product

MOST_LINKS = 128
"""Most links of a body: human_description's has 26, ours 52. All are placed in each image."""
LONGEST_M = 10.0
"""Largest coordinate of a link in its parent."""
MOVING = ("revolute", "continuous", "prismatic")
"""The kinds of joints that move."""
UNIT_TOLERANCE = 1e-3
"""How far the length of an axis may be from 1: publishers round."""

SHOULDERS_M = (-0.03, 0.0, -0.035)
"""Where depth cameras have the shoulders, from where human_description has them (m): further behind and below the neck.

With this shift, 278 instead of 275 of 284 sequences of MSR Action3D's odd people get the label that they have without
the way through joint angles, and 199 instead of 198 of UTKinect's 199; each person was left out in turn.
"""


class BadDescriptionError(ValueError):
    """A URDF that describes no body; the text says why, and what to do."""


def links_of(urdf: str, body_id: str) -> tuple[Link, ...]:
    """Return the links of a body's model below its frame, parents first, by their names without the id.

    Raises:
        BadDescriptionError: it is no URDF, or not one of this body.
    """
    if "<!DOCTYPE" in urdf:
        raise BadDescriptionError(
            "the URDF contains a document type declaration (<!DOCTYPE …>): remove this declaration"
        )
    try:
        joints = fromstring(urdf).findall("joint")
    except (ParseError, ValueError) as error:
        raise BadDescriptionError(f"the URDF is not valid XML ({error}): correct the XML") from None
    if len(joints) > MOST_LINKS:
        raise BadDescriptionError(f"the URDF has {len(joints)} joints: use at most {MOST_LINKS} joints")
    below: defaultdict[str, list[Link]] = defaultdict(list)
    for joint in joints:
        link = _link(joint, f"_{body_id}")
        below[link.parent].append(_as_measured(link))
    links = tuple(_ordered(BODY, below))
    if not links:
        raise BadDescriptionError(
            f"no joint of the URDF has the parent link body_{body_id}: name the links as in human_description, with "
            "this body's id at the end"
        )
    return links


def _as_measured(link: Link) -> Link:
    """Return a link where depth cameras measure it.

    The head is the middle of the sphere that human_description draws; the link lies ahead of it. Shoulders with
    prismatic joints, as in a person's own model, stay where they were measured.
    """
    x, y, z = link.origin_m
    if link.name == "head":
        return replace(link, origin_m=(0.0, y, z))
    if link.name.endswith("_y_shoulder") and link.parent == MODEL_SHOULDERS:
        return replace(link, origin_m=(x + SHOULDERS_M[0], y + SHOULDERS_M[1], z + SHOULDERS_M[2]))
    return link


USUAL_LINKS = tuple(_as_measured(link) for link in LINKS)
"""The model of a body without an URDF: human_description's of the usual height."""


def _ordered(parent: str, below: Mapping[str, list[Link]]) -> Iterator[Link]:
    """Yield what hangs on a link, parents first; a link of two parents is an error, so that there are no circles."""
    found, waiting = {parent}, [parent]
    while waiting:
        for link in below.get(waiting.pop(), ()):
            if link.name in found:
                raise BadDescriptionError(f"the URDF gives the link {link.name} two parents: give each link one parent")
            found.add(link.name)
            waiting.append(link.name)
            yield link


def _link(joint: Element, suffix: str) -> Link:
    """Return the link that a joint holds."""
    name, parent = (_of(joint, element, "link").removesuffix(suffix) for element in ("child", "parent"))
    joint_type = joint.get("type", "")
    axis = _numbers(joint, "axis", "xyz", "1 0 0", 1.0 + UNIT_TOLERANCE) if joint_type in MOVING else (0.0, 0.0, 0.0)
    if joint_type in MOVING and abs(math.hypot(*axis) - 1) > UNIT_TOLERANCE:
        raise BadDescriptionError(
            f"in the URDF, the joint with the child link {name} has the axis {axis}: use an axis of length 1"
        )
    return Link(
        name,
        parent,
        _numbers(joint, "origin", "xyz", "0 0 0", LONGEST_M),
        joint.get("name", "").removesuffix(suffix) if joint_type in MOVING else None,
        axis,
        prismatic=joint_type == "prismatic",
        turned=_turned(*_numbers(joint, "origin", "rpy", "0 0 0", 2 * math.pi)),
    )


def _turned(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation of an URDF's `rpy` (rad): about the fixed axes x, y, z, one after the other."""
    return product(about(Z_AXIS, yaw), product(about(Y_AXIS, pitch), about(X_AXIS, roll)))


def _of(joint: Element, element: str, attribute: str, otherwise: str = "") -> str:
    found = joint.find(element)
    return otherwise if found is None else found.get(attribute, otherwise)


def _numbers(joint: Element, element: str, attribute: str, otherwise: str, largest: float) -> Point:
    """Return three numbers of an element's attribute.

    Raises:
        BadDescriptionError: they are not three, or one is larger than `largest`.
    """
    text, name = _of(joint, element, attribute, otherwise), joint.get("name")
    try:
        x, y, z = (float(each) for each in text.split())
    except ValueError:
        raise BadDescriptionError(
            f"in the URDF, the joint {name} has <{element} {attribute}={text!r}>: write three numbers"
        ) from None
    if not all(abs(each) <= largest for each in (x, y, z)):
        raise BadDescriptionError(
            f"in the URDF, the joint {name} has <{element} {attribute}={text!r}>: use numbers from -{largest:g} to "
            f"{largest:g}"
        )
    return x, y, z
