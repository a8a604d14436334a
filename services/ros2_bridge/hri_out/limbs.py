"""Angles of a body's joints by the human model of ROS4HRI, from the directions of its bones.

The model is human_description's `urdf/human-tpl.xacro` (2.0.2). Its axes are the body's: x forward, y left, z up. Limbs
hang along -z where all angles are 0. A shoulder turns about z, x and z of the upper arm, a hip about z, x and y of the
thigh, elbows and knees about -y, and the head about x and -y. Axes that the model mirrors have the sign of the side.
"""

import math
from dataclasses import dataclass, field

from ros2_bridge.rotations import (
    X_AXIS,
    Y_AXIS,
    Z_AXIS,
    Quaternion,
    Vector,
    about,
    dot,
    inverse,
    product,
    rotated,
)

SIDES = {"l": 1.0, "r": -1.0}
"""The model's prefix of each side, and the sign of the axes that it mirrors (`reflect`)."""
LEAST_BENT = math.sin(math.radians(10))
"""Sine of the least bend of a knee by which the thigh's twist is told: at less, 2 cm of noise turn it by 15 degrees."""
LEAST_TWIST = math.sin(math.radians(3))
"""Sine of the least bend of an elbow by which the upper arm's twist is told."""
GIMBAL_LOCK = 1e-9
"""Sine of the angle between a knee's axis and the vertical below which the hip's first and last joint turn alike."""
SHOULDER_YAW_RAD = (-1.1, 1.9)
"""Limits of the model's first shoulder joint (rad): of the two solutions, the one within them is taken."""
LEAST_SHOULDER_PITCH_RAD = -0.4
"""The lower limit of its second (rad)."""


@dataclass
class Limb:
    """A limb's known angles (rad), and the orientations of its links, by the model's names without id."""

    angles: dict[str, float] = field(default_factory=dict)
    turned: dict[str, Quaternion] = field(default_factory=dict)


def arm(side: str, upper: Vector | None, fore: Vector | None) -> Limb:
    """Return an arm's angles; `upper` and `fore` are unit vectors towards the hand, None where unknown."""
    limb, sign = Limb(), SIDES[side]
    if upper is None:
        return limb
    yaw, pitch = _shoulder(upper, sign)
    shoulder = product(about(Z_AXIS, -sign * yaw), about(X_AXIS, sign * pitch))
    limb.angles |= {f"{side}_y_shoulder": yaw, f"{side}_p_shoulder": pitch}
    if fore is not None:
        x, y, z = rotated(inverse(shoulder), fore)
        bend = math.atan2(math.hypot(x, y), -z)
        if math.sin(bend) > LEAST_TWIST:
            twist = math.atan2(y, x)
            limb.angles[f"{side}_r_shoulder"] = sign * twist
            shoulder = product(shoulder, about(Z_AXIS, twist))
        limb.angles[f"{side}_elbow"] = bend
        limb.turned |= dict.fromkeys((f"{side}_elbow", f"{side}_wrist"), product(shoulder, about(Y_AXIS, -bend)))
    limb.turned[f"{side}_shoulder"] = shoulder
    return limb


def _shoulder(upper: Vector, sign: float) -> tuple[float, float]:
    """Return the angles about z and x (rad) that point an upper arm; where it hangs or is raised, the first is 0."""
    x, y, z = upper
    raised = math.hypot(x, y)
    if raised < LEAST_TWIST:
        aside = math.asin(sign * y)
        return 0.0, aside if z < 0 else math.pi - aside
    yaw, pitch = math.atan2(x, sign * y), math.atan2(raised, -z)
    least, most = SHOULDER_YAW_RAD
    if not least <= yaw <= most and -pitch >= LEAST_SHOULDER_PITCH_RAD:
        return yaw - math.copysign(math.pi, yaw), -pitch
    return yaw, pitch


def leg(side: str, thigh: Vector | None, shank: Vector | None) -> Limb:
    """Return a leg's angles; `thigh` and `shank` are unit vectors towards the foot, None where unknown.

    The thigh's twist is 0 where the knee is too straight to tell.
    """
    limb, sign = Limb(), SIDES[side]
    if thigh is None:
        return limb
    left = None if shank is None else _knee_axis(thigh, shank)
    yaw, pitch, roll = _hip(thigh, left)
    limb.angles |= {f"{side}_y_hip": -yaw, f"{side}_p_hip": sign * pitch, f"{side}_r_hip": -roll}
    hip = product(product(about(Z_AXIS, yaw), about(X_AXIS, pitch)), about(Y_AXIS, roll))
    limb.turned[f"{side}_hip"] = hip
    if shank is not None:
        bend = math.acos(max(-1.0, min(1.0, dot(thigh, shank)))) if left else 0.0
        limb.angles[f"{side}_knee"] = -bend
        limb.turned |= dict.fromkeys((f"{side}_knee", f"{side}_ankle"), product(hip, about(Y_AXIS, bend)))
    return limb


def _knee_axis(thigh: Vector, shank: Vector) -> Vector | None:
    """Return the unit vector about which a shank is bent backwards; None where it is too straight to tell."""
    across = _cross(thigh, shank)
    length = math.hypot(*across)
    return None if length < LEAST_BENT else [each / length for each in across]


def _hip(thigh: Vector, left: Vector | None) -> tuple[float, float, float]:
    """Return the angles about z, x and y (rad) that turn a hanging thigh, its axis to the left included if known."""
    up = [-each for each in thigh]
    if left is None:
        return 0.0, math.atan2(-up[1], up[2]), math.asin(max(-1.0, min(1.0, up[0])))
    forward = _cross(left, up)
    pitch = math.asin(max(-1.0, min(1.0, left[2])))
    if math.hypot(left[0], left[1]) < GIMBAL_LOCK:
        return math.atan2(forward[1], forward[0]), pitch, 0.0
    return math.atan2(-left[0], left[1]), pitch, math.atan2(-forward[2], up[2])


def head(direction: Vector | None) -> Limb:
    """Return the head's angles from the unit vector from the neck to it; where it looks, about z, is not observed."""
    limb = Limb()
    if direction is not None:
        x, y, z = direction
        roll, back = math.atan2(-y, z), -math.asin(max(-1.0, min(1.0, x)))
        limb.angles |= {"r_head": roll, "p_head": back}
        limb.turned["head"] = product(about(X_AXIS, roll), about(Y_AXIS, -back))
    return limb


def _cross(one: Vector, other: Vector) -> Vector:
    ax, ay, az = one
    bx, by, bz = other
    return [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
