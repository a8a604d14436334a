"""The sensor's newest frames, kept in memory, from which an event's frames can still be taken minutes later."""

from collections import deque
from collections.abc import Iterator

from actum import codec
from actum.messages import Skeleton
from actum.node import SECOND_NS
from actum.stamps import Order, StampGuard

SLACK_NS = 1000
"""By how much stamps may be wrong: a browser's numbers hold stamps to 256 ns."""
LONGEST_S = 600.0
"""Oldest frame (s), as the page's timeline shows events for ten minutes."""
MOST_BYTES = 64_000_000
"""Most memory: ten minutes of four people; of more people less is kept."""


class RecentFrames:
    """Keeps frames as they came, encoded: decoded ones take ten times the memory."""

    def __init__(self) -> None:
        self._frames: deque[tuple[int, codec.Frame]] = deque()
        self._bytes = 0
        self._order = StampGuard()

    def receive(self, skeleton: Skeleton) -> None:
        """Keep a frame, and drop those that are too old; after a restart of the sensor, all before."""
        order = self._order.judge(skeleton.stamp_ns, skeleton.session_id)
        if order is Order.STALE:
            return
        if order is Order.RESTART:
            self._frames.clear()
            self._bytes = 0
        self._frames.append((skeleton.stamp_ns, codec.encode(skeleton)))
        self._bytes += len(self._frames[-1][1].payload)
        oldest_ns = skeleton.stamp_ns - LONGEST_S * SECOND_NS
        while self._frames[0][0] < oldest_ns or self._bytes > MOST_BYTES:
            self._bytes -= len(self._frames.popleft()[1].payload)

    def of(self, agent: int, start_ns: int, end_ns: int) -> Iterator[Skeleton]:
        """Yield the frames from one stamp to another in which somebody is seen, with nobody else in them."""
        for stamp_ns, frame in self._frames:
            if start_ns - SLACK_NS <= stamp_ns <= end_ns + SLACK_NS:
                skeleton = codec.decode(frame.key, frame.payload)
                assert isinstance(skeleton, Skeleton)
                agents = [each for each in skeleton.agents if each.agent == agent]
                if agents:
                    yield skeleton.model_copy(update={"agents": agents})
