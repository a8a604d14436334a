"""Pose disambiguation: choose over time between the two poses that fit a small, nearly frontal marker."""

from collections.abc import Sequence

from actum.arrays import Array
from actum.geometry import angle_between_rad
from marker_tracker.pose.poses import Pose

CORNER_NOISE_PX = 0.25
"""Standard deviation in pixels of a corner's coordinates."""
MAX_STEP = 10.0
"""Largest log-likelihood ratio from one image: a finger may make all of its corners wrong together."""
MAX_EVIDENCE = 20.0
"""Largest accumulated log-likelihood ratio: two images that clearly favour the other pose outweigh it."""
SWITCH_EVIDENCE = 6.0
"""Log-likelihood ratio against the followed pose from which the other one is chosen: hardly ever reached by chance."""
DECAY = 0.95
"""Share of the evidence that is kept from one image to the next: it is worthless once the marker has turned."""


class PoseDisambiguation:
    """Follows one of the two poses; switches to the other one when that has fitted better for long or by far.

    The evidence is the logarithm of the likelihood ratio of the followed pose to the other, for corners with
    independent normal errors: 4 (e_other² - e²) / (2 noise²), summed over images with exponential decay.
    """

    def __init__(self) -> None:
        self._evidence = 0.0

    def choose(self, poses: Sequence[Pose], rotation: Array | None) -> Pose:
        """Choose one of an image's poses, the better first, given the track's rotation (3, 3), None for a new track."""
        if rotation is None:
            self._evidence = 0.0
        if len(poses) == 1:
            self._evidence = min(MAX_EVIDENCE, DECAY * self._evidence + MAX_STEP)
            return poses[0]
        if rotation is None:
            return self._likelier(poses[0], poses[1])
        near, far = sorted(poses, key=lambda pose: angle_between_rad(pose.camera_from_object, rotation))
        return self._likelier(near, far)

    def _likelier(self, near: Pose, far: Pose) -> Pose:
        ratio = 4 * (far.error_px**2 - near.error_px**2) / (2 * CORNER_NOISE_PX**2)
        self._evidence = min(MAX_EVIDENCE, DECAY * self._evidence + min(max(ratio, -MAX_STEP), MAX_STEP))
        if self._evidence >= -SWITCH_EVIDENCE:
            return near
        self._evidence = min(MAX_EVIDENCE, -self._evidence)
        return far
