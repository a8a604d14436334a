"""Samples of the input streams: what fusion keeps of a posture and of an objects message, checked once."""

import math
from dataclasses import dataclass, field

import numpy as np

from actum import geometry
from actum.arrays import Array, joints_to_array
from actum.limits import MAX_COORDINATE_M
from actum.messages import Objects, Posture
from actum.node import Counters

UNIT_TOLERANCE = 0.1
"""How much a quaternion's length may differ from 1: rounding differs by less, what is no orientation by more."""

LEVEL = (0.0, -1.0, 0.0)
"""Up in the frame of a level camera, whose y axis points down."""


@dataclass(frozen=True)
class Body:
    """A valid posture: `ego_from_camera` (4, 4), and joints (15, 3) in metres, egocentric, NaN where one is missing.

    `has_front` is false where the egocentric frame is not a body's, so that its forward axis says nothing.
    `depth_std_m` is the standard deviation of the body's distance from the camera, 0 where that was measured.
    `up_in_camera` points against gravity.
    """

    ego_from_camera: Array
    joints_m: Array
    has_front: bool = True
    depth_std_m: float = 0.0
    up_in_camera: tuple[float, ...] = LEVEL


@dataclass(frozen=True)
class Sample:
    """What all samples have: the capture stamp, and the session of the source."""

    stamp_ns: int
    session_id: str


@dataclass(frozen=True)
class PostureSample(Sample):
    """One posture; `body` is None where it was invalid, `agents` are all who were in the image with this one."""

    seq: int | None
    body: Body | None
    agents: tuple[int, ...] = ()


@dataclass(frozen=True)
class ObjectsSample(Sample):
    """The objects of one image by id: positions (3,) in metres in the camera frame, and names.

    Those `image_tracked` were occluded; their position is that of what occludes them, tracked in the image.
    `quaternions_xyzw` (4,) are there for those that were seen.
    """

    positions_m: dict[int, Array]
    names: dict[int, str]
    image_tracked: frozenset[int] = frozenset()
    quaternions_xyzw: dict[int, Array] = field(default_factory=dict)


def posture_sample(posture: Posture, counters: Counters) -> PostureSample:
    """Read a posture; one that says it is valid and cannot be is counted as `bad_posture`, a joint as `bad_joint`."""
    body = _body(posture, counters) if posture.valid else None
    if posture.valid and body is None:
        counters.reject("bad_posture", f"agent {posture.agent} at {posture.stamp_ns}: no joints_m or no rigid frame")
    return PostureSample(posture.stamp_ns, posture.session_id, posture.seq, body, tuple(posture.agents))


def objects_sample(message: Objects, counters: Counters) -> ObjectsSample:
    """Read the seen and the image-tracked objects, no remembered ones; absurdly far ones count as `bad_object`."""
    known = [found for found in message.objects if found.seen or found.followed] if message.valid else []
    near = [found for found in known if max(map(abs, found.position_m)) < MAX_COORDINATE_M]
    if len(near) < len(known):
        counters.reject("bad_object", f"an object beyond {MAX_COORDINATE_M:g} m at {message.stamp_ns}")
    return ObjectsSample(
        message.stamp_ns,
        message.session_id,
        {found.id: np.array(found.position_m, dtype=np.float64) for found in near},
        {found.id: found.name for found in near},
        frozenset(found.id for found in near if not found.seen),
        {found.id: unit for found in near if found.seen and (unit := _unit(found.quaternion_xyzw)) is not None},
    )


def _unit(quaternion: list[float]) -> Array | None:
    """Make an orientation a unit quaternion (4,); None where it is far from one."""
    length = math.hypot(*quaternion)
    return np.array(quaternion) / length if abs(length - 1) <= UNIT_TOLERANCE else None


def _body(posture: Posture, counters: Counters) -> Body | None:
    if posture.joints_m is None or posture.ego_from_camera is None:
        return None
    ego_from_camera = geometry.from_flat(posture.ego_from_camera)
    if not geometry.is_rigid(ego_from_camera, MAX_COORDINATE_M):
        return None
    joints_m = joints_to_array(posture.joints_m)
    joints_m[~(np.abs(joints_m) < MAX_COORDINATE_M).all(axis=1)] = np.nan
    known = np.isfinite(joints_m).all(axis=1)
    if np.count_nonzero(~known) > posture.joints_m.count(None):
        counters.reject("bad_joint", f"agent {posture.agent} at {posture.stamp_ns}: a joint not finite or absurdly far")
    depth_std_m = min(posture.depth_std_m or 0.0, MAX_COORDINATE_M)
    up_in_camera = LEVEL if posture.up_in_camera is None else tuple(posture.up_in_camera)
    return Body(ego_from_camera, joints_m, posture.frame != "world", depth_std_m, up_in_camera)
