"""Rigid transforms (4x4, `b_from_a` maps coordinates in a to coordinates in b) and the egocentric frame.

The egocentric frame is right-handed: x to the actor's left, y up along the trunk, z forward. The upright frame is
too, with y up along gravity and z horizontal. An unknown joint is NaN, and stays NaN.
"""

import math
from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX

SMALLEST_M = 1e-3
"""A shorter vector (m) has no defined direction."""
ROUNDING = float(np.finfo(np.float64).eps)
"""Part of a unit vector that may be nothing but rounding, and then has no defined direction either."""

Numbers = list[float]
_TRUNK = [INDEX[name] for name in ("right_hip", "left_hip", "torso", "right_shoulder", "left_shoulder", "neck")]
"""The joints on which the egocentric frame depends."""
RIGID_TOLERANCE = 1e-3
"""How far R Rᵀ of a rotation may be from the identity, per element: transforms are written with few decimals."""


class DegenerateError(ValueError):
    """Joints coincide or lie on one line, so that no frame or direction is defined."""


def is_rigid(transform: Array, furthest_m: float) -> bool:
    """Tell whether a matrix (4, 4) is a rigid transform that shifts by at most `furthest_m` along each axis.

    With plain numbers, since every posture is asked: NumPy takes several times as long.
    """
    *rows, last = transform.tolist()
    x, y, z = (row[:3] for row in rows)
    if last != [0, 0, 0, 1] or not all(abs(row[3]) <= furthest_m for row in rows):
        return False
    if not all(abs(each) <= 2 for each in (*x, *y, *z)):
        return False
    products = (_dot(x, x) - 1, _dot(y, y) - 1, _dot(z, z) - 1, _dot(x, y), _dot(y, z), _dot(z, x))
    return max(map(abs, products)) <= RIGID_TOLERANCE and _dot(cross(x, y), z) > 0


def invert(b_from_a: Array) -> Array:
    """Invert a rigid transform (4, 4)."""
    a_from_b = np.eye(4)
    a_from_b[:3, :3] = b_from_a[:3, :3].T
    a_from_b[:3, 3] = -b_from_a[:3, :3].T @ b_from_a[:3, 3]
    return a_from_b


def apply(b_from_a: Array, points_a: Array) -> Array:
    """Map points of shape (…, n, 3), or one of shape (3,), from frame a to frame b; transforms are (…, 4, 4)."""
    mapped: Array = points_a @ np.swapaxes(b_from_a[..., :3, :3], -1, -2)
    offset = b_from_a[..., :3, 3]
    return mapped + (offset if mapped.ndim == 1 else offset[..., None, :])


