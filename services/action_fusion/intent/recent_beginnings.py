"""How often a person has moved objects lately: who acts goes on to act, and who does other things touches little."""

import math
from collections import deque
from collections.abc import Collection

from actum.node import SECOND_NS

RESTED_NS = SECOND_NS
"""An object that moves after so long a rest (ns) begins to move: a spoon that stirs moves on and on."""
LATELY_NS = 15 * SECOND_NS
"""After so long (ns) a beginning counts 1/e: that is a few actions of somebody who does one after the other."""
ASSUMED = 2
"""Beginnings that a person is thought to have made at the first posture, when nothing is known yet: fewer than those of
somebody who acts all the time, and more than those of somebody who does other things."""
MOST_BEGINNINGS = 64
"""Beginnings that are kept: nobody makes more within a minute, after which each counts little."""


class RecentBeginnings:
    """When objects began to move in a person's hands."""

    def __init__(self) -> None:
        self._moved_ns: dict[int, int] = {}
        self._begun_ns: deque[int] = deque(maxlen=MOST_BEGINNINGS)

    def with_moved(self, stamp_ns: int, moved: Collection[int]) -> float:
        """Take which objects a hand moves at the next stamp; return how many have begun to move lately.

        Each counts the less the longer ago it began.
        """
        if not self._begun_ns:
            self._begun_ns.extend([stamp_ns] * ASSUMED)
        self._moved_ns = {number: at for number, at in self._moved_ns.items() if stamp_ns - at < RESTED_NS}
        self._begun_ns.extend(stamp_ns for number in moved if number not in self._moved_ns)
        self._moved_ns |= dict.fromkeys(moved, stamp_ns)
        return sum(math.exp((began_ns - stamp_ns) / LATELY_NS) for began_ns in self._begun_ns)
