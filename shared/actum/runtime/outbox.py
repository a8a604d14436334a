"""Puts messages on their keys, numbered, with the quality of service that the table of topics gives."""

import secrets
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from typing import Any, Literal

import zenoh
from zenoh import ext

from actum import keys
from actum.codec import Frame, encode
from actum.messages import Action, Message
from actum.node import Numbering
from actum.runtime.journal import WrittenAnswer

HEARTBEAT_S = 0.5
"""How long (s) after a message its publisher repeats the number, so that a loss of the last one is noticed.

Once: who subscribes later would take all before a number that is repeated for ever for lost, and request it.
"""
ORIGIN_BYTES = 8
"""Bytes of the random name of an outbox: readers follow the numbers of each outbox by itself."""
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


Manner = Literal["plain", "cached", "recalled"]
"""Whether a publisher only puts, also keeps what it puts, or only keeps it."""


class Outbox:
    """One publisher per key and manner, declared when first needed, `MOST_PUBLISHERS` at the most."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session, self._origin = session, secrets.token_hex(ORIGIN_BYTES)
        self._keep: Callable[[Frame], None] | None = None
        self._numbering = Numbering()
        self._publishers: OrderedDict[tuple[str, Manner], Publisher] = OrderedDict()
        self._watched: dict[str, zenoh.Publisher] = {}
        self._lock = threading.Lock()

    def put(self, message: Message) -> None:
        """Number and put one message."""
        with self._lock:
            frame = encode(message, self._origin, self._numbering.number(message))
            manner = _manner(message)
            if manner == "cached" and self._keep is not None:
                self._keep(frame)
            self._publisher(frame.key, manner).put(frame.payload, encoding=frame.encoding, attachment=frame.attachment)

    def keep_by(self, keep: Callable[[Frame], None]) -> None:
        """Have `keep` called with each message that late subscribers recover, before it is put."""
        self._keep = keep

    def recall(self, answers: Iterable[tuple[WrittenAnswer, Message]]) -> None:
        """Offer what was put before this process to late subscribers, unchanged; others are not sent it once more.

        The numbers on each key go on behind it.
        """
        source = self._session.new_timestamp().get_id()
        with self._lock:
            for answer, message in answers:
                frame, given = answer.frame, datetime.fromtimestamp(answer.given_ns / 1e9, UTC)
                self._numbering.numbered(message)
                self._publisher(frame.key, "recalled").put(
                    frame.payload,
                    encoding=frame.encoding,
                    attachment=frame.attachment,
                    timestamp=zenoh.Timestamp(given, source),
                )

    def declare(self, key: str) -> None:
        """Declare a key's publisher ahead of the first put."""
        with self._lock:
            self._publisher(key, "cached" if keys.parse(key).topic.cache else "plain")

    def is_demanded(self, pattern: str) -> bool:
        """Tell whether anybody listens to some key of a pattern, such as `actum/kinect0/continuation/*`.

        That is known from the second call on: the first one asks the router.
        """
        if pattern not in self._watched:
            self._watched[pattern] = self._session.declare_publisher(pattern)
        return bool(self._watched[pattern].matching_status.matching)  # type: ignore[attr-defined]

    def _publisher(self, key: str, manner: Manner) -> Publisher:
        if (key, manner) not in self._publishers:
            self._publishers[key, manner] = self._declared(key, keys.parse(key).topic, manner)
            if len(self._publishers) > MOST_PUBLISHERS:
                self._publishers.popitem(last=False)[1].undeclare()
        self._publishers.move_to_end((key, manner))
        return self._publishers[key, manner]

    def _declared(self, key: str, topic: keys.Topic, manner: Manner) -> Publisher:
        quality: dict[str, Any] = {
            "congestion_control": _CONGESTION[topic.congestion],
            "priority": _PRIORITY[topic.priority],
            "express": topic.priority in ("interactive_high", "data_high"),
        }
        if manner == "plain":
            return self._session.declare_publisher(key, **quality)
        return ext.declare_advanced_publisher(
            self._session,
            key,
            **quality,
            allowed_destination=zenoh.Locality.SESSION_LOCAL if manner == "recalled" else zenoh.Locality.ANY,
            cache=ext.CacheConfig(topic.cache),
            sample_miss_detection=ext.MissDetectionConfig(heartbeat=None, sporadic_heartbeat=HEARTBEAT_S),
            publisher_detection=True,
        )


def _manner(message: Message) -> Manner:
    """Tell whether late subscribers recover a message. Of actions only the final do: a partial one is soon outdated."""
    recovered = message.final if isinstance(message, Action) else keys.address_of(message).topic.cache > 0
    return "cached" if recovered else "plain"
