"""Names of NumPy's array types by element type, and the conversion between lists of joints and arrays."""

import math
from collections.abc import Sequence
from typing import Any, cast

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


def stacked(arrays: Sequence[Array], *shape: int) -> Array:
    """Stack arrays of one shape, perhaps none, into one of shape (len(arrays), *shape), which cannot be written to.

    By their bytes: `np.stack` takes ten times as long for arrays as small as a posture.
    """
    return np.frombuffer(b"".join(cast("Sequence[bytes]", arrays)), np.float64).reshape(len(arrays), *shape)


def median(values: Array) -> Array:
    """Return the median over the first axis of at least one row of known numbers.

    By sorting: `np.median` takes several times as long for the few rows of a movement.
    """
    rising = np.sort(values, axis=0)
    middle: Array = (rising[(len(rising) - 1) // 2] + rising[len(rising) // 2]) / 2
    return middle


def has_unknown(numbers: Floats) -> bool:
    """Tell whether a number is NaN.

    By the sum of squares, in which infinite numbers do not cancel: `np.isnan(numbers).any()` takes twice as long.
    """
    return math.isnan(np.vdot(numbers, numbers))


def joints_to_array(joints: Sequence[Joint]) -> Array:
    """Return a message's joints as an array (joints, 3), NaN where one is missing."""
    if None not in joints:
        return np.array(joints, dtype=np.float64)
    return np.array([UNKNOWN if joint is None else joint for joint in joints], dtype=np.float64)


def joints_to_list(joints: Array) -> list[Joint]:
    """Return joints (joints, 3) as the list that a message holds, None where one is NaN."""
    listed: list[Joint] = joints.tolist()
    if has_unknown(joints):
        return [None if unknown else joint for joint, unknown in zip(listed, np.isnan(joints[:, 0]), strict=True)]
    return listed
