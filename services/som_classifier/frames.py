"""Frames: what the classifier reads from one posture message."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from actum.arrays import Array, joints_to_array
from actum.limits import MAX_COORDINATE_M
from actum.messages import Joint, Posture
from actum.skeletons import INDEX
from som_classifier.kinematics import Kinematics, KinematicsFilter

_TORSO = INDEX["torso"]


@dataclass
class Frame:
    """One posture as the recogniser needs it. Arrays are None where the frame is not valid.

    Attributes:
        stamp_ns: capture time.
        previous_ns: capture time of the frame before it, whoever is in that one; None for the first.
        agents: the numbers of all people in the captured frame.
        missed: how many frames were lost right before it.
        distance_m: from the camera to the origin of the actor's egocentric frame; infinite where unknown.
        joints: (15, 3), egocentric, scaled to the standard body; NaN where the source lacks a joint.
        motion: (5,), mean displacement of each body part since that frame, metres.
        kinematics: smoothed positions and velocities in the upright frame.
        missing: the joints that are NaN in `kinematics`.
        depth_inferred: whether distances were inferred from an image and a standard body's size.
        activity: the encoder's result for this frame, of a type that the model defines.
        reason: why the preprocessor could not use the frame; None where it could.
    """

    stamp_ns: int
    previous_ns: int | None
    agents: tuple[int, ...]
    missed: int
    distance_m: float
    joints: Array | None
    motion: Array | None
    kinematics: Kinematics | None = None
    missing: tuple[int, ...] = ()
    depth_inferred: bool = False
    activity: Any = None
    reason: str | None = None

    @property
    def valid(self) -> bool:
        """Whether the frame holds a posture."""
        return self.joints is not None


def frame_of(posture: Posture, lost: int, smoothing: KinematicsFilter) -> Frame:
    """Read a message and advance its agent's filter.

    Args:
        posture: the message.
        lost: how many messages of the same key are missing right before it.
        smoothing: the filter of the posture's agent.
    """
    frame = Frame(
        posture.stamp_ns,
        posture.previous_ns,
        tuple(posture.agents),
        posture.missed + lost,
        math.inf if posture.ego_from_camera is None else math.hypot(*posture.ego_from_camera[3:12:4]),
        None,
        None,
        reason=posture.reason,
    )
    arrays = _usable_arrays(posture)
    if arrays is not None:
        frame.joints, frame.motion, upright = arrays
        frame.kinematics = smoothing.step(posture.stamp_ns, upright)
        frame.depth_inferred = posture.depth_std_m is not None
        frame.missing = tuple(np.flatnonzero(np.isnan(upright[:, 0])).tolist())
    return frame


def _usable_arrays(posture: Posture) -> tuple[Array, Array, Array] | None:
    """Return joints (15, 3), motion (5,) and upright joints (15, 3).

    Return None where a value is not finite or absurd, or all joints are missing.
    """
    if not posture.valid or posture.joints is None or posture.motion is None:
        return None
    joints, motion = joints_to_array(posture.joints), np.array(posture.motion, dtype=np.float64)
    upright = joints - joints[_TORSO] if posture.upright is None else joints_to_array(posture.upright)
    usable = _is_usable(posture.joints, joints) and _is_usable(posture.upright or posture.joints, upright)
    return (joints, motion, upright) if usable and (np.abs(motion) < MAX_COORDINATE_M).all() else None


def _is_usable(joints: Sequence[Joint], array: Array) -> bool:
    """Tell whether some joint is known and all known ones are finite and within bounds; `array` holds the same ones."""
    missing = joints.count(None)
    return missing < len(joints) and np.count_nonzero(np.abs(array) < MAX_COORDINATE_M) == array.size - 3 * missing
