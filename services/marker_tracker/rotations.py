"""Rotations as matrices (3, 3) and as quaternions."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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


def apart_rad(one: Array, other: Array) -> float:
    """Angle between two rotations, of matrices that hold them in their upper left (3, 3)."""
    cosine = (float((one[:3, :3] * other[:3, :3]).sum()) - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def between(start: Array, end: Array, part: float) -> Array:
    """Turn from one rotation (3, 3) towards another by part of the angle between them."""
    turn = cv2.Rodrigues(np.ascontiguousarray(start.T @ end))[0]
    rotation: Array = start @ cv2.Rodrigues(part * turn)[0]
    return rotation
