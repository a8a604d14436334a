"""Each object's track: where it is and how it moves, also for a while when a hand covers its markers."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from actum.geometry import quaternion_xyzw
from actum.messages import TrackedObject
from actum.node import SECOND_NS
from marker_tracker.pose import kalman
from marker_tracker.pose.disambiguation import Facing
from marker_tracker.pose.poses import Pose
from marker_tracker.pose.rotations import Array, apart_rad, between

REJOIN_S = 0.5
"""What has been hidden for longer starts anew where it is seen again."""
GATE = 60.0
"""Squared Mahalanobis distance from which a sighting is doubted once, and believed when the next one agrees."""
HIDDEN_GATE = 16.0
"""The same for a hidden object: what covers it may itself be hidden in part, and found in the wrong place."""
PREDICTED_S = 0.3
SLOWING_S = 0.15
"""While predicted, an object comes to rest with this time constant."""
MOVING = 16.0
"""Squared velocity over its variance from which an object counts as moving, when that is also 5 cm/s."""
SLOWEST_MPS = 0.05
JITTER_RAD = 0.035
"""Turns much smaller than this are smoothed, much larger ones followed at once."""


@dataclass(frozen=True, eq=False)
class Sighting:
    """What one image says of an object, in the skeleton's camera frame.

    `poses` are the one or two possible ones, the better first, `noise` (3, 3) the covariance of the position. A hidden
    object is where what covers it has gone.
    """

    poses: Sequence[Pose]
    noise: Array
    confidence: float
    hidden: bool = False


class Track:
    """One object's filtered motion and smoothed rotation."""

    def __init__(self, number: int, name: str) -> None:
        self._number, self._name = number, name
        self._motion: kalman.Motion | None = None
        self._rotation: Array | None = None
        self._facing = Facing()
        self._doubted: tuple[int, kalman.Motion] | None = None
        self._sightings = 0
        self._confidence = 0.0
        self._followed = False
        self.known_ns = 0

    def see(self, stamp_ns: int, sighting: Sighting) -> bool:
        """Take in a sighting; false where it is too far off to be believed yet."""
        seconds = (stamp_ns - self.known_ns) / SECOND_NS
        if self._motion is None or seconds > REJOIN_S:
            return self._begin(stamp_ns, sighting)
        pose = self._facing.choose(sighting.poses, self._rotation)
        position_m = pose.image_from_object[:3, 3]
        motion, surprise = kalman.corrected(kalman.predicted(self._motion, seconds), position_m, sighting.noise)
        if surprise > (HIDDEN_GATE if sighting.hidden else GATE):
            if self._followed or self._agrees_with_doubted(stamp_ns, position_m, sighting.noise):
                return self._begin(stamp_ns, sighting)
            self._doubted = stamp_ns, kalman.started(position_m, sighting.noise)
            return False
        self._motion = motion
        self._turn(pose)
        self._believed(stamp_ns, sighting)
        return True

    def _agrees_with_doubted(self, stamp_ns: int, position_m: Array, noise: Array) -> bool:
        if self._doubted is None:
            return False
        doubted_ns, motion = self._doubted
        seconds = (stamp_ns - doubted_ns) / SECOND_NS
        return kalman.corrected(kalman.predicted(motion, seconds), position_m, noise)[1] <= GATE

    def now(self) -> TrackedObject:
        """Describe the object as it was just seen or followed."""
        assert self._motion is not None
        velocity = self._motion.velocity_mps.tolist() if self._sightings > 1 else None
        seen = not self._followed
        return self._described(self._motion.position_m, velocity, self._confidence, seen=seen, followed=self._followed)

    def hidden(self, stamp_ns: int, memory_ns: int) -> TrackedObject:
        """Describe where the object should be; confidence falls to 0 over the memory's length."""
        assert self._motion is not None
        seconds = (stamp_ns - self.known_ns) / SECOND_NS
        confidence = self._confidence * (1.0 - (stamp_ns - self.known_ns) / memory_ns)
        moved_s = SLOWING_S * (1 - np.exp(-min(seconds, PREDICTED_S) / SLOWING_S))
        start_mps = self._motion.velocity_mps if self._is_moving() else np.zeros(3)
        velocity = (np.exp(-seconds / SLOWING_S) * start_mps).tolist() if seconds <= PREDICTED_S else None
        position_m = self._motion.position_m + moved_s * start_mps
        return self._described(position_m, velocity, confidence, predicted=seconds <= PREDICTED_S)

    def _begin(self, stamp_ns: int, sighting: Sighting) -> bool:
        """Begin anew, but at nothing hidden: what covered the object is no longer where that can be."""
        if sighting.hidden:
            return False
        pose = self._facing.choose(sighting.poses, None)
        self._motion = kalman.started(pose.image_from_object[:3, 3], sighting.noise)
        self._rotation = pose.image_from_object[:3, :3]
        self._sightings = 0
        self._believed(stamp_ns, sighting)
        return True

    def _believed(self, stamp_ns: int, sighting: Sighting) -> None:
        self._doubted = None
        self._sightings += 1
        self._confidence = sighting.confidence
        self._followed = sighting.hidden
        self.known_ns = stamp_ns

    def _turn(self, pose: Pose) -> None:
        assert self._rotation is not None
        measured = pose.image_from_object[:3, :3]
        angle = apart_rad(self._rotation, measured)
        self._rotation = between(self._rotation, measured, angle / (angle + JITTER_RAD))

    def _is_moving(self) -> bool:
        assert self._motion is not None
        velocity = self._motion.velocity_mps
        if self._followed or self._sightings < 3 or float(np.linalg.norm(velocity)) < SLOWEST_MPS:
            return False
        return float(velocity @ np.linalg.solve(self._motion.covariance[3:, 3:], velocity)) > MOVING

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
    """The tracks of all objects that were seen or followed within the last `memory_ns`, by stamps."""

    def __init__(self, memory_ns: int) -> None:
        self._memory_ns = memory_ns
        self._tracks: dict[int, Track] = {}

    def clear(self) -> None:
        """Forget everything: the source has started anew."""
        self._tracks.clear()

    def see(self, stamp_ns: int, number: int, name: str, sighting: Sighting) -> bool:
        """Take in one object's sighting; false where it is too far off to be believed yet."""
        if sighting.hidden and number not in self._tracks:
            return False
        return self._tracks.setdefault(number, Track(number, name)).see(stamp_ns, sighting)

    def listed(self, stamp_ns: int) -> list[TrackedObject]:
        """List the objects known at an instant and the hidden ones, by id; drop those hidden for too long."""
        self._tracks = {
            number: track for number, track in self._tracks.items() if stamp_ns - track.known_ns <= self._memory_ns
        }
        return [
            track.now() if track.known_ns == stamp_ns else track.hidden(stamp_ns, self._memory_ns)
            for _, track in sorted(self._tracks.items())
        ]
