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
        token: the liveliness token that tells the other system of this publisher or subscriber; None for none.
        latched: whether a subscriber that comes late gets the newest payload.
        attachment: makes a payload's attachment from its number, from 1, and the time of the put (ns since 1970).
    """

    name: str
    key: str
    token: str | None
    latched: bool
    attachment: Callable[[int, int], bytes]


@dataclass(frozen=True)
class ForeignNode:
    """What a bridge is to the other system: its own liveliness token, what it publishes, what it subscribes to."""

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
        """Return what to declare in the Zenoh session of this id."""
        ...

    def handle(self, message: Message | Tick) -> Iterable[Foreign]:
        """Handle one message of ours or a tick, and return the payloads to put."""
        ...

    def receive(self, foreign: Foreign) -> Iterable[Message]:
        """Take one payload of the other system, and return the messages to put."""
        ...
