"""Stamps, headers, poses and transforms in ROS's terms.

The camera frame of our messages, x right, y down, z forward, is what ROS calls an optical frame (REP 103), so its
coordinates go over unchanged. Bodies, of people as of robots, have x forward, y left and z up in ROS.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from actum import geometry
from actum.arrays import Array
from actum.node import SECOND_NS
from ros2_bridge.message_types import made

LINK_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Turns x right, y down, z forward to x forward, y left, z up: (3, 3)."""
BODY_FROM_EGO = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Turns the egocentric frame's x left, y up, z forward to x forward, y left, z up: (3, 3)."""
LATEST_NS = 2**31 * SECOND_NS
"""ROS counts seconds in 32 bits: the first stamp (ns) that it has no number for."""


def ros_time(stamp_ns: int) -> Any:
    """Return a builtin_interfaces/Time of a stamp before `LATEST_NS`."""
    return made("builtin_interfaces/msg/Time", sec=stamp_ns // SECOND_NS, nanosec=stamp_ns % SECOND_NS)


def header(stamp_ns: int, frame_id: str) -> Any:
    """Return a std_msgs/Header."""
    return made("std_msgs/msg/Header", stamp=ros_time(stamp_ns), frame_id=frame_id)


def vector(xyz: Sequence[float] | Array, kind: str = "Vector3") -> Any:
    """Return three numbers as a geometry_msgs/Vector3, or as a `Point`."""
    x, y, z = xyz
    return made(f"geometry_msgs/msg/{kind}", x=float(x), y=float(y), z=float(z))


def quaternion(xyzw: Sequence[float]) -> Any:
    """Return four numbers as a geometry_msgs/Quaternion."""
    x, y, z, w = map(float, xyzw)
    return made("geometry_msgs/msg/Quaternion", x=x, y=y, z=z, w=w)


def pose(position_m: Sequence[float] | Array, quaternion_xyzw: Sequence[float] | None) -> Any:
    """Return a geometry_msgs/Pose, with no rotation where that is None."""
    orientation = quaternion(quaternion_xyzw or (0, 0, 0, 1))
    return made("geometry_msgs/msg/Pose", position=vector(position_m, "Point"), orientation=orientation)


def transform(
    of: Any, child: str, position_m: Sequence[float] | Array = (0, 0, 0), rotation: Array | None = None
) -> Any:
    """Return a geometry_msgs/TransformStamped: where a child frame lies in the frame of the header `of`.

    Args:
        of: the std_msgs/Header.
        child: the child frame's name.
        position_m: of its origin, in the frame of the header.
        rotation: (3, 3), from the child's axes to those of the frame of the header; None where they are the same.
    """
    xyzw = (0, 0, 0, 1) if rotation is None else geometry.quaternion_xyzw(rotation)
    return transform_xyzw(of, child, position_m, xyzw)


def transform_xyzw(of: Any, child: str, position_m: Sequence[float] | Array, xyzw: Sequence[float]) -> Any:
    """Return the same, turned by a unit quaternion."""
    placed = made("geometry_msgs/msg/Transform", translation=vector(position_m), rotation=quaternion(xyzw))
    return made("geometry_msgs/msg/TransformStamped", header=of, child_frame_id=child, transform=placed)


def optical_from_body(joints: Array) -> Array | None:
    """Return the transform (4, 4) from a person's frame, x forward, y left, z up, to the camera's.

    Args:
        joints: (15, 3), camera frame, NaN where unknown.

    Returns:
        None where the known joints do not determine how the body stands.
    """
    try:
        ego_from_optical = geometry.ego_from_camera(joints)
    except geometry.DegenerateError:
        return None
    if not np.isfinite(ego_from_optical).all():
        return None
    body_from_ego = np.eye(4)
    body_from_ego[:3, :3] = BODY_FROM_EGO
    return geometry.invert(body_from_ego @ ego_from_optical)


def optical_from_level(up_in_camera: Sequence[float] | None) -> Array:
    """Return the rotation (3, 3) from level axes, x along the line of sight, y left, z against gravity."""
    untilted_from_optical = geometry.untilted_from_camera(up_in_camera or (0, -1, 0))
    level_from_optical: Array = LINK_FROM_OPTICAL @ untilted_from_optical
    return level_from_optical.T
