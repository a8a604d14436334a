"""Keeps a stream's capture stamps rising, and notices when its source has started anew."""

from enum import Enum

RESTART_AFTER = 3
"""A stream is taken to have restarted after this many rising stamps further back than any segment reaches."""

RESTART_BEHIND_NS = 62_000_000_000


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
