"""When what was put and how long it took to arrive, and the tables of that."""

import threading
import time
from collections import defaultdict
from collections.abc import Sequence

import msgpack
import numpy as np
import zenoh
from rich.table import Table

from actum import codec, keys
from actum.messages import Action, Event, Message

ROWS = (
    ("skeleton → posture", "frame posture", "bench/frame/1"),
    ("skeleton → partial action", "frame action", "bench/frame/2"),
    ("end mark → final action", "mark action", "bench/mark/1"),
    ("end mark → event, without the wait below", "mark event", "bench/mark/2"),
    ("  of which waiting for the objects stream", "wait", None),
)
"""Each row's title, what it is of our times, and of those of the bare chain."""
PERCENTILES = ("p50", "p95", "p99")
Times = dict[str, list[float]]


class Stopwatch:
    """When what was put, and how long it took to arrive; milliseconds on one clock."""

    def __init__(self) -> None:
        self.took_ms: Times = defaultdict(list)
        self._put_ns: dict[tuple[str, object], int] = {}
        self._final_ns: dict[str, int] = {}
        self._lock = threading.Lock()

    def put(self, what: str, name: object) -> None:
        """Note that something is put now."""
        self._put_ns[what, name] = time.perf_counter_ns()

    def arrived(self, sample: zenoh.Sample) -> None:
        """Note what arrives, by its key."""
        now_ns = time.perf_counter_ns()
        key = str(sample.key_expr)
        with self._lock:
            if key.startswith("bench/"):
                assert sample.attachment is not None
                number = msgpack.unpackb(sample.attachment.to_bytes())
                self._since(key, "/".join(key.split("/")[:2]), number, now_ns)
            else:
                self._ours(codec.decode(key, sample.payload.to_bytes(), str(sample.encoding)), now_ns)

    def _ours(self, message: Message, now_ns: int) -> None:
        match message:
            case Action(final=True):
                self._since("mark action", "mark", message.segment_id, now_ns)
                self._final_ns[message.segment_id] = now_ns
            case Event():
                self._event(message, now_ns)
            case _:
                name = keys.address_of(message).topic.leaf.removesuffix("/{}")
                self._since(f"frame {name}", "frame", message.stamp_ns, now_ns)

    def _event(self, event: Event, now_ns: int) -> None:
        put_ns = ((stamp, put) for (what, stamp), put in self._put_ns.items() if what == "objects")
        reached_ns = min(put for stamp, put in put_ns if isinstance(stamp, int) and stamp >= event.end_ns)
        wait_ms = max(reached_ns - self._final_ns.get(event.segment_id, reached_ns), 0) / 1e6
        self.took_ms["wait"].append(wait_ms)
        total_ms = (now_ns - self._put_ns["mark", event.segment_id]) / 1e6
        self.took_ms["mark event"].append(total_ms - wait_ms)

    def _since(self, row: str, what: str, name: object, now_ns: int) -> None:
        if (what, name) in self._put_ns:
            self.took_ms[row].append((now_ns - self._put_ns[what, name]) / 1e6)


def beside_bare(took_ms: Times) -> Table:
    """Percentiles of each hop beside the bare chain's, and the ratio of the medians."""
    table = Table("milliseconds", title="latency, and a bare Zenoh chain of the same hops and sizes in the same run")
    for heading in (*PERCENTILES, "bare p50", "p95", "p99", "p50 ratio"):
        table.add_column(heading, justify="right")
    for title, row, bare in ROWS:
        here = percentiles(took_ms[row])
        there = percentiles(took_ms[bare]) if bare else []
        ratio = f"{here[0] / there[0]:.2f}" if there else ""
        table.add_row(
            title, *map("{:.2f}".format, here), *(map("{:.2f}".format, there) if there else ("", "", "")), ratio
        )
    return table


def behind_security(secured_ms: Times, plain_ms: Times) -> Table:
    """Percentiles of each hop where the router asks who connects, and how much later the median is."""
    table = Table("milliseconds", title="the same with mutual TLS, passwords and access control, another run")
    for heading in (*PERCENTILES, "p50 later by"):
        table.add_column(heading, justify="right")
    for title, row, _ in ROWS[:-1]:
        here, there = percentiles(secured_ms[row]), percentiles(plain_ms[row])
        table.add_row(title, *map("{:.2f}".format, here), f"{here[0] - there[0]:+.2f}")
    return table


def percentiles(values_ms: Sequence[float]) -> list[float]:
    """The median and the tail."""
    result: list[float] = np.percentile(values_ms, [50, 95, 99]).tolist()
    return result
