"""Whether a body stands, sits, crouches or lies: by the angles of trunk and legs against gravity, and the hips' level.

A person who squats with the thighs level and one who sits differ only by the chair, which no joint shows: the hips'
level decides. Whatever fits no word, or lacks a leg, is OTHER.
"""

import math
from collections.abc import Sequence

from actum.arrays import Array
from actum.skeletons import INDEX
from ros2_bridge.rotations import Vector, dot

OTHER, STANDING, SITTING, CROUCHING, LAYING = range(5)
"""The constants of hri_msgs/BodyPosture."""

LYING_TRUNK_DEG = 60.0
"""Least angle of the trunk from the vertical (degrees) of who lies; who bows that far has the legs upright."""
UPRIGHT_DEG = 45.0
"""Most angle of the trunk from the vertical (degrees) of who stands or sits."""
HANGING_DEG = 35.0
"""Most angle of the thighs from hanging (degrees) of who stands, also in a step."""
STRAIGHT_DEG = 45.0
"""Most bend of the knees (degrees) of who stands."""
SEATED_THIGH_DEG = 42.0
"""Least angle of the thighs from hanging (degrees) of who sits. Cameras put the hips of who sits too high: in the
recordings of UTKinect's people 1 to 5, who sit on chairs, the angle is 46 to 57 degrees."""
CROUCHED_KNEE_DEG = 80.0
"""Least bend of the knees (degrees) of who crouches."""
LOW_HIPS = 0.6
"""Most height of the hips above the feet, in lengths of the shank, of who crouches; seats are higher."""

_LEGS = [tuple(INDEX[f"{side}_{joint}"] for joint in ("hip", "knee", "foot")) for side in ("left", "right")]
"""Indices of hip, knee and foot, left and right."""


def posture_of(joints: Array, up_in_camera: Sequence[float] | None) -> int:
    """Return the constant of hri_msgs/BodyPosture for joints (15, 3; m, camera frame, NaN where unknown).

    One leg is enough. `up_in_camera` is any vector against gravity, None for a level camera.
    """
    points = joints.tolist()
    legs = [[points[i] for i in leg] for leg in _LEGS]
    whole = [leg for leg in legs if all(map(math.isfinite, (*leg[0], *leg[1], *leg[2])))]
    trunk = _between(_middle(legs[0][0], legs[1][0]), points[INDEX["neck"]])
    if not whole or not all(map(math.isfinite, trunk)):
        return OTHER
    hip, knee, foot = (_middle(whole[0][i], whole[-1][i]) for i in range(3))
    return _named(trunk, _between(hip, knee), _between(knee, foot), up_in_camera or (0.0, -1.0, 0.0))


def _named(trunk: Vector, thigh: Vector, shank: Vector, up: Vector) -> int:
    """Return the posture of a trunk, and of the mean thigh and shank, as vectors from the hips up and down (m)."""
    down = [-each / math.hypot(*up) for each in up]
    tilt, hanging, bend = 180 - _angle_deg(trunk, down), _angle_deg(thigh, down), _angle_deg(thigh, shank)
    hips = (dot(thigh, down) + dot(shank, down)) / max(math.hypot(*shank), 1e-6)
    if tilt >= LYING_TRUNK_DEG:
        return LAYING if hips < LOW_HIPS and hanging >= HANGING_DEG else OTHER
    if tilt <= UPRIGHT_DEG and hanging <= HANGING_DEG and bend <= STRAIGHT_DEG:
        return STANDING
    if bend >= CROUCHED_KNEE_DEG and hips < LOW_HIPS:
        return CROUCHING
    if tilt <= UPRIGHT_DEG and hanging >= SEATED_THIGH_DEG and hips >= LOW_HIPS:
        return SITTING
    return OTHER


def _angle_deg(one: Vector, other: Vector) -> float:
    """Return the angle between two vectors (degrees)."""
    lengths = max(math.hypot(*one) * math.hypot(*other), 1e-9)
    return math.degrees(math.acos(max(-1.0, min(1.0, dot(one, other) / lengths))))


def _between(start: Vector, end: Vector) -> Vector:
    return [end[0] - start[0], end[1] - start[1], end[2] - start[2]]


def _middle(one: Vector, other: Vector) -> Vector:
    return [(one[0] + other[0]) / 2, (one[1] + other[1]) / 2, (one[2] + other[2]) / 2]
