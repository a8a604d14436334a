"""Pose disambiguation: which of the two poses that a small, nearly frontal marker allows, decided over time."""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum.geometry import angle_between_rad
from marker_tracker.pose.poses import Pose

CORNER_NOISE_PX = 0.25
"""Standard deviation in pixels of a corner's coordinates."""
MAX_STEP = 10.0
"""Log-likelihood ratio that one image counts at most: its corners may be wrong together, under a finger."""
MAX_EVIDENCE = 20.0
"""Log-likelihood ratio that is kept at most: two images that clearly say otherwise undo it."""
SWITCH_EVIDENCE = 6.0
"""Log-likelihood ratio against the followed pose at which the other one is taken: chance hardly ever reaches it."""
DECAY = 0.95
"""Share of the evidence that is kept from one image to the next: a turning marker makes what is old worthless."""


class PoseDisambiguation:
    """Follows one of the two poses; takes the other one when that has fitted better for long or by far.

    The evidence is the logarithm of the likelihood ratio of the followed pose to the other, for corners with
    independent normal errors: 4 (e_other² - e²) / (2 noise²), summed over images with exponential decay.
    """

    def __init__(self) -> None:
        self._evidence = 0.0

    def choose(self, poses: Sequence[Pose], rotation: Array | None) -> Pose:
        """Choose from the poses of one image, the better first, given the rotation (3, 3) followed so far, if any."""
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
        self._evidence = min(MAX_EVIDENCE, DECAY * self._evidence + float(np.clip(ratio, -MAX_STEP, MAX_STEP)))
        if self._evidence >= -SWITCH_EVIDENCE:
            return near
        self._evidence = min(MAX_EVIDENCE, -self._evidence)
        return far
