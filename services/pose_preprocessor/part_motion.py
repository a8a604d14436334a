"""How much each body part moves: what attention goes by (paper, section 2.1)."""

import math

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.skeletons import INDEX, PARTS

Array = NDArray[np.float64]

GAP_NS = SECOND_NS // 2
TIME_CONSTANT_S = 0.3
_IN_PART = np.array([[joint in part for joint in range(len(INDEX))] for part in PARTS.values()], dtype=np.float64)
_PART_SIZES = _IN_PART.sum(axis=1)
_TORSO = INDEX["torso"]


class PartMotionFilter:
    """One agent's motion, from joints relative to the torso, low-passed so that noise does not pass for movement.

    Frame-to-frame steps add up a joint's noise, most at the feet; in the egocentric frame its own jitter comes on
    top, the more the further a part is from the hips. Camera axes and a first-order filter leave the movement.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self._smooth: Array = np.zeros((len(INDEX), 3))

    def is_over(self, stamp_ns: int) -> bool:
        """Tell whether a step at this stamp would begin anew."""
        return self._stamp_ns is None or stamp_ns - self._stamp_ns > GAP_NS

    def step(self, stamp_ns: int, joints: Array) -> list[float]:
        """Return each part's mean displacement (m) since the frame before; 0 at first and after a gap.

        The mean is over the joints known in this frame and the one before; 0 where there is none.

        Args:
            stamp_ns: rising from call to call.
            joints: (15, 3), camera frame, metres; NaN where unknown.
        """
        relative = joints - joints[_TORSO]
        before_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        if before_ns is None or stamp_ns - before_ns > GAP_NS:
            self._smooth = relative
            return [0.0] * len(PARTS)
        elapsed_ns = stamp_ns - before_ns
        share = 1.0 - float(np.exp(-elapsed_ns / SECOND_NS / TIME_CONSTANT_S))
        steps = share * (relative - self._smooth)
        lengths = np.sqrt(np.einsum("ij,ij->i", steps, steps))
        if math.isnan(lengths.sum()):
            self._smooth = np.where(np.isnan(steps), relative, self._smooth + steps)
            return _means_where_known(lengths)
        self._smooth = self._smooth + steps
        motion: list[float] = (_IN_PART @ lengths / _PART_SIZES).tolist()
        return motion


def _means_where_known(lengths: Array) -> list[float]:
    known = ~np.isnan(lengths)
    means: list[float] = (_IN_PART @ np.where(known, lengths, 0.0) / np.maximum(_IN_PART @ known, 1.0)).tolist()
    return means
