"""Which of the two poses that a small, nearly frontal marker allows is the right one, decided over time."""

from collections.abc import Sequence

import numpy as np

from marker_tracker.pose.poses import Pose
from marker_tracker.pose.rotations import Array, apart_rad

CORNER_NOISE_PX = 0.25
STEP = 10.0
"""Most that one image counts for or against."""
SURE = 20.0
"""Most evidence kept: two images that say clearly otherwise undo it."""
SWITCH = 6.0
FORGOTTEN = 0.95
"""Part of the evidence kept from one image to the next."""


class Facing:
    """Follows one of the two poses; changes over when the other one has fitted better for long or by far.

    The evidence is the logarithm of the likelihood ratio of the one followed to the other, for corners with
    independent normal errors: 4 (e_other² - e²) / (2 noise²) summed over images, with what is old fading.
    """

    def __init__(self) -> None:
        self._evidence = 0.0

    def choose(self, poses: Sequence[Pose], rotation: Array | None) -> Pose:
        """Choose from the poses of one image (the better first), given the rotation (3, 3) followed so far."""
        if rotation is None:
            self._evidence = 0.0
            return self._single(poses[0]) if len(poses) == 1 else self._weigh(poses[0], poses[1])
        if len(poses) == 1:
            return self._single(poses[0])
        near, far = sorted(poses, key=lambda pose: apart_rad(pose.image_from_object, rotation))
        return self._weigh(near, far)

    def _single(self, pose: Pose) -> Pose:
        self._evidence = min(SURE, FORGOTTEN * self._evidence + STEP)
        return pose

    def _weigh(self, near: Pose, far: Pose) -> Pose:
        gain = 4 * (far.error_px**2 - near.error_px**2) / (2 * CORNER_NOISE_PX**2)
        self._evidence = min(SURE, FORGOTTEN * self._evidence + float(np.clip(gain, -STEP, STEP)))
        if self._evidence >= -SWITCH:
            return near
        self._evidence = min(SURE, -self._evidence)
        return far
