"""The kinematic model of human_description's `urdf/human-tpl.xacro` (2.0.2), written from it for tests, and its poses.

Lengths are in units of a 7.5th of the height, as there.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
UPPER_ARM, FOREARM, THIGH, SHANK, TORSO, SHOULDER, HIP = 1.6, 1.0, 1.5, 2.0, 2.75, 0.8, 0.6


def _chain(
    side: str, sign: float
) -> list[tuple[str, str, str, tuple[float, float, float], tuple[float, float, float]]]:
    """The joints of an arm and a leg, as `JOINTS` has them."""
    return [
        (f"{side}_y_shoulder", "torso", f"{side}_y_shoulder", (0, 0, -sign), (0, sign * SHOULDER, 0)),
        (f"{side}_p_shoulder", f"{side}_y_shoulder", f"{side}_p_shoulder", (sign, 0, 0), (0, 0, 0)),
        (f"{side}_shoulder", f"{side}_p_shoulder", f"{side}_r_shoulder", (0, 0, sign), (0, 0, 0)),
        (f"{side}_elbow", f"{side}_shoulder", f"{side}_elbow", (0, -1, 0), (0, 0, -UPPER_ARM)),
        (f"{side}_wrist", f"{side}_elbow", "", (0, 0, 0), (0, 0, -FOREARM)),
        (f"{side}_y_hip", "body", f"{side}_y_hip", (0, 0, -1), (0, sign * HIP, 0)),
        (f"{side}_p_hip", f"{side}_y_hip", f"{side}_p_hip", (sign, 0, 0), (0, 0, 0)),
        (f"{side}_hip", f"{side}_p_hip", f"{side}_r_hip", (0, -1, 0), (0, 0, 0)),
        (f"{side}_knee", f"{side}_hip", f"{side}_knee", (0, -1, 0), (0, 0, -THIGH)),
        (f"{side}_ankle", f"{side}_knee", "", (0, 0, 0), (0, 0, -SHANK)),
    ]


JOINTS = [
    ("waist", "body", "waist", (0, 1, 0), (0, 0, 0)),
    ("torso", "waist", "", (0, 0, 0), (0, 0, TORSO)),
    ("r_head", "torso", "r_head", (1, 0, 0), (0, 0, 0.25)),
    ("y_head", "r_head", "y_head", (0, 0, 1), (0, 0, 0)),
    ("p_head", "y_head", "p_head", (0, -1, 0), (0, 0, 0)),
    *_chain("l", 1.0),
    *_chain("r", -1.0),
]
"""Child link, parent link, joint, axis, origin in the parent: as the file has them, parents first."""
MOVABLE = {joint for _, _, joint, _, _ in JOINTS if joint}


def poses(angles: dict[str, float]) -> dict[str, Array]:
    """Each link's pose (4, 4) in the body's frame; joints without an angle are at 0."""
    found = {"body": np.eye(4)}
    for child, parent, joint, axis, origin in JOINTS:
        placed = np.eye(4)
        placed[:3, :3], placed[:3, 3] = about(np.array(axis, float), angles.get(joint, 0.0)), origin
        found[child] = found[parent] @ placed
    return found


def urdf(body_id: str, unit_m: float) -> str:
    """The model as `xacro` writes it, without what is drawn; the head's link lies ahead of the middle of the head."""
    head = ("head", "p_head", "", (0.0, 0.0, 0.0), (0.25, 0.0, 0.5))
    joints = [*JOINTS, head]
    links = [f'<link name="{name}_{body_id}"/>' for name in ("body", *(child for child, *_ in joints))]
    return "\n".join(
        ['<?xml version="1.0" ?>', "<!-- made by xacro -->", '<robot name="human">', *links]
        + [_written(body_id, unit_m, *joint) for joint in reversed(joints)]
        + ["</robot>"]
    )


def _written(body_id: str, unit_m: float, child: str, parent: str, joint: str, axis: object, origin: object) -> str:
    kind = f'type="{"revolute" if joint else "fixed"}"'
    at = " ".join(str(unit_m * each) for each in np.array(origin, float))
    turning = f'<axis xyz="{" ".join(map(str, np.array(axis, float)))}"/>' if joint else ""
    return (
        f'<joint name="{joint or child}_{body_id}" {kind}><parent link="{parent}_{body_id}"/>'
        f'<child link="{child}_{body_id}"/><origin rpy="0 0 0" xyz="{at}"/>{turning}</joint>'
    )


def about(axis: Array, angle: float) -> Array:
    """Rodrigues' formula."""
    x, y, z = axis
    across = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    rotation: Array = np.eye(3) + np.sin(angle) * across + (1 - np.cos(angle)) * across @ across
    return rotation
