"""One body in the words of ROS4HRI: its frame, the angles of its joints, and its links' poses in its frame."""

import math
from dataclasses import dataclass

from actum.arrays import Array
from actum.skeletons import INDEX
from ros2_bridge.frames import optical_from_body
from ros2_bridge.hri.limbs import SIDES, Limb, Quaternion, Vector, arm, head, leg

LINKS = {
    "torso": "neck",
    "head": "head",
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
shoulders, so it is our neck; our hands and feet stand for wrists and ankles."""
_JOINT_OF_LINK = [INDEX[joint] for joint in LINKS.values()]
"""The index of each link's joint, in the order of `LINKS`."""
SHORTEST_M = 0.02
"""A bone shorter than this (m) has no direction: it is an error of the source."""
AS_THE_BODY: Quaternion = (0.0, 0.0, 0.0, 1.0)
"""The orientation of a link that turns with the body, or of which only the place is known."""


@dataclass(frozen=True)
class Body:
    """A body whose hips and torso are known.

    Attributes:
        optical_from_body: (4, 4), the frame between the hips: x forward, y left, z up along the trunk.
        angles: the angle (rad) of each observed joint, by the model's names without id.
        links: place (m) and orientation of each known link in the body's frame, by the model's names without id.
    """

    optical_from_body: Array
    angles: dict[str, float]
    links: dict[str, tuple[Vector, Quaternion]]


def body_of(joints: Array) -> Body | None:
    """Return the body of joints (15, 3; m, optical frame, NaN where unknown); None where its frame is not known."""
    hips = (joints[INDEX["left_hip"]] + joints[INDEX["right_hip"]]) / 2
    placed = None if math.isnan(hips[0]) else optical_from_body(joints)
    if placed is None:
        return None
    placed[:3, 3] = hips
    at = dict(zip(LINKS, ((joints[_JOINT_OF_LINK] - hips) @ placed[:3, :3]).tolist(), strict=True))
    limbs = _limbs(at)
    turned = {name: quaternion for limb in limbs for name, quaternion in limb.turned.items()}
    links = {name: (xyz, turned.get(name, AS_THE_BODY)) for name, xyz in at.items() if not math.isnan(xyz[0])}
    # z is along the trunk, so the trunk is never bent in the body's frame
    angles = {"waist": 0.0} | {name: angle for limb in limbs for name, angle in limb.angles.items()}
    return Body(placed, angles, links)


def _limbs(at: dict[str, list[float]]) -> list[Limb]:
    """Return the limbs by the links' places in the body's frame (m), NaN where unknown."""
    limbs = [head(_direction(at["torso"], at["head"]))]
    for side in SIDES:
        shoulder, elbow, wrist = (at[f"{side}_{link}"] for link in ("shoulder", "elbow", "wrist"))
        hip, knee, ankle = (at[f"{side}_{link}"] for link in ("hip", "knee", "ankle"))
        limbs.append(arm(side, _direction(shoulder, elbow), _direction(elbow, wrist)))
        limbs.append(leg(side, _direction(hip, knee), _direction(knee, ankle)))
    return limbs


def _direction(start: Vector, end: Vector) -> Vector | None:
    """Return the unit vector from one place to another; None where either is unknown, or both are the same."""
    bone = [b - a for a, b in zip(start, end, strict=True)]
    length = math.hypot(*bone)
    return [each / length for each in bone] if length >= SHORTEST_M else None
