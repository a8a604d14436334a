"""Fills short gaps in single joints: a joint that is lost for a moment moves with the rest of the body."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array
from actum.node import SECOND_NS
from actum.skeletons import JOINTS

BRIDGED_NS = 3 * SECOND_NS // 10
"""Longest gap that is filled (ns): for so long a lost joint keeps its place relative to the others."""


class Bridge:
    """Fills gaps in one agent's joints, from its last usable frame."""

    def __init__(self) -> None:
        self._joints: Array = np.full((len(JOINTS), 3), np.nan)
        self._measured_ns: NDArray[np.int64] | int = 0

    def filled(self, stamp_ns: int, joints: Array, missing: Sequence[int]) -> Array:
        """Return joints (15, 3) with missing ones extrapolated; NaN where one was lost longer than `BRIDGED_NS` ago.

        A missing joint moves by the mean displacement, since the last usable frame, of the joints that are there now
        and were there then.

        Args:
            stamp_ns: of the frame.
            joints: (15, 3), camera frame, metres.
            missing: which of them are not known.
        """
        measured = np.ones(len(JOINTS), dtype=bool)
        measured[missing] = False
        in_both = measured & ~np.isnan(self._joints[:, 0])
        displacement = (joints[in_both] - self._joints[in_both]).mean(axis=0) if in_both.any() else np.zeros(3)
        recent = stamp_ns - self._of_each() <= BRIDGED_NS
        extrapolated = np.where(recent[:, None], self._joints + displacement, np.nan)
        filled: Array = np.where(measured[:, None], joints, extrapolated)
        return filled

    def keep(self, stamp_ns: int, joints: Array, missing: Sequence[int]) -> None:
        """Remember a usable frame: its joints (15, 3) as `filled` returned them, and which of them were missing."""
        self._joints = joints
        if not missing:
            self._measured_ns = stamp_ns
            return
        measured_ns = np.full(len(JOINTS), stamp_ns)
        measured_ns[missing] = self._of_each()[missing]
        self._measured_ns = measured_ns

    def _of_each(self) -> NDArray[np.int64]:
        """Return when each joint was measured last (ns), (15,)."""
        return np.broadcast_to(self._measured_ns, len(JOINTS))
