"""The interface of a bridge: a pure step between our messages and the payloads of another system on the same router."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

from actum import keys
from actum.messages import Message
from actum.node import Servable, Tick


@dataclass(frozen=True)
class Foreign:
    """A payload of the other system, by the name that the bridge gives its topic.

    Of one that was received, `key` is its Zenoh key, by which topics are told apart that share a name.
    """

    topic: str
    payload: bytes
    key: str = ""


@dataclass(frozen=True)
class ForeignTopic:
    """A topic of the other system as it stands on the router.

    Attributes:
        name: what the bridge calls it.
        key: its Zenoh key; of what is subscribed to, it may match those of several topics.
        token: the liveliness token that tells the other system of this publisher or subscriber; empty for none.
        latched: whether a subscriber that comes late gets the newest payload.
        attachment: makes a payload's attachment from its number, from 1, and the time of the put (ns since 1970).
    """

    name: str
    key: str
    token: str
    latched: bool
    attachment: Callable[[int, int], bytes]


@dataclass(frozen=True)
class Withdrawn:
    """The name of a topic that is published no longer."""

    topic: str


Output = Foreign | ForeignTopic | Withdrawn
"""What a bridge answers: a payload to put, a topic to publish from now on, or one to publish no longer."""


@dataclass(frozen=True)
class ForeignNode:
    """What a bridge is to the other system: its own liveliness token, what it publishes, what it subscribes to.

    `publishes` are the topics of the whole session; others come and go by the answers of `Bridge.handle`.
    """

    token: str
    publishes: tuple[ForeignTopic, ...]
    subscribes: tuple[ForeignTopic, ...]


class Bridge(Servable, Protocol):
    """The logic of a bridge: like a node, it uses no socket, no clock and no sleep."""

    @property
    def inputs(self) -> tuple[keys.Topic, ...]:
        """The topics of the messages that `handle` takes."""
        ...

    def foreign_node(self, session_id: str) -> ForeignNode:
        """Return what to declare in the Zenoh session of this id; topics announced before it were those of another."""
        ...

    def handle(self, message: Message | Tick) -> Iterable[Output]:
        """Handle one message of ours or a tick; return payloads to put, and topics to announce or withdraw, in order.

        A topic is announced before its first payload, and not again before it is withdrawn.
        """
        ...

    def receive(self, foreign: Foreign) -> Iterable[Message]:
        """Take one payload of the other system, and return the messages to put."""
        ...
