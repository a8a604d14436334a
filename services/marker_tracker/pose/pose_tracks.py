"""Pose tracks: each object's filtered position, velocity and rotation, predicted while it is out of sight."""

from collections.abc import Sequence

import cv2
import numpy as np

from actum.arrays import Array
from actum.filters import MotionEstimate
from actum.geometry import angle_between_rad, quaternion_xyzw
from actum.messages import TrackedObject
from actum.node import SECOND_NS
from marker_tracker.pose.disambiguation import PoseDisambiguation
from marker_tracker.pose.poses import Measurement

RESTART_S = 0.5
"""Seconds out of sight after which a track starts anew: by then the object may be anywhere."""
ACCELERATION_STD_MPS2 = 8.0
"""Metres per second squared: acceleration of an object by a hand between two images."""
INITIAL_SPEED_STD_MPS = 1.0
"""Metres per second: an object may be moving at its first measurement."""
MAX_NIS = 60.0
"""Normalised innovation squared above which a measurement is held back, until the next one agrees with it."""
MAX_HIDDEN_NIS = 16.0
"""The same for a hidden object: its occluder may itself be hidden in part, and be registered in the wrong place."""
PREDICTED_S = 0.3
"""Seconds for which motion is predicted: a hand's movement takes little longer."""
SLOWING_TIME_CONSTANT_S = 0.15
"""Seconds in which the predicted velocity falls to 1/e: an object out of sight is mostly about to be put down."""
MIN_VELOCITY_RATIO = 16.0
"""Squared velocity over its variance from which an object counts as moving: four standard deviations."""
MIN_SPEED_MPS = 0.05
"""Metres per second below which an object never counts as moving: hands tremble."""
MIN_MEASURED_FOR_VELOCITY = 3
"""Fewest measurements for a velocity that is certain enough to predict by."""
ROTATION_NOISE_RAD = 0.035
"""Radians: much smaller rotations are smoothed, much larger ones followed at once."""


