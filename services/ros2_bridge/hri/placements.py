"""Where a frame lies in another."""

import math
from typing import NamedTuple

from ros2_bridge.rotations import Point, Quaternion, inverse, product, rotated

UNIT_TOLERANCE = 0.01
"""How far the length of a rotation's quaternion may be from 1: publishers round."""


class Placement(NamedTuple):
    """Where a child frame lies in its parent: its origin (m), and the rotation from its axes as a unit quaternion."""

    position_m: Point = (0.0, 0.0, 0.0)
    xyzw: Quaternion = (0.0, 0.0, 0.0, 1.0)

    def of(self, inner: "Placement") -> "Placement":
        """Return, in this frame's parent, where a frame lies that is placed in this frame."""
        return Placement(self.at(inner.position_m), product(self.xyzw, inner.xyzw))

    def at(self, point_m: Point) -> Point:
        """Return a point (m) of this frame in its parent's coordinates (m)."""
        x, y, z = rotated(self.xyzw, point_m)
        return x + self.position_m[0], y + self.position_m[1], z + self.position_m[2]

    def inverse(self) -> "Placement":
        """Return where the parent lies in this frame."""
        back = inverse(self.xyzw)
        x, y, z = rotated(back, self.position_m)
        return Placement((-x, -y, -z), back)


def placement(position_m: Point, xyzw: Quaternion, furthest_m: float) -> Placement | None:
    """Return a placement with the quaternion at unit length; None if it is no rotation or further away along an axis.

    Args:
        position_m: of the origin.
        xyzw: the quaternion as it was sent.
        furthest_m: the largest coordinate (m) that is taken.
    """
    length = math.hypot(*xyzw)
    if not abs(length - 1) <= UNIT_TOLERANCE or not all(abs(each) <= furthest_m for each in position_m):
        return None
    x, y, z, w = xyzw
    return Placement(position_m, (x / length, y / length, z / length, w / length))
