"""Vectors, and rotations as unit quaternions x, y, z, w, in plain numbers.

A robot sends thousands of them a second, and NumPy takes several times as long for three numbers.
"""

import math
from collections.abc import Sequence

Vector = Sequence[float]
Point = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

X_AXIS: Point = (1.0, 0.0, 0.0)
Y_AXIS: Point = (0.0, 1.0, 0.0)
Z_AXIS: Point = (0.0, 0.0, 1.0)
NOT_TURNED: Quaternion = (0.0, 0.0, 0.0, 1.0)


def about(axis: Vector, angle_rad: float) -> Quaternion:
    """Return the rotation about a unit axis by an angle."""
    half_sin = math.sin(angle_rad / 2)
    return axis[0] * half_sin, axis[1] * half_sin, axis[2] * half_sin, math.cos(angle_rad / 2)


def product(one: Quaternion, other: Quaternion) -> Quaternion:
    """Return the rotation `one` after `other`."""
    ax, ay, az, aw = one
    bx, by, bz, bw = other
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def inverse(rotation: Quaternion) -> Quaternion:
    """Return the rotation back."""
    x, y, z, w = rotation
    return -x, -y, -z, w


def rotated(rotation: Quaternion, vector: Vector) -> Point:
    """Return a vector turned by a rotation."""
    x, y, z, w = rotation
    a, b, c = vector
    p, q, r = 2 * (y * c - z * b), 2 * (z * a - x * c), 2 * (x * b - y * a)
    return a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p


def dot(one: Vector, other: Vector) -> float:
    """Return the scalar product."""
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]
