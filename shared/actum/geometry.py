"""Rigid transforms (4x4, `b_from_a` maps coordinates in a to coordinates in b) and the egocentric frame.

The egocentric frame is right-handed: x to the actor's left, y up along the trunk, z forward. The upright frame is
too, with y up along gravity and z horizontal. An unknown joint is NaN, and stays NaN.
"""

import math
from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum.skeletons import INDEX

BONES: tuple[tuple[int, int, float], ...] = tuple(
    (INDEX[parent], INDEX[child], length_m)
    for parent, child, length_m in (
        ("torso", "neck", 0.24),
        ("neck", "head", 0.20),
        ("neck", "left_shoulder", 0.18),
        ("left_shoulder", "left_elbow", 0.28),
        ("left_elbow", "left_hand", 0.32),
        ("neck", "right_shoulder", 0.18),
        ("right_shoulder", "right_elbow", 0.28),
        ("right_elbow", "right_hand", 0.32),
        ("torso", "left_hip", 0.26),
        ("left_hip", "left_knee", 0.42),
        ("left_knee", "left_foot", 0.44),
        ("torso", "right_hip", 0.26),
        ("right_hip", "right_knee", 0.42),
        ("right_knee", "right_foot", 0.44),
    )
)
"""The skeleton as a tree walked out from the torso: parent, child, standard length in metres."""

_PARENTS = np.array([parent for parent, _, _ in BONES])
"""Where each bone begins: joints (14,)."""
_CHILDREN = np.array([child for _, child, _ in BONES])
"""Where each bone ends: joints (14,)."""
_LENGTHS_M = np.array([length for _, _, length in BONES])
"""Standard lengths (m): (14,)."""
SMALLEST_M = 1e-3
"""What is shorter has no direction."""
ROUNDING = float(np.finfo(np.float64).eps)
"""What is smaller beside 1 may be nothing but rounding, and has no direction either."""

_NEXT = [1, 2, 0]
"""The axis after x, y, z in a cross product …"""
_LAST = [2, 0, 1]
"""… and the one before."""


def _walk() -> Array:
    """Tell by ones which bones lead from the torso to each joint: (15, 14)."""
    walk = np.zeros((len(INDEX), len(BONES)))
    for bone, (parent, child, _) in enumerate(BONES):
        walk[child] = walk[parent]
        walk[child, bone] = 1.0
    return walk


_WALK = _walk()
"""Which bones lead from the torso to each joint: (15, 14)."""


RIGID_TOLERANCE = 1e-3
"""How far the products of a rotation's rows may be from 0 and 1: transforms come with few decimals."""


class DegenerateError(ValueError):
    """Joints coincide or lie in line, so that no frame or direction is defined."""


def is_rigid(transform: Array, furthest_m: float) -> bool:
    """Tell whether (4, 4) is a rotation and a shift by no more than that in each axis, with 0 0 0 1 below them."""
    rotation, shift_m = transform[:3, :3], transform[:3, 3]
    if not np.isfinite(transform).all() or np.abs(rotation).max() > 2 or np.abs(shift_m).max() > furthest_m:
        return False
    orthogonal = np.allclose(rotation @ rotation.T, np.eye(3), atol=RIGID_TOLERANCE)
    return bool(orthogonal and np.linalg.det(rotation) > 0 and np.array_equal(transform[3], (0, 0, 0, 1)))


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
    """Turn a rotation matrix (3, 3) into a unit quaternion with w >= 0 (Bar-Itzhack 2000)."""
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    symmetric = np.array(
        [
            [xx - yy - zz, yx + xy, zx + xz, zy - yz],
            [yx + xy, yy - xx - zz, zy + yz, xz - zx],
            [zx + xz, zy + yz, zz - xx - yy, yx - xy],
            [zy - yz, xz - zx, yx - xy, xx + yy + zz],
        ]
    )
    quaternion = np.linalg.eigh(symmetric).eigenvectors[:, -1]
    listed: list[float] = (np.copysign(1.0, quaternion[3]) * quaternion).tolist()
    return listed


