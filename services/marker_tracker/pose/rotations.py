"""Rotations as matrices (3, 3)."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def apart_rad(one: Array, other: Array) -> float:
    """Angle between two rotations, of matrices that hold them in their upper left (3, 3)."""
    cosine = (float((one[:3, :3] * other[:3, :3]).sum()) - 1) / 2
    return math.acos(min(1.0, max(-1.0, cosine)))


def between(start: Array, end: Array, part: float) -> Array:
    """Turn from one rotation (3, 3) towards another by part of the angle between them."""
    turn = cv2.Rodrigues(np.ascontiguousarray(start.T @ end))[0]
    rotation: Array = start @ cv2.Rodrigues(part * turn)[0]
    return rotation
