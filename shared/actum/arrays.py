"""Names of NumPy's array types by element type, and the conversion between lists of joints and arrays."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.messages import Joint

Array = NDArray[np.float64]
"""Real numbers in double precision; NaN stands for an unknown one."""
Floats = NDArray[Any]
"""Real numbers of either precision: single where BLAS is to be fast."""
Mask = NDArray[np.bool_]
"""A Boolean for each element of another array."""
Indices = NDArray[np.intp]
"""Indices into another array."""
Pixels = NDArray[np.uint8]
"""Grey levels or colours, 0 to 255."""

UNKNOWN = (math.nan, math.nan, math.nan)
"""The position of a missing joint."""


def joints_to_array(joints: Sequence[Joint]) -> Array:
    """Return a message's joints as an array (joints, 3), NaN where one is missing."""
    if None not in joints:
        return np.array(joints, dtype=np.float64)
    return np.array([UNKNOWN if joint is None else joint for joint in joints], dtype=np.float64)


def joints_to_list(joints: Array) -> list[Joint]:
    """Return joints (joints, 3) as the list that a message holds, None where one is NaN."""
    listed: list[Joint] = joints.tolist()
    if math.isnan(joints.sum()):
        return [None if unknown else joint for joint, unknown in zip(listed, np.isnan(joints[:, 0]), strict=True)]
    return listed
