"""What fusion keeps of a posture and of an objects message: the few numbers it needs, checked once."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from actum import geometry
from actum.messages import Joint, Objects, Posture
from actum.node import Counters

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Indices = NDArray[np.int64]

FURTHEST_M = 100.0
UNIT_TOLERANCE = 0.1
MISSING = [math.nan] * 3
LEVEL = (0.0, -1.0, 0.0)


@dataclass(frozen=True)
class Body:
    """A valid posture's frame, and its joints (15, 3), metric egocentric, NaN where one is missing.

    `faces` is false where the frame is no body's, so that its forward is nobody's. `depth_std_m` is 0 where the
    distance along the line of sight was measured, `up_in_camera` points against gravity.
    """

    ego_from_camera: Array
    joints_m: Array
    faces: bool = True
    depth_std_m: float = 0.0
    up_in_camera: tuple[float, ...] = LEVEL


@dataclass(frozen=True)
class Sample:
    """What every sample carries: its capture stamp, and the session of its source."""

    stamp_ns: int
    session_id: str


@dataclass(frozen=True)
class PostureSample(Sample):
    """A posture of one of the `agents` who are there; `body` is None where it only tells that time went on."""

    seq: int | None
    body: Body | None
    agents: tuple[int, ...] = ()


@dataclass(frozen=True)
class ObjectsSample(Sample):
    """The objects known in one image: positions (3,) in the camera frame, and names, by id.

    Those `followed` were not seen: what covers them was. `quaternions_xyzw` (4,) are of those that were seen.
    """

    positions_m: dict[int, Array]
    names: dict[int, str]
    followed: frozenset[int] = frozenset()
    quaternions_xyzw: dict[int, Array] = field(default_factory=dict)


def posture_sample(posture: Posture, counters: Counters) -> PostureSample:
    """Read a posture; one that says it is valid and cannot be is counted as `bad_posture`, a joint as `bad_joint`."""
    body = _body(posture, counters) if posture.valid else None
    if posture.valid and body is None:
        counters.reject("bad_posture", f"agent {posture.agent} at {posture.stamp_ns}: no joints_m or no rigid frame")
    return PostureSample(posture.stamp_ns, posture.session_id, posture.seq, body, tuple(posture.agents))


def objects_sample(message: Objects, counters: Counters) -> ObjectsSample:
    """Read the objects that were seen or followed, not remembered; absurdly far ones are counted as `bad_object`."""
    known = [found for found in message.objects if found.seen or found.followed] if message.valid else []
    near = [found for found in known if max(map(abs, found.position_m)) < FURTHEST_M]
    if len(near) < len(known):
        counters.reject("bad_object", f"an object beyond {FURTHEST_M:g} m at {message.stamp_ns}")
    return ObjectsSample(
        message.stamp_ns,
        message.session_id,
        {found.id: np.array(found.position_m, dtype=np.float64) for found in near},
        {found.id: found.name for found in near},
        frozenset(found.id for found in near if not found.seen),
        {found.id: turned for found in near if found.seen and (turned := _unit(found.quaternion_xyzw)) is not None},
    )


def _unit(quaternion: list[float]) -> Array | None:
    """Make an orientation a unit quaternion (4,); None where it is far from one."""
    length = math.hypot(*quaternion)
    return np.array(quaternion) / length if abs(length - 1) <= UNIT_TOLERANCE else None


def _body(posture: Posture, counters: Counters) -> Body | None:
    if posture.joints_m is None or posture.ego_from_camera is None:
        return None
    ego_from_camera = geometry.from_flat(posture.ego_from_camera)
    if not geometry.is_rigid(ego_from_camera, FURTHEST_M):
        return None
    joints_m = _joints(posture.joints_m)
    known = np.isfinite(joints_m).all(axis=1)
    if np.count_nonzero(~known) > posture.joints_m.count(None):
        counters.reject("bad_joint", f"agent {posture.agent} at {posture.stamp_ns}: a joint not finite or absurdly far")
    depth_std_m = min(posture.depth_std_m or 0.0, FURTHEST_M)
    up_in_camera = LEVEL if posture.up_in_camera is None else tuple(posture.up_in_camera)
    return Body(ego_from_camera, joints_m, posture.frame != "world", depth_std_m, up_in_camera)


def _joints(joints: list[Joint]) -> Array:
    """Read joints; missing, non-finite and absurd ones become NaN."""
    read = np.array([MISSING if joint is None else joint for joint in joints], dtype=np.float64)
    read[~(np.abs(read) < FURTHEST_M).all(axis=1)] = np.nan
    return read
