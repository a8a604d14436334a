"""A body in its own frame: as it was measured, and with bones of standard length."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from actum import geometry, standard_body
from actum.arrays import Array
from actum.core import steps
from actum.messages import Joint
from actum.skeletons import INDEX

_PARENTS = np.array([parent for parent, _, _ in standard_body.BONES], np.int32).tobytes()
_CHILDREN = np.array([child for _, child, _ in standard_body.BONES], np.int32).tobytes()
_LENGTHS_M = np.array([length_m for _, _, length_m in standard_body.BONES]).tobytes()
_HIPS_TORSO = np.array([INDEX[name] for name in ("right_hip", "left_hip", "torso")], np.int32).tobytes()
_NUMBERS = 4 * 3 * len(INDEX) + 16
"""How many numbers a known body has."""


class Body(NamedTuple):
    """Joints (15, 3) in metres.

    Attributes:
        scaled: with standard bones, camera frame.
        ego_from_camera: (4, 4), of the measured joints.
        metric_ego: the measured joints, egocentric.
        scaled_ego: those with standard bones, in the egocentric frame of their own.
    """

    scaled: Array
    ego_from_camera: Array
    metric_ego: Array
    scaled_ego: Array


def body_of(joints: Array) -> Body:
    """Return the body of joints (15, 3; m, camera frame), NaN where unknown.

    Raises:
        DegenerateError: joints coincide, so that the frame is not defined.
    """
    metric_and_scaled = np.array([joints, standard_body.scaled(joints)])
    ego_from_camera = geometry.ego_from_camera(metric_and_scaled)
    metric_ego, scaled_ego = geometry.apply(ego_from_camera, metric_and_scaled)
    return Body(metric_and_scaled[1], ego_from_camera[0], metric_ego, scaled_ego)


def known_body(joints: Sequence[Joint], reach_limit_m: float, bone_limit_m: float) -> Array | None:
    """Return a message's joints and the fields of their `Body`, one after the other, by a compiled step; None without.

    None, too, where a joint is unknown or beyond the reach, a bone too long, or the frame not defined. The first 45
    numbers are the joints.
    """
    if steps is None:
        return None
    numbers = np.empty(_NUMBERS)
    usable = steps.body(
        joints, _PARENTS, _CHILDREN, _LENGTHS_M, _HIPS_TORSO, reach_limit_m, bone_limit_m, geometry.SMALLEST_M, numbers
    )
    return numbers if usable else None
