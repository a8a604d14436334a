"""What a soak measures: memory of processes, latencies and losses as a subscriber meets them, minute by minute."""

import threading
import time
from collections import Counter, defaultdict, deque

import numpy as np
import psutil
import zenoh

from actum import codec
from actum.messages import Action, Event, Message, Objects, Posture, Segment, Skeleton, Status

PENDING = 300
"""Frames whose answers may still come: ten seconds."""
ROWS = ("skeleton → last posture", "skeleton → partial action", "skeleton → objects", "end mark → event")
"""The latencies that are measured. Of an event, most is the wait for the streams to reach the end mark's stamp."""


class Memory:
    """Resident memory of processes, once a second."""

    def __init__(self, names: dict[int, str]) -> None:
        self._processes = {name: psutil.Process(pid) for pid, name in names.items()}
        self.mb: dict[str, list[tuple[float, float]]] = defaultdict(list)
        """Of each process, seconds since the beginning and resident memory (MB)."""

    def measure(self, now_s: float) -> None:
        """Measure once.

        Raises:
            psutil.NoSuchProcess: one has ended.
        """
        for name, process in self._processes.items():
            self.mb[name].append((now_s, process.memory_info().rss / 1e6))


class Watch:
    """Takes all messages as they come, and notes by the minute how long after its cause each came."""

    def __init__(self) -> None:
        self.minute = 0
        self.took_ms: dict[str, dict[int, list[float]]] = {row: defaultdict(list) for row in ROWS}
        self.statuses: dict[str, Status] = {}
        self.marked: set[str] = set()
        self.events: Counter[str] = Counter()
        self._frames: dict[int, float] = {}
        self._order: deque[int] = deque()
        self._ends: dict[str, float] = {}
        self._lock = threading.Lock()

    def arrived(self, sample: zenoh.Sample) -> None:
        """Take a sample."""
        now_s = time.perf_counter()
        message = codec.decode(str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding))
        with self._lock:
            self._take(message, now_s)

    def _take(self, message: Message, now_s: float) -> None:
        match message:
            case Skeleton():
                self._begin(message.stamp_ns, now_s)
            case Posture() if message.agents and message.agent == message.agents[-1]:
                self._since(ROWS[0], self._frames.get(message.stamp_ns), now_s)
            case Action(final=False):
                self._since(ROWS[1], self._frames.get(message.stamp_ns), now_s)
            case Objects():
                self._since(ROWS[2], self._frames.get(message.stamp_ns), now_s)
            case Segment(kind="end") if message.origin == "simulator":
                self.marked.add(message.segment_id)
                self._ends[message.segment_id] = now_s
            case Event():
                self.events[message.segment_id] += 1
                self._since(ROWS[3], self._ends.pop(message.segment_id, None), now_s)
            case Status():
                self.statuses[message.service] = message

    def _begin(self, stamp_ns: int, now_s: float) -> None:
        self._frames[stamp_ns] = now_s
        self._order.append(stamp_ns)
        if len(self._order) > PENDING:
            del self._frames[self._order.popleft()]

    def _since(self, row: str, began_s: float | None, now_s: float) -> None:
        if began_s is not None:
            self.took_ms[row][self.minute].append(1000 * (now_s - began_s))

    def p99_ms(self, row: str) -> list[float]:
        """Return the 99th percentile of each minute that has passed; NaN where nothing came."""
        minutes = (self.took_ms[row][minute] for minute in range(1, self.minute + 1))
        return [float(np.percentile(took, 99)) if took else float("nan") for took in minutes]

    def lost(self) -> dict[str, int]:
        """Return how many messages each service has lost by key, but images, of which only the newest counts."""
        found = ((s.service, key, n) for s in self.statuses.values() for key, n in s.drops.items())
        return {f"{service} {key}": n for service, key, n in found if "/image/" not in key}

    def unanswered(self) -> set[str]:
        """Return the marked segments that had no event, or several."""
        return {each for each in self.marked if self.events[each] != 1 and each not in self._ends}
