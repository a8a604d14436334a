"""Whether a stream goes on or stands still, judged by ticks alone: nobody can answer while a link is cut."""

from typing import Final

from actum.node import SECOND_NS

STILL_NS: Final = SECOND_NS // 2
"""A stream without a message for longer than this stands still (ns): the slowest in use have five messages a second."""
PATIENCE_NS: Final = 10 * SECOND_NS
"""One that stands still for longer than this has ended (ns): publishers keep as much for a link that was cut."""


class Flow:
    """The flow of one stream, noted with each message and each tick."""

    def __init__(self) -> None:
        self._arrived = False
        self._last_ns: int | None = None
        self._now_ns = 0
        self._resumed_ns = 0

    def note(self) -> None:
        """Note that a message has come."""
        self._arrived = True

    def expect(self) -> None:
        """Wait for the stream as for one that has just stopped: it was there before this process."""
        self._last_ns = self._now_ns

    def tick(self, now_ns: int) -> None:
        """Note that time goes on."""
        self._now_ns = now_ns
        if self._arrived:
            if self._last_ns is not None and now_ns - self._last_ns > STILL_NS:
                self._resumed_ns = now_ns
            self._last_ns, self._arrived = now_ns, False

    def ended(self, since_ns: int, patience_ns: int) -> bool:
        """Tell whether what was waited for since a tick (ns) will come no more: the stream went on without it.

        One that stands still is waited for, and for `patience_ns` after it goes on; of one that stutters for ever,
        nothing is awaited for longer than both.
        """
        if self._now_ns - since_ns > PATIENCE_NS + patience_ns:
            return True
        stands_still = self._last_ns is not None and STILL_NS < self._now_ns - self._last_ns <= PATIENCE_NS
        return not stands_still and self._now_ns - max(since_ns, self._resumed_ns) >= patience_ns