class Track:
    """One object's filtered motion and smoothed rotation."""

    def __init__(self, number: int, name: str) -> None:
        self._number, self._name = number, name
        self._motion: MotionEstimate | None = None
        self._rotation: Array | None = None
        self._disambiguation = PoseDisambiguation()
        self._held_back: tuple[int, MotionEstimate] | None = None
        self._measured = 0
        self._confidence = 0.0
        self._hidden = False
        self.stamp_ns = 0
        """Stamp of the last measurement that was accepted."""

    def update(self, stamp_ns: int, measurement: Measurement) -> bool:
        """Update the track by a measurement; return false where it is too far off and is held back."""
        seconds = (stamp_ns - self.stamp_ns) / SECOND_NS
        if self._motion is None or seconds > RESTART_S:
            return self._restart(stamp_ns, measurement)
        pose = self._disambiguation.choose(measurement.poses, self._rotation)
        position_m = pose.camera_from_object[:3, 3]
        expected = self._motion.predicted(seconds, ACCELERATION_STD_MPS2)
        motion, nis = expected.updated(position_m, measurement.noise_m2)
        if nis > (MAX_HIDDEN_NIS if measurement.hidden else MAX_NIS):
            if self._hidden or self._agrees_with_held_back(stamp_ns, position_m, measurement.noise_m2):
                return self._restart(stamp_ns, measurement)
            self._held_back = stamp_ns, MotionEstimate.initial(position_m, measurement.noise_m2, INITIAL_SPEED_STD_MPS)
            return False
        self._motion = motion
        assert self._rotation is not None
        measured = pose.camera_from_object[:3, :3]
        angle_rad = angle_between_rad(self._rotation, measured)
        self._rotation = interpolated_rotation(self._rotation, measured, angle_rad / (angle_rad + ROTATION_NOISE_RAD))
        self._accept(stamp_ns, measurement)
        return True

    def _agrees_with_held_back(self, stamp_ns: int, position_m: Array, noise_m2: Array) -> bool:
        if self._held_back is None:
            return False
        held_back_ns, motion = self._held_back
        expected = motion.predicted((stamp_ns - held_back_ns) / SECOND_NS, ACCELERATION_STD_MPS2)
        return expected.updated(position_m, noise_m2)[1] <= MAX_NIS

    def described(self, stamp_ns: int, memory_ns: int) -> TrackedObject:
        """Describe the object at a stamp: as measured then, or as predicted if it is out of sight.

        While it is out of sight, its confidence falls to 0 within `memory_ns`.
        """
        assert self._motion is not None
        if stamp_ns == self.stamp_ns:
            velocity_mps = self._motion.velocity_mps.tolist() if self._measured > 1 else None
            return self._described(
                self._motion.position_m, velocity_mps, self._confidence, seen=not self._hidden, followed=self._hidden
            )
        seconds = (stamp_ns - self.stamp_ns) / SECOND_NS
        slowing_s = SLOWING_TIME_CONSTANT_S
        moved_s = slowing_s * (1 - np.exp(-min(seconds, PREDICTED_S) / slowing_s))
        initial_mps = self._motion.velocity_mps if self._is_moving() else np.zeros(3)
        return self._described(
            self._motion.position_m + moved_s * initial_mps,
            (np.exp(-seconds / slowing_s) * initial_mps).tolist() if seconds <= PREDICTED_S else None,
            self._confidence * (1.0 - (stamp_ns - self.stamp_ns) / memory_ns),
            predicted=seconds <= PREDICTED_S,
        )

    def _restart(self, stamp_ns: int, measurement: Measurement) -> bool:
        """Start anew at a measurement, unless its object is hidden: then its occluder was tracked wrongly."""
        if measurement.hidden:
            return False
        pose = self._disambiguation.choose(measurement.poses, None)
        position_m = pose.camera_from_object[:3, 3]
        self._motion = MotionEstimate.initial(position_m, measurement.noise_m2, INITIAL_SPEED_STD_MPS)
        self._rotation = pose.camera_from_object[:3, :3]
        self._measured = 0
        self._accept(stamp_ns, measurement)
        return True

    def _accept(self, stamp_ns: int, measurement: Measurement) -> None:
        self._held_back = None
        self._measured += 1
        self._confidence = measurement.confidence
        self._hidden = measurement.hidden
        self.stamp_ns = stamp_ns

    def _is_moving(self) -> bool:
        assert self._motion is not None
        velocity = self._motion.velocity_mps
        slow = float(np.linalg.norm(velocity)) < MIN_SPEED_MPS
        if self._hidden or self._measured < MIN_MEASURED_FOR_VELOCITY or slow:
            return False
        return float(velocity @ np.linalg.solve(self._motion.covariance[3:, 3:], velocity)) > MIN_VELOCITY_RATIO

    def _described(
        self,
        position_m: Array,
        velocity_mps: list[float] | None,
        confidence: float,
        *,
        seen: bool = False,
        predicted: bool = False,
        followed: bool = False,
    ) -> TrackedObject:
        assert self._rotation is not None
        return TrackedObject(
            id=self._number,
            name=self._name,
            position_m=position_m.tolist(),
            quaternion_xyzw=quaternion_xyzw(self._rotation),
            confidence=confidence,
            seen=seen,
            velocity_mps=velocity_mps,
            predicted=predicted,
            followed=followed,
        )


class Tracks:
    """The tracks of all objects that were measured within the last `memory_ns`, by stamps."""

    def __init__(self, memory_ns: int) -> None:
        self._memory_ns = memory_ns
        self._tracks: dict[int, Track] = {}

    def clear(self) -> None:
        """Forget all tracks."""
        self._tracks.clear()

    def update(self, stamp_ns: int, measurements: Sequence[Measurement]) -> list[Measurement]:
        """Update the tracks by an image's measurements; return the measurements that are held back as outliers."""
        return [each for each in measurements if not self._update_one(stamp_ns, each)]

    def listed(self, stamp_ns: int) -> list[TrackedObject]:
        """List the objects by id, also those out of sight; drop those out of sight for longer than the memory."""
        self._tracks = {
            number: track for number, track in self._tracks.items() if stamp_ns - track.stamp_ns <= self._memory_ns
        }
        return [track.described(stamp_ns, self._memory_ns) for _, track in sorted(self._tracks.items())]

    def _update_one(self, stamp_ns: int, measurement: Measurement) -> bool:
        number = measurement.object_id
        if number not in self._tracks:
            if measurement.hidden:
                return False
            self._tracks[number] = Track(number, measurement.name)
        return self._tracks[number].update(stamp_ns, measurement)


def interpolated_rotation(start: Array, end: Array, share: float) -> Array:
    """Interpolate between two rotations (3, 3): turn the first by a share of the angle between them, (3, 3)."""
    turn = cv2.Rodrigues(np.ascontiguousarray(start.T @ end))[0]
    rotation: Array = start @ cv2.Rodrigues(share * turn)[0]
    return rotation
