"""Reports of a running service: its counts, losses and latencies as `status` and `info`, and changes as log lines."""

import logging
import socket
import threading
import time
from collections import Counter, deque
from collections.abc import Callable

import numpy as np
import zenoh

from actum import __version__
from actum.codec import encodable, schema_name
from actum.health import HealthFile
from actum.messages import MESSAGES, Action, Info, Message, Status
from actum.node import Counters
from actum.runtime.outbox import Outbox
from actum.runtime.place import Place
from actum.runtime.session import connected
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings
from actum.skeletons import JOINTS
from actum.states import State

log = logging.getLogger("actum")

LATENCIES = 1800
"""Latencies kept for the percentiles: a minute of one person's stream."""
MOST_KEYS = 256
"""Most keys that are counted: the one silent for longest, such as that of an agent who left, makes room."""
MOST_ORIGINS = 16
"""Most publishers on a key whose numbers are followed: each mark may come from a process of its own."""
HISTORY_NS = 3_000_000_000
"""How long after their request earlier actions can come (ns), in whose numbers there are gaps: they come at once, but
twice `subscribing.ANSWER_S` later if a publisher does not answer."""
REPORT_S = 1.0
"""Interval between two reports (s)."""


class Meter:
    """Counts what comes in, per key, and how long handling takes; thread-safe under the runtime's lock."""

    def __init__(self, name: str, counters: Counters, settings: ServiceSettings) -> None:
        self._name = name
        self._counters = counters
        self._settings = settings
        self._started_ns = time.monotonic_ns()
        self._reported_ns = self._started_ns
        self._handled: Counter[str] = Counter()
        self._reported: Counter[str] = Counter()
        self._drops: Counter[str] = Counter()
        self._last_seq: dict[str, dict[str, int]] = {}
        self._actions_count_from_ns = self._started_ns
        self._latencies_ms: deque[float] = deque(maxlen=LATENCIES)

    def await_history(self) -> None:
        """Take gaps in the numbers of actions for no losses for now: of those of before only the final are kept."""
        self._actions_count_from_ns = time.monotonic_ns() + HISTORY_NS

    def received(self, key: str, message: Message, origin: str = "") -> None:
        """Count a message, and those lost before it by the gap in `seq`; each publisher (`origin`) numbers its own."""
        self.count(key)
        if message.seq is None:
            return
        numbers = self._last_seq.setdefault(key, {})
        lost = max(message.seq - numbers.pop(origin, message.seq) - 1, 0)
        if not isinstance(message, Action) or time.monotonic_ns() >= self._actions_count_from_ns:
            self._drops[key] += lost
        numbers[origin] = message.seq
        if len(numbers) > MOST_ORIGINS:
            del numbers[next(iter(numbers))]

    def count(self, key: str) -> None:
        """Count a message that the service received or put."""
        self._handled[key] = self._handled.pop(key, 0) + 1
        if len(self._handled) > MOST_KEYS:
            silent = next(iter(self._handled))
            for counts in (self._handled, self._reported, self._drops, self._last_seq):
                counts.pop(silent, None)

    def took(self, milliseconds: float) -> None:
        """Record a latency: from a message's arrival to the last put of its answer (ms)."""
        self._latencies_ms.append(milliseconds)

    def status(self) -> Status:
        """Return the service's status, with rates since the last call."""
        now_ns = time.monotonic_ns()
        elapsed_s = max((now_ns - self._reported_ns) / 1e9, 1e-6)
        rates = {key: round((n - self._reported[key]) / elapsed_s, 2) for key, n in self._handled.items()}
        self._reported, self._reported_ns = Counter(self._handled), now_ns
        return Status(
            stamp_ns=time.time_ns(),
            sensor=self._settings.sensor,
            service=self._name,
            instance=self._settings.instance,
            uptime_s=round((now_ns - self._started_ns) / 1e9, 3),
            rates=rates,
            handled=dict(self._handled),
            drops={key: n for key, n in self._drops.items() if n},
            rejects=dict(self._counters.rejects),
            last_error=self._counters.last_error,
            latency_ms=_percentiles(list(self._latencies_ms)),
            state=self._counters.told_state,
            counts=dict(self._counters.counts),
            hops=self._counters.hops,
        )

    def info(self) -> Info:
        """Return the service's description."""
        details = {name: encodable(text) for name, text in self._counters.details.items()}
        return Info(
            stamp_ns=time.time_ns(),
            sensor=self._settings.sensor,
            service=self._name,
            instance=self._settings.instance,
            version=__version__,
            schemas=[schema_name(message) for message in MESSAGES],
            joint_names=list(JOINTS),
            model=details.get("model"),
            calibration=details.get("calibration"),
            host=encodable(socket.gethostname()),
            source=details.get("source"),
            rate_hz=float(details["rate_hz"]) if "rate_hz" in details else None,
            page=details.get("page"),
        )


class Reporter:
    """Reports while a service runs, and stops it where another instance takes over."""

    def __init__(self, meter: Meter, counters: Counters, settings: ServiceSettings, lock: Turns) -> None:
        self._meter, self._counters, self._settings, self._lock = meter, counters, settings, lock
        self._health_file = HealthFile(settings.health_file)
        self._connected = True
        self._trouble: str | None = None

    def log_state(self) -> None:
        """Log each new problem of the service once, and its end; other changes of the state are not logged."""
        well = State.of(self._counters.state) is State.RUNNING
        trouble = None if well else self._counters.told_state
        source = self._counters.details.get("source")
        if trouble is not None and trouble != self._trouble:
            log.warning("%s", f"{trouble} ({source})" if source else trouble)
        elif trouble is None and self._trouble is not None:
            log.info("running again")
        self._trouble = trouble

    def report(
        self,
        session: zenoh.Session,
        place: Place,
        stop: threading.Event,
        healthy: Callable[[], bool],
        store: Callable[[], None],
    ) -> None:
        """Report once a second until stopped, and have stored what the service writes."""
        outbox = Outbox(session)
        while not stop.wait(REPORT_S):
            with self._lock:
                status = self._meter.status()
                self.log_state()
            outbox.put(status)
            self._log_connection(connected(session))
            self._health_file.write(healthy() and self._connected)
            store()
            successor = place.lost_to()
            if successor is not None:
                log.warning(
                    "the instance %s replaces this instance for sensor %s, so this instance stops",
                    successor,
                    self._settings.sensor,
                )
                stop.set()

    def _log_connection(self, now: bool) -> None:
        """Log once that the router is lost, and once that it is back."""
        if self._connected and not now:
            log.warning("the connection to the router at %s is lost: waiting for the router", self._settings.connect)
        elif now and not self._connected:
            log.info("connected to %s again", self._settings.connect)
        self._connected = now


def _percentiles(values_ms: list[float]) -> dict[str, float]:
    if not values_ms:
        return {}
    p50, p99 = np.percentile(values_ms, [50, 99]).tolist()
    return {"p50": round(p50, 3), "p99": round(p99, 3)}
