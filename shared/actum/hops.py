"""Where the time goes: how long after its cause each message is received, over the last minute.

All times are of one clock, that of the process that receives cause and effect; no stamp is compared with a clock, so
clocks of several hosts do not matter. Both messages crossed the network to that process: a hop is measured as a reader
sees it, with the difference of both ways in it.
"""

import math
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from actum.messages import AUTO, Action, Event, HopTime, Image, Message, Objects, Posture, Segment, Skeleton
from actum.node import SECOND_NS

MINUTE_S = 60
"""What is counted goes back so far (s)."""
SETTLING_NS = SECOND_NS
"""After the first message so long (ns) nothing is measured: what publishers have kept of before comes all at once."""
MOST_WAITING = 4096
"""Causes of a hop that are remembered, and effects without one: of fifty people's postures nearly three seconds."""
MOST_AHEAD_NS = SECOND_NS // 10
"""An effect that another thread reads before its cause is at most so far ahead (ns). One further ahead
has another cause, such as the answer to a mark that had no end for too long."""
SHORTEST_MS = 0.01
"""Delay (ms) below which all delays count as this: less than a clock's reading and a lock take."""
STEP = 1.05
"""Ratio of neighbouring delays that are told apart: a percentile is right to 2.5 %."""
STEPS = 330
"""Delays that are told apart: the longest is 98 s, longer than any service waits. An hour's count as that."""


@dataclass(frozen=True)
class Hop:
    """Two messages of which one follows from the other, and what both have in common."""

    cause: str
    effect: str
    shared: Callable[[Any], Hashable]


HOPS = (
    Hop("image", "skeleton", attrgetter("stamp_ns")),
    Hop("image", "objects", attrgetter("stamp_ns")),
    Hop("skeleton", "posture", attrgetter("stamp_ns")),
    Hop("posture", "partial action", attrgetter("stamp_ns", "agent")),
    Hop("end mark", "final action", attrgetter("segment_id")),
    Hop("final action", "event", attrgetter("segment_id")),
    Hop("end mark", "event", attrgetter("segment_id")),
)
"""What is measured. Services do not mark ends: the end of a segment that the classifier has found is no cause."""


def kind_of(message: Message) -> str | None:
    """Return the name that a message has in `HOPS`; None where it is neither cause nor effect."""
    match message:
        case Segment(kind="end", origin=origin):
            return None if origin == AUTO else "end mark"
        case Action(final=final):
            return "final action" if final else "partial action"
        case Image() | Skeleton() | Objects() | Posture() | Event():
            return type(message).__name__.lower()
        case _:
            return None


class Hops:
    """Measures every hop of one sensor.

    Args:
        clock: the time (ns) at which a message is received; it never goes back.
    """

    def __init__(self, clock: Callable[[], int]) -> None:
        self._clock = clock
        self._began_ns: int | None = None
        self._caused_ns: dict[Hop, dict[Hashable, int]] = {hop: {} for hop in HOPS}
        self._early_ns: dict[Hop, dict[Hashable, int]] = {hop: {} for hop in HOPS}
        self._delays = {hop: Delays() for hop in HOPS}

    def receive(self, message: Message) -> None:
        """Measure from the causes of this message to now, and remember it as a cause."""
        kind, now_ns = kind_of(message), self._clock()
        self._began_ns = now_ns if self._began_ns is None else self._began_ns
        if kind is None or now_ns - self._began_ns < SETTLING_NS:
            return
        for hop in HOPS:
            if hop.cause == kind:
                self._caused(hop, hop.shared(message), now_ns)
            elif hop.effect == kind:
                self._followed(hop, hop.shared(message), now_ns)

    def _caused(self, hop: Hop, shared: Hashable, now_ns: int) -> None:
        """Remember a cause; an effect that was read just before it, by another thread, has taken no time."""
        _remember(self._caused_ns[hop], shared, now_ns)
        early_ns = self._early_ns[hop].pop(shared, None)
        if early_ns is not None and now_ns - early_ns <= MOST_AHEAD_NS:
            self._delays[hop].add(0, now_ns)

    def _followed(self, hop: Hop, shared: Hashable, now_ns: int) -> None:
        caused_ns = self._caused_ns[hop].get(shared)
        if caused_ns is None:
            _remember(self._early_ns[hop], shared, now_ns)
        else:
            self._delays[hop].add(now_ns - caused_ns, now_ns)

    def times(self) -> list[HopTime]:
        """Return the times of the last minute of each hop that anything has taken."""
        now_ns = self._clock()
        each = ((hop, *delays.told(now_ns)) for hop, delays in self._delays.items())
        return [
            HopTime(cause=hop.cause, effect=hop.effect, count=count, p50_ms=p50_ms, p99_ms=p99_ms)
            for hop, count, p50_ms, p99_ms in each
            if count
        ]


def _remember(times_ns: dict[Hashable, int], shared: Hashable, now_ns: int) -> None:
    """Note a time under what messages share; of too many, the oldest is forgotten."""
    times_ns.pop(shared, None)
    times_ns[shared] = now_ns
    if len(times_ns) > MOST_WAITING:
        del times_ns[next(iter(times_ns))]


class Delays:
    """Delays of the last minute, counted by second and by size: their number does not matter to its memory."""

    def __init__(self) -> None:
        self._counts = np.zeros((MINUTE_S, STEPS), dtype=np.int32)
        self._second = -MINUTE_S

    def add(self, delay_ns: int, now_ns: int) -> None:
        """Count a delay (ns) that ends now."""
        self._forget(now_ns)
        ratio = max(delay_ns / 1e6 / SHORTEST_MS, 1.0)
        self._counts[self._second % MINUTE_S, min(round(math.log(ratio, STEP)), STEPS - 1)] += 1

    def told(self, now_ns: int) -> tuple[int, float, float]:
        """Return how many there are, and the delays (ms) that half of them and 99 of 100 do not exceed."""
        self._forget(now_ns)
        up_to = np.cumsum(self._counts.sum(axis=0))
        count = int(up_to[-1])
        p50_ms, p99_ms = (SHORTEST_MS * STEP ** int(np.searchsorted(up_to, share * count)) for share in (0.5, 0.99))
        return count, round(p50_ms, 3), round(p99_ms, 3)

    def _forget(self, now_ns: int) -> None:
        """Empty the rows of the seconds that have begun since."""
        second = now_ns // SECOND_NS
        for begun in range(max(self._second, second - MINUTE_S) + 1, second + 1):
            self._counts[begun % MINUTE_S] = 0
        self._second = second
