"""How much each body part moves from frame to frame; attention goes to the part that moves most (paper, 2.1)."""

import math

import numpy as np

from actum.arrays import Array, has_unknown
from actum.node import SECOND_NS
from actum.skeletons import INDEX, PARTS

GAP_NS = SECOND_NS // 2
"""After a longer pause (ns) between two frames filters restart: the motion in between is unknown."""
TIME_CONSTANT_S = 0.3
"""Time constant of the low-pass: noise of single frames averages out, an action of a second or more remains."""
_IN_PART = np.array([[joint in part for joint in range(len(INDEX))] for part in PARTS.values()], dtype=np.float64)
_PART_SIZES = _IN_PART.sum(axis=1)
_TORSO = INDEX["torso"]
PART_OF = _IN_PART.argmax(axis=0).astype(np.int32).tobytes()
"""The part of each joint, (15,), as the compiled step reads it."""


class PartMotionFilter:
    """The mean displacement of each body part of one agent, from low-passed joints relative to the torso.

    Sums of unfiltered displacements would add up a joint's noise, which is largest at the feet. Egocentric axes jitter
    themselves, and move a joint the more the further it is from the hips; therefore the camera's axes are used.

    Attributes:
        smooth: (15, 3), the low-passed joints relative to the torso (m); the compiled step advances them, too.
    """

    def __init__(self) -> None:
        self._stamp_ns: int | None = None
        self.smooth: Array = np.zeros((len(INDEX), 3))

    def restarts_at(self, stamp_ns: int) -> bool:
        """Return whether a step at this stamp would restart the filter, after a gap or for the first time."""
        return self._stamp_ns is None or stamp_ns - self._stamp_ns > GAP_NS

    def gain(self, stamp_ns: int) -> float:
        """Return by how much the low-pass follows a frame, 0 where it restarts: stamps rise."""
        before_ns, self._stamp_ns = self._stamp_ns, stamp_ns
        if before_ns is None or stamp_ns - before_ns > GAP_NS:
            return 0.0
        return 1.0 - math.exp(-(stamp_ns - before_ns) / SECOND_NS / TIME_CONSTANT_S)

    def step(self, stamp_ns: int, joints: Array) -> list[float]:
        """Return each part's mean displacement since the frame before, (5,), metres; 0 at first and after a gap.

        The mean is over the joints known in this frame and the one before; 0 where there is none.

        Args:
            stamp_ns: rising from call to call.
            joints: (15, 3), camera frame, metres, with short gaps bridged: a joint that flickers would move less far
                than one that does not, so that another part would seem to move most. NaN where unknown.
        """
        relative, gain = joints - joints[_TORSO], self.gain(stamp_ns)
        if gain == 0.0:
            self.smooth = relative
            return [0.0] * len(PARTS)
        by = gain * (relative - self.smooth)
        lengths = np.sqrt(np.einsum("ij,ij->i", by, by))
        if has_unknown(lengths):
            self.smooth = np.where(np.isnan(by), relative, self.smooth + by)
            known = ~np.isnan(lengths)
            motion = _IN_PART @ np.where(known, lengths, 0.0) / np.maximum(_IN_PART @ known, 1.0)
        else:
            self.smooth = self.smooth + by
            motion = _IN_PART @ lengths / _PART_SIZES
        means: list[float] = motion.tolist()
        return means
