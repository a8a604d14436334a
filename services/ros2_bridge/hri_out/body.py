"""One body in the words of ROS4HRI: its frame, the angles of its joints, and its links' poses in its frame."""

import math
from dataclasses import dataclass

from actum.arrays import Array
from actum.skeletons import INDEX
from ros2_bridge.frames import optical_from_body
from ros2_bridge.hri_out.limbs import SIDES, Limb, arm, head, leg
from ros2_bridge.hri_out.personal_model import shifts_m
from ros2_bridge.rotations import NOT_TURNED, Y_AXIS, Quaternion, Vector, about, inverse, product, rotated

LINKS = {
    "torso": "neck",
    "head": "head",
    "spine": "torso",
    **{
        f"{side}_{link}": f"{of}_{joint}"
        for side, of in (("l", "left"), ("r", "right"))
        for link, joint in (
            *(("shoulder", "shoulder"), ("elbow", "elbow"), ("wrist", "hand")),
            *(("hip", "hip"), ("knee", "knee"), ("ankle", "foot")),
        )
    },
}
"""The links of human_description that lie at a joint of ours, and that joint. The model's torso is between the
shoulders, so it is our neck; our hands and feet stand for wrists and ankles. The model lacks the middle of the trunk,
our torso, which has a frame of its own all the same: `spine`."""
_JOINT_OF_LINK = [INDEX[joint] for joint in LINKS.values()]
"""The index of each link's joint, in the order of `LINKS`."""
SHORTEST_M = 0.02
"""A bone shorter than this (m) has no direction: it is an error of the source."""


@dataclass(frozen=True)
class Body:
    """A body whose hips and torso are known.

    Attributes:
        optical_from_body: (4, 4), the frame between the hips: x forward, y left, z up along the trunk.
        angles: the angle (rad) of each observed joint, by the model's names without id.
        shifts_m: of each joint by which the person's own model differs from human_description, by its name without id.
        links: place (m) and orientation of each known link in the body's frame, by the model's names without id.
    """

    optical_from_body: Array
    angles: dict[str, float]
    shifts_m: dict[str, float]
    links: dict[str, tuple[Vector, Quaternion]]


def body_of(joints: Array) -> Body | None:
    """Return the body of joints (15, 3; m, optical frame, NaN where unknown); None where its frame is not known."""
    hips = (joints[INDEX["left_hip"]] + joints[INDEX["right_hip"]]) / 2
    placed = None if math.isnan(hips[0]) else optical_from_body(joints)
    if placed is None:
        return None
    placed[:3, 3] = hips
    at = dict(zip(LINKS, ((joints[_JOINT_OF_LINK] - hips) @ placed[:3, :3]).tolist(), strict=True))
    bend_rad = _waist(at["torso"])
    trunk: Quaternion = about(Y_AXIS, bend_rad)
    trunk_from_body = inverse(trunk)
    upper, legs = _upper_limbs(at, trunk_from_body), _legs(at)
    turned = {name: product(trunk, quaternion) for limb in upper for name, quaternion in limb.turned.items()}
    turned |= {name: quaternion for limb in legs for name, quaternion in limb.turned.items()}
    links = {name: (xyz, turned.get(name, NOT_TURNED)) for name, xyz in at.items() if not math.isnan(xyz[0])}
    angles = {"waist": bend_rad} | {name: angle for limb in (*upper, *legs) for name, angle in limb.angles.items()}
    return Body(placed, angles, shifts_m(at, trunk_from_body, turned), links)


def _waist(neck: Vector) -> float:
    """Return the angle (rad) by which the trunk is bent forward, from the neck's place (m); 0 where that is unknown.

    The body's z goes from the hips to the middle of the trunk, from which the neck may be further ahead.
    """
    return 0.0 if math.isnan(neck[0]) else math.atan2(neck[0], neck[2])


def _upper_limbs(at: dict[str, list[float]], trunk_from_body: Quaternion) -> list[Limb]:
    """Return head and arms, whose angles are those to the trunk, by the links' places in the body's frame (m)."""

    def along(start: str, end: str) -> Vector | None:
        bone = _direction(at[start], at[end])
        return None if bone is None else rotated(trunk_from_body, bone)

    arms = [
        arm(side, along(f"{side}_shoulder", f"{side}_elbow"), along(f"{side}_elbow", f"{side}_wrist")) for side in SIDES
    ]
    return [head(along("torso", "head")), *arms]


def _legs(at: dict[str, list[float]]) -> list[Limb]:
    """Return the legs by the links' places in the body's frame (m), NaN where unknown."""
    legs = []
    for side in SIDES:
        hip, knee, ankle = (at[f"{side}_{link}"] for link in ("hip", "knee", "ankle"))
        legs.append(leg(side, _direction(hip, knee), _direction(knee, ankle)))
    return legs


def _direction(start: Vector, end: Vector) -> Vector | None:
    """Return the unit vector from one place to another; None where either is unknown, or both are the same."""
    bone = [b - a for a, b in zip(start, end, strict=True)]
    length = math.hypot(*bone)
    return [each / length for each in bone] if length >= SHORTEST_M else None
