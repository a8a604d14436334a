"""Puts a continuation where the person is: postures of a standard body become joints in the camera frame."""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array, joints_to_array, joints_to_list
from actum.geometry import apply, from_flat, invert, is_rigid
from actum.limits import MAX_COORDINATE_M
from actum.messages import Continuation, Posture, PostureAhead
from actum.skeletons import INDEX
from actum.standard_body import bones_of, in_own_size
from som_classifier.continuation import HORIZONS_S
from som_classifier.frames import Frame
from som_classifier.kinematics import LAG_TIME_CONSTANT_S

MOVES_MPS = 0.2
"""Speed (m/s) of some joint from which a person moves: a sensor's noise and the sway of one who stands are mostly less.
Chosen on simulated people 91, 92, 100 and 101."""


def moves(frames: Sequence[Frame]) -> bool:
    """Tell whether some joint moved in some of these valid frames."""
    velocities = np.stack([frame.kinematics.velocity for frame in frames if frame.kinematics is not None])
    return bool((np.square(velocities).sum(axis=2) >= (MOVES_MPS * LAG_TIME_CONSTANT_S) ** 2).any())


def continuation_of(ahead: Array, newest: Frame, posture: Posture) -> Continuation | None:
    """Return the message about how a posture goes on; None where the person's place is not usable.

    Args:
        ahead: (3, 15, 3), the postures after `HORIZONS_S`, upright, scaled, metres; NaN where a joint is missing.
        newest: the valid frame of the posture.
        posture: as it was received.
    """
    now_m = joints_in_camera(posture)
    if now_m is None:
        return None
    return Continuation.of_checked(
        stamp_ns=posture.stamp_ns,
        sensor=posture.sensor,
        agent=posture.agent,
        ahead=[
            PostureAhead(ahead_s=ahead_s, joints_m=joints_to_list(joints_m))
            for ahead_s, joints_m in zip(HORIZONS_S, in_camera(ahead, newest, now_m), strict=True)
        ],
        session_id=posture.session_id,
    )


def joints_in_camera(posture: Posture) -> Array | None:
    """Return the joints in the camera frame (m), (15, 3), NaN where missing or absurd; None without frame or torso."""
    if posture.joints_m is None or posture.ego_from_camera is None:
        return None
    ego_from_camera, joints_m = from_flat(posture.ego_from_camera), joints_to_array(posture.joints_m)
    joints_m[~(np.abs(joints_m) < MAX_COORDINATE_M).all(axis=1)] = np.nan
    if not is_rigid(ego_from_camera, MAX_COORDINATE_M) or np.isnan(joints_m[INDEX["torso"], 0]):
        return None
    return apply(invert(ego_from_camera), joints_m)


def in_camera(ahead: Array, newest: Frame, now_m: Array) -> Array:
    """Return the postures `ahead` in the camera frame (m), (n, 15, 3), of a person whose joints (15, 3) are there now.

    The torso stays where it is.
    """
    assert newest.upright is not None
    camera_from_upright = rotation_between(bones_of(newest.upright)[0], bones_of(now_m)[0])
    joints_m: Array = now_m[INDEX["torso"]] + in_own_size(ahead, now_m) @ camera_from_upright.T
    return joints_m


def rotation_between(bones_a: Array, bones_b: Array) -> Array:
    """Return the rotation b_from_a (3, 3) between the same bones (14, 3) in two frames (Kabsch 1976).

    Their lengths may differ; bones that are NaN in either frame are left out.
    """
    known = ~np.isnan(bones_a[:, 0] + bones_b[:, 0])
    left, _, right = np.linalg.svd(bones_b[known].T @ bones_a[known])
    left[:, 2] *= np.linalg.det(left @ right)
    rotation: Array = left @ right
    return rotation
