"""Checks the order of a stream's capture stamps: finds stale stamps, restarts of the source, and lost frames."""

from enum import Enum

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS

RESTART_AFTER = 3
"""A stream counts as restarted after this many rising stamps that lie behind the newest by more than is allowed."""

RESTART_BEHIND_NS = MAX_SEGMENT_NS + MAX_SKEW_NS
"""How far such stamps lie behind the newest one (ns): further than any open segment reaches back."""


class Order(Enum):
    """How a stamp compares with the earlier ones of its stream."""

    NEXT = "next"
    STALE = "stale"
    RESTART = "restart"


class StampGuard:
    """Classifies each stamp of one stream: the next one, a stale one (older or repeated), or the first of a restart.

    Args:
        restart_behind_ns: how far stamps lie behind the newest (ns) that count as a restart.
    """

    def __init__(self, restart_behind_ns: int = RESTART_BEHIND_NS) -> None:
        self._restart_behind_ns = restart_behind_ns
        self.newest_ns: int | None = None
        self._session: str | None = None
        self._far_behind_ns: list[int] = []

    def judge(self, stamp_ns: int, session_id: str = "") -> Order:
        """Classify one stamp. The first one of another session is a restart, whatever its value."""
        restarted = self._session is not None and session_id != self._session
        self._session = session_id
        if self.newest_ns is None or stamp_ns > self.newest_ns or restarted or self._has_restarted(stamp_ns):
            stepped_back = self.newest_ns is not None and stamp_ns <= self.newest_ns
            self.newest_ns = stamp_ns
            self._far_behind_ns = []
            return Order.RESTART if restarted or stepped_back else Order.NEXT
        return Order.STALE

    def _has_restarted(self, stamp_ns: int) -> bool:
        assert self.newest_ns is not None
        if stamp_ns > self.newest_ns - self._restart_behind_ns:
            self._far_behind_ns = []
            return False
        rising = not self._far_behind_ns or stamp_ns > self._far_behind_ns[-1]
        self._far_behind_ns = [*self._far_behind_ns, stamp_ns] if rising else [stamp_ns]
        return len(self._far_behind_ns) >= RESTART_AFTER


class LostFrames:
    """Counts the lost frames of one stream by the gaps in their sequence numbers."""

    def __init__(self) -> None:
        self._last_seq: int | None = None

    def before(self, seq: int | None, order: Order) -> int:
        """Return how many frames are missing right before this one; 0 without numbers and after a restart."""
        last, self._last_seq = self._last_seq, seq
        if last is None or seq is None or order is Order.RESTART:
            return 0
        return max(seq - last - 1, 0)
