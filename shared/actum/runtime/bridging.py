"""Runs a bridge: a service that also publishes and subscribes as a node of another system on the same router."""

import threading
import time
from collections.abc import Callable, Sequence

import zenoh
from zenoh import ext, handlers

from actum.bridge import Bridge, Foreign, ForeignTopic, Withdrawn
from actum.messages import Message
from actum.node import Tick
from actum.runtime.inbox import ENDING_S
from actum.runtime.outbox import Outbox, Publisher
from actum.runtime.serving import S, configured, live
from actum.runtime.step_service import StepService
from actum.runtime.subscribing import Subscriber
from actum.settings import ServiceSettings

RING = 256
"""Payloads that a subscriber to a foreign topic holds while the bridge is busy: as many as of a topic of ours."""


def run_bridge(settings_type: type[S], build: Callable[[S], Bridge], flags: Sequence[str] | None = None) -> None:
    """Run a bridge as this process's service until SIGTERM or SIGINT, set by this process's flags or given ones."""
    settings, bridge = configured(settings_type, build, flags)
    live([BridgeService(bridge, settings)], settings)


class BridgeService(StepService):
    """Gives a bridge our messages and the other system's payloads, and puts its answers on either side."""

    def __init__(self, bridge: Bridge, settings: ServiceSettings) -> None:
        super().__init__(bridge, settings)
        self._bridge = bridge
        self._session: zenoh.Session | None = None
        self._publishers: dict[str, ForeignPublisher] = {}

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        node = self._bridge.foreign_node(str(session.zid()))
        token = session.liveliness().declare_token(node.token)  # it comes first, as the readers of tokens expect
        self._publishers = {topic.name: ForeignPublisher(session, topic) for topic in node.publishes}
        self._session = session
        subscribers = [_subscribed(session, topic) for topic in node.subscribes]
        threads = [
            threading.Thread(target=self._read, args=(topic, subscriber, outbox, stop), daemon=True)
            for topic, subscriber in zip(node.subscribes, subscribers, strict=True)
        ]
        for thread in threads:
            thread.start()
        topic_tokens = [topic.token for topic in node.subscribes if topic.token]
        tokens = [token, *map(session.liveliness().declare_token, topic_tokens)]
        try:
            super()._work(session, outbox, stop, vacant_s)
        finally:
            for declared in (*tokens, *self._publishers.values(), *subscribers):
                declared.undeclare()
            for thread in threads:
                thread.join(timeout=ENDING_S)

    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        for answer in self._bridge.handle(message):
            match answer:
                case Foreign():
                    self._publishers[answer.topic].put(answer.payload)
                case ForeignTopic():
                    assert self._session is not None
                    self._publishers[answer.name] = ForeignPublisher(self._session, answer)
                case Withdrawn():
                    self._publishers.pop(answer.topic).undeclare()

    def _read(self, topic: ForeignTopic, subscriber: Subscriber, outbox: Outbox, stop: threading.Event) -> None:
        """Hand on what comes on a foreign topic until the subscriber is undeclared."""
        for sample in subscriber:
            with self._ending_at_a_bug(f"while handling a message on {topic.key}", stop), self._lock:
                foreign = Foreign(topic.name, sample.payload.to_bytes(), str(sample.key_expr))
                for message in self._bridge.receive(foreign):
                    outbox.put(message)


def _subscribed(session: zenoh.Session, topic: ForeignTopic) -> Subscriber:
    """Declare a subscriber to what others put on a topic; of a latched one, also to the newest of each publisher."""
    channel: handlers.RingChannel[zenoh.Sample] = handlers.RingChannel(RING)
    others = zenoh.Locality.REMOTE  # a bridge would take its own transforms for those of others
    if not topic.latched:
        return session.declare_subscriber(topic.key, channel, allowed_origin=others)
    newest = ext.HistoryConfig(detect_late_publishers=True, max_samples=1)
    return ext.declare_advanced_subscriber(session, topic.key, channel, allowed_origin=others, history=newest)


class ForeignPublisher:
    """Puts payloads on a foreign topic, numbered from 1, each with the attachment that the other system wants.

    The topic's liveliness token is there as long as the publisher.
    """

    def __init__(self, session: zenoh.Session, topic: ForeignTopic) -> None:
        self._topic = topic
        self._count = 0
        if topic.latched:
            self._publisher: Publisher = ext.declare_advanced_publisher(
                session,
                topic.key,
                priority=zenoh.Priority.DATA_HIGH,
                express=True,
                cache=ext.CacheConfig(max_samples=1),
                publisher_detection=True,
            )
        else:
            self._publisher = session.declare_publisher(topic.key, priority=zenoh.Priority.DATA_HIGH, express=True)
        self._token = session.liveliness().declare_token(topic.token)

    def put(self, payload: bytes) -> None:
        """Put one payload."""
        self._count += 1
        self._publisher.put(payload, attachment=self._topic.attachment(self._count, time.time_ns()))

    def undeclare(self) -> None:
        """Publish no longer, and take back the token."""
        self._token.undeclare()
        self._publisher.undeclare()
