"""Frames: what the classifier reads from one posture message."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from actum.arrays import Array, joints_to_array
from actum.core import steps
from actum.limits import MAX_COORDINATE_M
from actum.messages import Joint, Posture
from actum.skeletons import INDEX, JOINTS, PARTS
from som_classifier.kinematics import Kinematics, KinematicsFilter

_TORSO = INDEX["torso"]
_SIZE = 3 * len(INDEX)


@dataclass(slots=True)
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
        activity: the encoder's result for this frame, of a type that the model defines; None where it was forgotten.
        reason: why the preprocessor could not use the frame; None where it could.
        upright: (15, 3), scaled joints in the upright frame as measured, before `kinematics` smooths them.
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
    upright: Array | None = None

    @property
    def valid(self) -> bool:
        """Whether the frame holds a posture."""
        return self.joints is not None


class Stretch(NamedTuple):
    """The frames of a part of a stream.

    Attributes:
        usable: the valid ones.
        missed: how many were lost on the way.
        missing_joints: the names of the joints that some frame lacks, in the order of `JOINTS`.
    """

    usable: list[Frame]
    missed: int
    missing_joints: list[str]

    @classmethod
    def of(cls, frames: list[Frame]) -> "Stretch":
        """Sum up frames."""
        usable = [frame for frame in frames if frame.valid]
        return cls(usable, sum(frame.missed for frame in frames), missing_joints(frames))


def missing_joints(frames: Sequence[Frame]) -> list[str]:
    """Name the joints that some frame lacked, in the order of `JOINTS`."""
    return [JOINTS[joint] for joint in sorted({joint for frame in frames for joint in frame.missing})]


def frame_of(posture: Posture, lost: int, smoothing: KinematicsFilter) -> Frame:
    """Read a message and advance its agent's filter.

    Args:
        posture: the message.
        lost: how many messages of the same key are missing right before it.
        smoothing: the filter of the posture's agent.
    """
    origin_m = math.inf if posture.ego_from_camera is None else math.hypot(*posture.ego_from_camera[3:12:4])
    agents, missed = tuple(posture.agents), posture.missed + lost
    read = _usable_arrays(posture)
    if read is None:
        return Frame(posture.stamp_ns, posture.previous_ns, agents, missed, origin_m, None, None, reason=posture.reason)
    joints, motion, upright, missing = read
    return Frame(
        posture.stamp_ns,
        posture.previous_ns,
        agents,
        missed,
        origin_m,
        joints,
        motion,
        smoothing.step(posture.stamp_ns, upright),
        missing,
        posture.depth_std_m is not None,
        reason=posture.reason,
        upright=upright,
    )


def _usable_arrays(posture: Posture) -> tuple[Array, Array, Array, tuple[int, ...]] | None:
    """Return joints (15, 3), motion (5,), upright joints (15, 3), and which of these are missing.

    Return None where a value is not finite or absurd, or all joints are missing.
    """
    if not posture.valid or posture.joints is None or posture.motion is None:
        return None
    if steps is None:
        return _read(posture.joints, posture.upright, posture.motion)
    numbers = np.empty(2 * _SIZE + len(PARTS))
    missing = steps.usable(posture.joints, posture.upright, posture.motion, _TORSO, MAX_COORDINATE_M, numbers)
    if missing is None:
        return None
    joints, upright = numbers[: 2 * _SIZE].reshape(2, -1, 3)
    return joints, numbers[2 * _SIZE :], upright, missing


def _read(
    listed: list[Joint], listed_upright: list[Joint] | None, listed_motion: list[float]
) -> tuple[Array, Array, Array, tuple[int, ...]] | None:
    """Return the same as `_usable_arrays`, in NumPy."""
    joints, motion = joints_to_array(listed), np.array(listed_motion, dtype=np.float64)
    upright = joints - joints[_TORSO] if listed_upright is None else joints_to_array(listed_upright)
    usable = _is_usable(listed, joints) and _is_usable(listed_upright or listed, upright)
    if not (usable and (np.abs(motion) < MAX_COORDINATE_M).all()):
        return None
    missing = tuple(np.flatnonzero(np.isnan(upright[:, 0])).tolist()) if None in (listed_upright or listed) else ()
    return joints, motion, upright, missing


def _is_usable(joints: Sequence[Joint], array: Array) -> bool:
    """Tell whether some joint is known and all known ones are finite and within bounds; `array` holds the same ones."""
    missing = joints.count(None)
    return missing < len(joints) and np.count_nonzero(np.abs(array) < MAX_COORDINATE_M) == array.size - 3 * missing
