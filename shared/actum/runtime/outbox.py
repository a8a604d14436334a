"""Puts messages on their keys, numbered, with the quality of service that the table of topics gives."""

import threading
from collections import OrderedDict

import zenoh
from zenoh import ext

from actum import keys
from actum.codec import encode
from actum.messages import Action, Message
from actum.node import Numbering

CACHE_DEPTH = 64
"""Messages that a publisher keeps on each key for late or interrupted subscribers: more than any requests."""
HEARTBEAT_S = 0.5
"""Interval (s) at which a publisher repeats its newest number, so that a loss of the last message is noticed."""
MOST_PUBLISHERS = 256
"""Most open publishers: agents come and go with new numbers, and the publisher silent for longest makes room."""

_CONGESTION = {"drop": zenoh.CongestionControl.DROP, "block": zenoh.CongestionControl.BLOCK}
"""Zenoh's congestion control, used where a reader is slow, by our names."""
_PRIORITY = {
    "interactive_high": zenoh.Priority.INTERACTIVE_HIGH,
    "data_high": zenoh.Priority.DATA_HIGH,
    "data_low": zenoh.Priority.DATA_LOW,
    "background": zenoh.Priority.BACKGROUND,
}
"""Zenoh's priorities by our names."""
Publisher = zenoh.Publisher | ext.AdvancedPublisher


class Outbox:
    """One publisher per key and kind (cached or plain), declared when first needed, `MOST_PUBLISHERS` at the most."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session, self._origin = session, str(session.zid())
        self._numbering = Numbering()
        self._publishers: OrderedDict[tuple[str, bool], Publisher] = OrderedDict()
        self._lock = threading.Lock()

    def put(self, message: Message) -> None:
        """Number and put one message."""
        with self._lock:
            frame = encode(self._numbering.numbered(message), self._origin)
            self._publisher(frame.key, _is_cached(message)).put(
                frame.payload, encoding=frame.encoding, attachment=frame.attachment
            )

    def declare(self, key: str) -> None:
        """Declare a key's publisher ahead of the first put."""
        with self._lock:
            self._publisher(key, keys.parse(key).topic.cached)

    def _publisher(self, key: str, cached: bool) -> Publisher:
        if (key, cached) not in self._publishers:
            topic = keys.parse(key).topic
            declare = self._declare_cached if cached else self._declare_plain
            self._publishers[key, cached] = declare(key, topic)
            if len(self._publishers) > MOST_PUBLISHERS:
                self._publishers.popitem(last=False)[1].undeclare()
        self._publishers.move_to_end((key, cached))
        return self._publishers[key, cached]

    def _declare_plain(self, key: str, topic: keys.Topic) -> Publisher:
        return self._session.declare_publisher(
            key,
            congestion_control=_CONGESTION[topic.congestion],
            priority=_PRIORITY[topic.priority],
            express=topic.priority in ("interactive_high", "data_high"),
        )

    def _declare_cached(self, key: str, topic: keys.Topic) -> Publisher:
        return ext.declare_advanced_publisher(
            self._session,
            key,
            congestion_control=_CONGESTION[topic.congestion],
            priority=_PRIORITY[topic.priority],
            express=True,
            cache=ext.CacheConfig(CACHE_DEPTH),
            sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT_S),
            publisher_detection=True,
        )


def _is_cached(message: Message) -> bool:
    """Tell whether late subscribers recover a message. Of actions only the final do: a partial one is soon outdated."""
    if isinstance(message, Action):
        return message.final
    return keys.address_of(message).topic.cached
