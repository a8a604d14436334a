"""Joints that a source loses for a moment are taken to move on with the rest of the body."""

from collections.abc import Sequence

import numpy as np

from actum.arrays import Array
from actum.node import SECOND_NS
from actum.skeletons import JOINTS

BRIDGED_NS = 3 * SECOND_NS // 10
"""So long (ns) a lost joint counts as keeping its place relative to the others; later its place is unknown."""


class Bridge:
    """One agent's joints as last seen, to fill gaps with."""

    def __init__(self) -> None:
        self._joints: Array = np.full((len(JOINTS), 3), np.nan)
        self._seen_ns = np.zeros(len(JOINTS), np.int64)

    def filled(self, stamp_ns: int, joints: Array, missing: Sequence[int]) -> Array:
        """Return joints (15, 3) with missing ones extrapolated; NaN where one was lost longer than `BRIDGED_NS` ago.

        A missing joint moves by the mean displacement, since the last usable frame, of the joints that are there now
        and were there then.

        Args:
            stamp_ns: of the frame.
            joints: (15, 3), camera frame, metres.
            missing: which of them are not known.
        """
        seen = np.ones(len(JOINTS), dtype=bool)
        seen[missing] = False
        both = seen & ~np.isnan(self._joints[:, 0])
        displacement = (joints[both] - self._joints[both]).mean(axis=0) if both.any() else np.zeros(3)
        lately = stamp_ns - self._seen_ns <= BRIDGED_NS
        extrapolated = np.where(lately[:, None], self._joints + displacement, np.nan)
        filled: Array = np.where(seen[:, None], joints, extrapolated)
        return filled

    def keep(self, stamp_ns: int, joints: Array, missing: Sequence[int]) -> None:
        """Remember a usable frame: its joints (15, 3) as `filled` returned them, and which of them were missing."""
        self._joints = joints
        seen_ns = np.full(len(JOINTS), stamp_ns)
        seen_ns[missing] = self._seen_ns[missing]
        self._seen_ns = seen_ns
