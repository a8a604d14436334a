"""Rotation matrices from the quaternions of messages."""

from collections.abc import Sequence
from typing import Any

import numpy as np


def rotation_of(quaternion_xyzw: Sequence[float]) -> Any:
    x, y, z, w = quaternion_xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
