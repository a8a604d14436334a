"""Joints that a source loses for a moment: they are taken to go on with the rest of the body."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.skeletons import JOINTS

Array = NDArray[np.float64]

BRIDGED_NS = 3 * SECOND_NS // 10
"""So long (ns) a joint stays where it was relative to the others; after more, where it is cannot be known."""


class Bridge:
    """One agent's joints as last seen."""

    def __init__(self) -> None:
        self._joints: Array = np.full((len(JOINTS), 3), np.nan)
        self._seen_ns = np.zeros(len(JOINTS), np.int64)

    def over(self, stamp_ns: int, joints: Array, missing: Sequence[int]) -> Array:
        """Return the joints (15, 3) with those that are missing moved on from where they were; NaN after too long.

        They go as the joints do on average that are there now and were then.
        """
        seen = np.ones(len(JOINTS), dtype=bool)
        seen[missing] = False
        both = seen & ~np.isnan(self._joints[:, 0])
        gone = (joints[both] - self._joints[both]).mean(axis=0) if both.any() else np.zeros(3)
        lately = stamp_ns - self._seen_ns <= BRIDGED_NS
        moved_on = np.where(lately[:, None], self._joints + gone, np.nan)
        bridged: Array = np.where(seen[:, None], joints, moved_on)
        return bridged

    def keep(self, stamp_ns: int, bridged: Array, missing: Sequence[int]) -> None:
        """Remember a usable frame: what `over` returned for it."""
        self._joints = bridged
        seen_ns = np.full(len(JOINTS), stamp_ns)
        seen_ns[missing] = self._seen_ns[missing]
        self._seen_ns = seen_ns
