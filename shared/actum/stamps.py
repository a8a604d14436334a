"""Keeps a stream's capture stamps rising, notices when its source has started anew, and counts what was lost."""

from enum import Enum

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS

RESTART_AFTER = 3
"""A stream is taken to have restarted after this many rising stamps further back than any segment reaches."""

RESTART_BEHIND_NS = MAX_SEGMENT_NS + MAX_SKEW_NS
"""How far back that is (ns)."""


class Order(Enum):
    """How a stamp stands to the ones before it."""

    NEXT = "next"
    STALE = "stale"
    RESTART = "restart"


class StampGuard:
    """Judges each stamp of one stream: the next one, an older or repeated one, or the first after a restart."""

    def __init__(self) -> None:
        self.newest_ns: int | None = None
        self._session: str | None = None
        self._behind: list[int] = []

    def judge(self, stamp_ns: int, session_id: str = "") -> Order:
        """Judge one stamp; a changed session is a restart whatever the stamp says."""
        restarted = self._session is not None and session_id != self._session
        self._session = session_id
        if self.newest_ns is None or stamp_ns > self.newest_ns or restarted or self._has_restarted(stamp_ns):
            stepped_back = self.newest_ns is not None and stamp_ns <= self.newest_ns
            self.newest_ns = stamp_ns
            self._behind = []
            return Order.RESTART if restarted or stepped_back else Order.NEXT
        return Order.STALE

    def _has_restarted(self, stamp_ns: int) -> bool:
        assert self.newest_ns is not None
        if stamp_ns > self.newest_ns - RESTART_BEHIND_NS:
            self._behind = []
            return False
        rising = not self._behind or stamp_ns > self._behind[-1]
        self._behind = [*self._behind, stamp_ns] if rising else [stamp_ns]
        return len(self._behind) >= RESTART_AFTER


class LostFrames:
    """Counts the frames of one stream that never came, by the numbers of those that did."""

    def __init__(self) -> None:
        self._last_seq: int | None = None

    def before(self, seq: int | None, order: Order) -> int:
        """Return how many frames are missing right before this one; 0 where numbers are unknown or began anew."""
        last, self._last_seq = self._last_seq, seq
        if last is None or seq is None or order is Order.RESTART:
            return 0
        return max(seq - last - 1, 0)
