"""Joint names and the named tables that map other sensors' skeletons to the fifteen of OpenNI/NITE."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TypeVar

T = TypeVar("T")

JOINTS: tuple[str, ...] = (
    "head",
    "neck",
    "torso",
    "left_shoulder",
    "left_elbow",
    "left_hand",
    "right_shoulder",
    "right_elbow",
    "right_hand",
    "left_hip",
    "left_knee",
    "left_foot",
    "right_hip",
    "right_knee",
    "right_foot",
)
"""The order of every joint list in every message. Left and right are the actor's own."""

INDEX: Mapping[str, int] = MappingProxyType({name: i for i, name in enumerate(JOINTS)})
"""The index of each joint in that order."""

PARTS: Mapping[str, tuple[int, int, int]] = MappingProxyType(
    {
        "right_arm": (6, 7, 8),
        "left_arm": (3, 4, 5),
        "right_leg": (12, 13, 14),
        "left_leg": (9, 10, 11),
        "body": (0, 1, 2),
    }
)
"""The paper's five parts, three joints each; ties in attention are settled by this order."""

NITE_15: tuple[int, ...] = tuple(range(15))
"""The order of OpenNI and NITE 1, which is ours."""

NITE2_15: tuple[int, ...] = (0, 1, 8, 2, 4, 6, 3, 5, 7, 9, 11, 13, 10, 12, 14)
"""The NiTE 2 index of each of our joints. NiTE 2's order: head neck, shoulders elbows hands (left, right), torso,
hips knees feet (left, right)."""

KINECT_V1_20: tuple[int, ...] = (3, 2, 1, 4, 5, 7, 8, 9, 11, 12, 13, 15, 16, 17, 19)
"""The Kinect SDK v1 index of each of our joints. Kinect's order: HipCenter Spine ShoulderCenter Head, then Shoulder
Elbow Wrist Hand (left, right), Hip Knee Ankle Foot (left, right). The torso is the spine joint, the neck the shoulder
centre."""

MSR_ACTION3D_20: tuple[int, ...] = (19, 2, 3, 0, 7, 11, 1, 8, 12, 4, 13, 17, 5, 14, 18)
"""The MSR Action3D index of each of our joints, from its own order of Kinect's twenty; its side B (larger x) is the
actor's right."""

SKELETON_MAPS: Mapping[str, tuple[int, ...]] = MappingProxyType(
    {"nite-15": NITE_15, "nite2-15": NITE2_15, "kinect-v1-20": KINECT_V1_20, "msr-action3d-20": MSR_ACTION3D_20}
)
"""The maps by the name of the skeleton."""


def to_actum(joints: Sequence[T], skeleton: str) -> list[T]:
    """Reorder one frame's joints of the named skeleton to `JOINTS`.

    Raises:
        KeyError: the skeleton has no map.
        IndexError: fewer joints than the skeleton has.
    """
    return [joints[i] for i in SKELETON_MAPS[skeleton]]