def angle_between_rad(one: Array, other: Array) -> float:
    """Return the angle between two rotations (3, 3), or between those of two transforms (4, 4)."""
    cosine = (float((one[:3, :3] * other[:3, :3]).sum()) - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def rotated_xyzw(b_from_a: Array, quaternion_xyzw_a: Array) -> Array:
    """Turn an orientation (4,), a unit quaternion, from frame a to frame b by a rigid transform (4, 4)."""
    x, y, z, w = quaternion_xyzw(b_from_a[:3, :3])
    by = np.array([[w, -z, y, x], [z, w, -x, y], [-y, x, w, z], [-x, -y, -z, w]])
    turned: Array = by @ quaternion_xyzw_a
    return turned


def flat(transform: Array) -> list[float]:
    """Write a transform (4, 4) as its 16 numbers, row-major."""
    numbers: list[float] = transform.ravel().tolist()
    return numbers


def from_flat(numbers: list[float]) -> Array:
    """Read a transform (4, 4) from its 16 numbers, row-major."""
    return np.array(numbers, dtype=np.float64).reshape(4, 4)


def ego_from_camera(joints: Array) -> Array:
    """Build the paper's egocentric frame from hips and torso (section 2.1, figure 3).

    The origin is the projection of the torso on the line through the hips; the axes lie along the hip line,
    from the origin to the torso, and along the normal of their plane. Where a hip is unknown, the shoulders' line
    moved down along the trunk stands in for the hips'.

    Args:
        joints: (…, 15, 3) in any right-handed frame, here called camera; the result is (…, 4, 4). Torso, and either
            both hips or both shoulders and neck are known.

    Raises:
        DegenerateError: the hips, or the shoulders in their place, coincide, or the torso lies on their line.
    """
    right_hip, left_hip, torso = (joints[..., INDEX[name], :] for name in ("right_hip", "left_hip", "torso"))
    unknown = np.isnan(right_hip + left_hip)
    if unknown.any():
        right, left = _below(joints)
        right_hip, left_hip = np.where(unknown, right, right_hip), np.where(unknown, left, left_hip)
    left = _unit(left_hip - right_hip, "the hips, or the shoulders in their place, coincide")
    origin = right_hip + ((torso - right_hip) * left).sum(axis=-1, keepdims=True) * left
    up = _unit(torso - origin, "the torso lies on the line through the hips")
    ego = np.zeros((*joints.shape[:-2], 4, 4))
    ego[..., 0, :3], ego[..., 1, :3], ego[..., 2, :3] = left, up, _cross(left, up)
    ego[..., :3, 3] = -(ego[..., :3, :3] @ origin[..., None])[..., 0]
    ego[..., 3, 3] = 1.0
    return ego


def scaled(joints: Array) -> Array:
    """Give each bone its standard length, keeping its direction, walking out from the torso.

    A joint is known in the result where every joint on its way from the torso is.

    Args:
        joints: (15, 3); the torso is known.

    Raises:
        DegenerateError: a bone has no length, so that its direction is undefined.
    """
    bones = joints[_CHILDREN] - joints[_PARENTS]
    lengths = np.sqrt(np.einsum("ij,ij->i", bones, bones))
    if np.fmin.reduce(lengths) < SMALLEST_M:
        raise DegenerateError("two joined joints coincide")
    standard = bones * (_LENGTHS_M / lengths)[:, None]
    walked = _walked_where_known(standard) if math.isnan(lengths.sum()) else _WALK @ standard
    result: Array = joints[INDEX["torso"]] + walked
    return result


def upright(joints: Array, left_x: float, left_z: float) -> Array:
    """Express joints (15, 3) relative to the torso, along the actor's left, up (camera -y) and forward = left x up.

    Args:
        joints: in the frame of a level camera.
        left_x: of the horizontal unit vector to the actor's left, along camera x.
        left_z: of the same, along camera z.
    """
    upright_from_camera = np.array([[left_x, 0.0, left_z], [0.0, -1.0, 0.0], [left_z, 0.0, -left_x]])
    result: Array = (joints - joints[INDEX["torso"]]) @ upright_from_camera.T
    return result


def untilted_from_camera(up_in_camera: Sequence[float]) -> Array:
    """Return the rotation (3, 3) after which up (3,), of any length, is -y, as for a level camera.

    It undoes the roll about the line of sight, then the pitch about x: the line of sight stays forward, x = 0 and
    z > 0, however the camera hangs. One that looks straight up or down, but for rounding, has no roll; none is undone.
    """
    x, y, z = _unit_of_any_length(up_in_camera)
    across = math.hypot(x, y)
    sin_roll, cos_roll = (-x / across, -y / across) if across > ROUNDING else (0.0, 1.0)
    unrolled = np.array([[cos_roll, -sin_roll, 0.0], [sin_roll, cos_roll, 0.0], [0.0, 0.0, 1.0]])
    unpitched = np.array([[1.0, 0.0, 0.0], [0.0, across, -z], [0.0, z, across]])
    untilted: Array = unpitched @ unrolled
    return untilted


def _unit_of_any_length(vector: Sequence[float]) -> Array:
    """Return a vector's direction, also where its squares or its length are too large or too small for a float."""
    _, exponent = math.frexp(max(map(abs, vector)))
    near_1 = [math.ldexp(component, -exponent) for component in vector]
    return np.array(near_1) / math.hypot(*near_1)


def _walked_where_known(bones: Array) -> Array:
    unknown = np.isnan(bones[:, 0])
    walked: Array = _WALK @ np.where(unknown[:, None], 0.0, bones)
    walked[_WALK @ unknown > 0] = np.nan
    return walked


def _below(joints: Array) -> tuple[Array, Array]:
    """Move the right and the left shoulder down the trunk, as far below the torso as the neck is above it.

    That is 0.24 m for the standard bones, where hips are; of their distance only the direction matters.
    """
    names = ("right_shoulder", "left_shoulder", "neck", "torso")
    right, left, neck, torso = (joints[..., INDEX[name], :] for name in names)
    middle, half = 2 * torso - neck, (left - right) / 2
    return middle - half, middle + half


def _unit(vectors: Array, problem: str) -> Array:
    lengths: Array = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    if lengths.min() < SMALLEST_M:
        raise DegenerateError(problem)
    return vectors / lengths


def _cross(a: Array, b: Array) -> Array:
    product: Array = a[..., _NEXT] * b[..., _LAST] - a[..., _LAST] * b[..., _NEXT]
    return product