def quaternion_xyzw(rotation: Array) -> list[float]:
    """Return a rotation matrix (3, 3) as a unit quaternion [x, y, z, w] with w >= 0.

    Each row below is the quaternion times four times one of its components; the largest of these is exact (Shepperd
    1978).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    rows = (
        (1 + xx - yy - zz, yx + xy, zx + xz, zy - yz),
        (yx + xy, 1 + yy - xx - zz, zy + yz, xz - zx),
        (zx + xz, zy + yz, 1 + zz - xx - yy, yx - xy),
        (zy - yz, xz - zx, yx - xy, 1 + xx + yy + zz),
    )
    x, y, z, w = rows[max(range(4), key=lambda i: rows[i][i])]
    length = math.copysign(math.sqrt(x * x + y * y + z * z + w * w), w)
    return [x / length, y / length, z / length, w / length]


def angle_between_rad(one: Array, other: Array) -> float:
    """Return the angle (rad) between two rotations (3, 3), or between those of two transforms (4, 4)."""
    cosine = (float(np.vdot(one[:3, :3], other[:3, :3])) - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def rotated_xyzw(b_from_a: Array, quaternion_xyzw_a: Array) -> Array:
    """Return in frame b an orientation given in frame a, both unit quaternions (4,), by a rigid transform (4, 4)."""
    x, y, z, w = quaternion_xyzw(b_from_a[:3, :3])
    left_product = np.array([[w, -z, y, x], [z, w, -x, y], [-y, x, w, z], [-x, -y, -z, w]])
    rotated: Array = left_product @ quaternion_xyzw_a
    return rotated


def flat(transform: Array) -> list[float]:
    """Return the 16 numbers of a transform (4, 4), row-major."""
    numbers: list[float] = transform.ravel().tolist()
    return numbers


def from_flat(numbers: Sequence[float]) -> Array:
    """Return the transform (4, 4) of 16 numbers, row-major."""
    return np.array(numbers, dtype=np.float64).reshape(4, 4)


def ego_from_camera(joints: Array) -> Array:
    """Build the paper's egocentric frame from hips and torso (section 2.1, figure 3).

    The origin is the projection of the torso on the line through the hips; the axes lie along the hip line,
    from the origin to the torso, and along the normal of their plane. Where a hip is unknown, the line through the
    shoulders, moved down along the trunk, replaces that through the hips.

    Args:
        joints: (…, 15, 3) in any right-handed frame, here called camera. The torso must be known, and either both
            hips or both shoulders and the neck.

    Returns:
        The transforms, (…, 4, 4).

    Raises:
        DegenerateError: the hips, or the shoulders in their place, coincide, or the torso lies on their line.
    """
    bodies = joints[..., _TRUNK, :].reshape(-1, len(_TRUNK), 3).tolist()
    rows = np.array([_axes_and_origin(*body) for body in bodies]).reshape(*joints.shape[:-2], 4, 3)
    ego = np.zeros((*joints.shape[:-2], 4, 4))
    ego[..., :3, :3] = axes = rows[..., :3, :]
    ego[..., :3, 3] = -(axes @ rows[..., 3, :, None])[..., 0]
    ego[..., 3, 3] = 1.0
    return ego


def _axes_and_origin(
    right_hip: Numbers,
    left_hip: Numbers,
    torso: Numbers,
    right_shoulder: Numbers,
    left_shoulder: Numbers,
    neck: Numbers,
) -> list[Numbers]:
    """Return one body's axes and their origin.

    With plain numbers: an array of three costs more than what is done with it.
    """
    if math.isnan(right_hip[0] + left_hip[0]):
        right_hip, left_hip = _hips_from_shoulders(right_shoulder, left_shoulder, neck, torso)
    left = _unit(
        [end - start for end, start in zip(left_hip, right_hip, strict=True)],
        "both hips, or both shoulders in place of missing hips, lie at one point",
    )
    terms = [(t - r) * x for t, r, x in zip(torso, right_hip, left, strict=True)]
    along = terms[0] + terms[1] + terms[2]
    origin = [r + along * x for r, x in zip(right_hip, left, strict=True)]
    up = _unit([t - o for t, o in zip(torso, origin, strict=True)], "the torso lies on the line through both hips")
    return [left, up, cross(left, up), origin]


def cross(one: Sequence[float], other: Sequence[float]) -> Numbers:
    """Return the cross product of two vectors of three plain numbers, as `np.cross` computes it."""
    (x, y, z), (u, v, w) = one, other
    return [y * w - z * v, z * u - x * w, x * v - y * u]


def _dot(one: Sequence[float], other: Sequence[float]) -> float:
    (x, y, z), (u, v, w) = one, other
    return x * u + y * v + z * w


def upright(joints: Array, left_x: float, left_z: float) -> Array:
    """Express joints (15, 3) relative to the torso, along the actor's left, up (camera -y) and forward = left x up.

    Args:
        joints: in the frame of a level camera.
        left_x: the component along camera x of the horizontal unit vector to the actor's left.
        left_z: its component along camera z.
    """
    upright_from_camera = np.array([[left_x, 0.0, left_z], [0.0, -1.0, 0.0], [left_z, 0.0, -left_x]])
    result: Array = (joints - joints[INDEX["torso"]]) @ upright_from_camera.T
    return result


def untilted_from_camera(up_in_camera: Sequence[float]) -> Array:
    """Return the rotation (3, 3) that turns the up vector (3,), of any length, to -y, where a level camera has it.

    It undoes the roll about the line of sight, then the pitch about x, so that the line of sight keeps x = 0 and
    z > 0 for any mounting. A camera that looks straight up or down, within rounding, has no roll to undo.
    """
    x, y, z = _unit_of_any_length(up_in_camera)
    across = math.hypot(x, y)
    sin_roll, cos_roll = (-x / across, -y / across) if across > ROUNDING else (0.0, 1.0)
    unrolled = np.array([[cos_roll, -sin_roll, 0.0], [sin_roll, cos_roll, 0.0], [0.0, 0.0, 1.0]])
    unpitched = np.array([[1.0, 0.0, 0.0], [0.0, across, -z], [0.0, z, across]])
    untilted: Array = unpitched @ unrolled
    return untilted


def _unit_of_any_length(vector: Sequence[float]) -> Array:
    """Return a vector's direction (3,), also where its squares or its length are too large or too small for a float."""
    _, exponent = math.frexp(max(map(abs, vector)))
    near_1 = [math.ldexp(component, -exponent) for component in vector]
    return np.array(near_1) / math.hypot(*near_1)


def _hips_from_shoulders(right: Numbers, left: Numbers, neck: Numbers, torso: Numbers) -> tuple[Numbers, Numbers]:
    """Return replacements of the right and the left hip, from shoulders, neck and torso.

    The shoulders are moved along the trunk, as far below the torso as the neck is above it: 0.24 m for standard
    bones, where the hips are. Of the line between them only the direction matters.
    """
    middle = [2 * t - n for t, n in zip(torso, neck, strict=True)]
    half = [(end - start) / 2 for end, start in zip(left, right, strict=True)]
    return [m - h for m, h in zip(middle, half, strict=True)], [m + h for m, h in zip(middle, half, strict=True)]


def _unit(vector: Numbers, problem: str) -> Numbers:
    """Return a vector at unit length; `problem` is the error's text where it is too short."""
    length = math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2])
    if length < SMALLEST_M:
        raise DegenerateError(problem)
    return [component / length for component in vector]
