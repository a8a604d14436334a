"""Continuation: how a person's posture goes on in the next second, from the newest frames of one person."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.node import SECOND_NS
from som_classifier.frames import Frame

STEPS = (1, 2, 4)
"""After how many steps the posture is predicted: after 0.25, 0.5 and 1 s."""
STEP_NS = SECOND_NS // 4
"""One step (ns): long enough for a moving hand to leave the units of the map that were active."""
LOOKED_BACK_NS = 2 * STEP_NS
"""How far back (ns) frames are needed: one step, and the frame before that, also where some are lost."""
HORIZONS_S = tuple(steps * STEP_NS / SECOND_NS for steps in STEPS)
"""How far ahead the posture is predicted (s)."""
PREFIX = "continuation_"
"""How the names of a continuation's arrays in a model file begin."""


class Continuation(ABC):
    """What a model predicts about a posture; a function of frames up to the newest one alone.

    Attributes:
        shares: (2, 3), for each horizon: of the predicted displacement, and of what smoothing removed from the newest
            posture, the shares that are added to the smoothed posture. Fitted so that the mean distance is smallest.
    """

    shares: NDArray[np.float32]

    def ahead(self, frames: Sequence[Frame]) -> Array:
        """Return the postures (3, 15, 3) after `HORIZONS_S`: upright, scaled, metres; NaN where a joint is missing.

        Args:
            frames: the newest valid frames of one person in order, at least one, each with the activity that the
                model's encoder gave. Frames that are older than `LOOKED_BACK_NS` before the newest one are not needed.
        """
        newest = frames[-1]
        assert newest.kinematics is not None and newest.upright is not None
        smooth = newest.kinematics.posture
        moved, removed = self.shares[:, :, None, None]
        postures: Array = smooth + moved * self.displacements(frames) + removed * (newest.upright - smooth)
        return postures

    @abstractmethod
    def displacements(self, frames: Sequence[Frame]) -> Array:
        """Return how far each joint will have moved after `HORIZONS_S`, (3, 15, 3), metres; finite."""

    @property
    @abstractmethod
    def arrays(self) -> Mapping[str, NDArray[Any]]:
        """The arrays of a model file; a model without a continuation has none of them."""


def smooth_posture_at(frames: Sequence[Frame], stamp_ns: int) -> Array:
    """Return the smoothed posture (15, 3) at a stamp, interpolated; that of the oldest frame where all are newer.

    Args:
        frames: valid, of one person, stamps rising.
        stamp_ns: not after the newest frame.
    """
    after = len(frames) - 1
    while after and frames[after - 1].stamp_ns >= stamp_ns:
        after -= 1
    later, earlier = frames[after], frames[max(after - 1, 0)]
    assert later.kinematics is not None and earlier.kinematics is not None
    if later.stamp_ns <= stamp_ns or later is earlier:
        return later.kinematics.posture
    share = (stamp_ns - earlier.stamp_ns) / (later.stamp_ns - earlier.stamp_ns)
    posture: Array = earlier.kinematics.posture + share * (later.kinematics.posture - earlier.kinematics.posture)
    return posture
