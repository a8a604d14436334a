"""Where a frame lies in another, in plain numbers: a robot sends thousands a second, and NumPy takes several times as
long for three numbers.
"""

import math
from typing import NamedTuple

Vector = tuple[float, float, float]
Turn = tuple[float, float, float, float]

UNIT_TOLERANCE = 0.01
"""How far the length of a rotation's quaternion may be from 1: publishers round."""


class Placement(NamedTuple):
    """Where a child frame lies in its parent: its origin (m), and the rotation from its axes as a unit quaternion."""

    position_m: Vector = (0.0, 0.0, 0.0)
    xyzw: Turn = (0.0, 0.0, 0.0, 1.0)

    def of(self, inner: "Placement") -> "Placement":
        """Return, in this frame's parent, where a frame lies that is placed in this frame."""
        return Placement(self.at(inner.position_m), _product(self.xyzw, inner.xyzw))

    def at(self, point_m: Vector) -> Vector:
        """Return a point (m) of this frame in its parent's coordinates (m)."""
        x, y, z = rotated(self.xyzw, point_m)
        return x + self.position_m[0], y + self.position_m[1], z + self.position_m[2]

    def inverse(self) -> "Placement":
        """Return where the parent lies in this frame."""
        back = (-self.xyzw[0], -self.xyzw[1], -self.xyzw[2], self.xyzw[3])
        x, y, z = rotated(back, self.position_m)
        return Placement((-x, -y, -z), back)


def placement(position_m: Vector, xyzw: Turn, furthest_m: float) -> Placement | None:
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


def turned(axis: Vector, angle_rad: float) -> Turn:
    """Return the rotation about a unit axis by an angle."""
    half_sin = math.sin(angle_rad / 2)
    return axis[0] * half_sin, axis[1] * half_sin, axis[2] * half_sin, math.cos(angle_rad / 2)


def rotated(turn: Turn, vector: Vector) -> Vector:
    """Rotate a vector by a unit quaternion."""
    x, y, z, w = turn
    a, b, c = vector
    p, q, r = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p


def _product(one: Turn, other: Turn) -> Turn:
    a, b, c, d = one
    x, y, z, w = other
    return (
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    )
