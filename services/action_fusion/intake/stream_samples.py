"""Samples of the input streams: the checked contents of posture and objects messages that fusion uses."""

import math
from dataclasses import dataclass

import numpy as np

from actum import geometry
from actum.arrays import Array, joints_to_array
from actum.limits import MAX_COORDINATE_M
from actum.messages import Objects, Posture
from actum.node import Counters
from actum.skeletons import INDEX

HANDS = [INDEX["right_hand"], INDEX["left_hand"]]
"""The joints of which events tell."""

UNIT_TOLERANCE = 0.1
"""Largest deviation of a quaternion's length from 1: rounding causes less, values that are no orientation more."""

LEVEL = (0.0, -1.0, 0.0)
"""Up in the frame of a level camera, whose y axis points down."""


@dataclass(frozen=True)
class Body:
    """A valid posture: `ego_from_camera` (4, 4), and joints (15, 3) in metres, egocentric, NaN where one is missing.

    `hands_m` (2, 3) are the positions of right and left hand in the camera frame.
    `has_front` is false where the egocentric frame was not computed from a body, so that its forward axis is arbitrary.
    `depth_std_m` is the standard deviation of the body's distance from the camera, 0 where the distance is measured.
    `up_in_camera` points against gravity.
    """

    ego_from_camera: Array
    joints_m: Array
    hands_m: Array
    has_front: bool
    depth_std_m: float
    up_in_camera: tuple[float, ...]


@dataclass(frozen=True)
class Sample:
    """A sample of any stream: the capture stamp, and the session of the source."""

    stamp_ns: int
    session_id: str


@dataclass(frozen=True)
class PostureSample(Sample):
    """One posture; `body` is None where it was invalid, `agents` are the numbers of all people in the image."""

    seq: int | None
    body: Body | None
    agents: tuple[int, ...]


@dataclass(frozen=True)
class ObjectsSample(Sample):
    """The objects of one image by id: positions (3,) in metres in the camera frame, and names.

    The objects `image_tracked` were occluded; their positions come from the occluder, tracked in the image.
    `quaternions_xyzw` (4,) holds the orientations of the objects that were seen.
    """

    positions_m: dict[int, list[float]]
    names: dict[int, str]
    image_tracked: frozenset[int]
    quaternions_xyzw: dict[int, list[float]]


def posture_sample(posture: Posture, counters: Counters) -> PostureSample:
    """Read a posture; count an unusable one that claims to be valid as `bad_posture`, a bad joint as `bad_joint`."""
    body = _body(posture, counters) if posture.valid else None
    if posture.valid and body is None:
        counters.reject("bad_posture", f"agent {posture.agent} at {posture.stamp_ns}: no joints_m or no rigid frame")
    return PostureSample(posture.stamp_ns, posture.session_id, posture.seq, body, tuple(posture.agents))


def objects_sample(message: Objects, counters: Counters) -> ObjectsSample:
    """Read the seen and the image-tracked objects, not the remembered ones; count absurd and repeated ones."""
    known = [each for each in message.objects if each.seen or each.followed] if message.valid else []
    near = [each for each in known if max(map(abs, each.position_m)) < MAX_COORDINATE_M]
    if len(near) < len(known):
        counters.reject("bad_object", f"an object beyond {MAX_COORDINATE_M:g} m at {message.stamp_ns}")
    positions_m = {each.id: each.position_m for each in near}
    if len(positions_m) < len(near):
        counters.reject("repeated_object", f"{len(near)} objects, {len(positions_m)} distinct, at {message.stamp_ns}")
    return ObjectsSample(
        message.stamp_ns,
        message.session_id,
        positions_m,
        {each.id: each.name for each in near},
        frozenset(each.id for each in near if not each.seen),
        {each.id: unit for each in near if each.seen and (unit := _unit(each.quaternion_xyzw)) is not None},
    )


def _unit(quaternion: list[float]) -> list[float] | None:
    """Normalise a quaternion to unit length; None where its length is far from 1."""
    length = math.hypot(*quaternion)
    return [each / length for each in quaternion] if abs(length - 1) <= UNIT_TOLERANCE else None


def _body(posture: Posture, counters: Counters) -> Body | None:
    if posture.joints_m is None or posture.ego_from_camera is None:
        return None
    ego_from_camera = geometry.from_flat(posture.ego_from_camera)
    if not geometry.is_rigid(ego_from_camera, MAX_COORDINATE_M):
        return None
    joints_m = joints_to_array(posture.joints_m)
    unusable = ~(np.abs(joints_m) < MAX_COORDINATE_M)
    if unusable.any():
        joints_m[unusable.any(axis=1)] = np.nan
        if np.count_nonzero(np.isnan(joints_m[:, 0])) > posture.joints_m.count(None):
            what = f"agent {posture.agent} at {posture.stamp_ns}: a joint not finite or absurdly far"
            counters.reject("bad_joint", what)
    depth_std_m = min(posture.depth_std_m or 0.0, MAX_COORDINATE_M)
    up_in_camera = LEVEL if posture.up_in_camera is None else tuple(posture.up_in_camera)
    hands_m = (joints_m[HANDS] - ego_from_camera[:3, 3]) @ ego_from_camera[:3, :3]
    return Body(ego_from_camera, joints_m, hands_m, posture.frame != "world", depth_std_m, up_in_camera)
