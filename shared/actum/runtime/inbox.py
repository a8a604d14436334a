"""Subscribers with rings, each read by a thread of its own, so that no stream can stall another."""

import threading
from collections.abc import Callable, Iterable

import zenoh
from zenoh import ext, handlers

from actum import keys

Subscriber = zenoh.Subscriber[zenoh.Handler[zenoh.Sample]] | ext.AdvancedSubscriber[zenoh.Handler[zenoh.Sample]]

RECOVERED = (keys.SEGMENT, keys.ACTION, keys.EVENT)
"""Topics on which every message counts: lost ones are requested again from their publishers."""
HISTORY_DEPTH = 16
"""Most earlier messages requested on each key."""
HISTORY_S = 4.0
"""Oldest message requested (s): two seconds of skew, two of waiting. Older ones have been answered."""


def subscribe(session: zenoh.Session, key_expr: str, ring: int, history_s: float | None = None) -> Subscriber:
    """Declare a subscriber. One with `history_s` also requests lost messages, and those put so long before it (s)."""
    channel: handlers.RingChannel[zenoh.Sample] = handlers.RingChannel(ring)
    if history_s is None:
        return session.declare_subscriber(key_expr, channel)
    return ext.declare_advanced_subscriber(
        session,
        key_expr,
        channel,
        history=ext.HistoryConfig(detect_late_publishers=True, max_samples=HISTORY_DEPTH, max_age=history_s),
        recovery=ext.RecoveryConfig(heartbeat=True, periodic_queries=None),
    )


class Inbox:
    """The subscriptions of one node; messages of the last `history_s` are requested, of `HISTORY_S` at the most (s)."""

    def __init__(
        self, session: zenoh.Session, topics: Iterable[keys.Topic], sensor: str, history_s: float = HISTORY_S
    ) -> None:
        history_s = min(history_s, HISTORY_S)
        self._subscribers = [
            subscribe(session, keys.pattern(topic, sensor), topic.ring, history_s if topic in RECOVERED else None)
            for topic in topics
        ]
        self._threads: list[threading.Thread] = []

    def start(self, receive: Callable[[zenoh.Sample], None]) -> None:
        """Call `receive` for each sample, from one thread per subscriber."""
        for subscriber in self._subscribers:
            thread = threading.Thread(target=_drain, args=(subscriber, receive), daemon=True)
            thread.start()
            self._threads.append(thread)

    def close(self) -> None:
        """End the subscriptions and wait for their threads."""
        for subscriber in self._subscribers:
            subscriber.undeclare()
        for thread in self._threads:
            thread.join(timeout=1.0)

    @property
    def working(self) -> bool:
        """Whether every thread still reads."""
        return all(thread.is_alive() for thread in self._threads)


def _drain(subscriber: Subscriber, receive: Callable[[zenoh.Sample], None]) -> None:
    for sample in subscriber:
        receive(sample)
