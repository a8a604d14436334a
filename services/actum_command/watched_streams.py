"""What `actum doctor` sees of a sensor's streams while it listens: stamps, arrivals, and whether content changes."""

import hashlib
from dataclasses import dataclass, field

from actum.messages import Image, Message, Skeleton
from actum.node import SECOND_NS

FROZEN_NS = SECOND_NS
"""How long (ns, by arrival) frames may be alike: noise changes every real one."""
FEWEST = 5
"""Frames that have to have come before anything is said of a stream."""


@dataclass
class Watched:
    """One stream while it is listened to.

    Attributes:
        arrivals_ns: when each message came (ns, monotonic clock).
        stamps_ns: their stamps.
        contents: what tells whether one is like the one before; None where there is nobody and nothing in it.
    """

    arrivals_ns: list[int] = field(default_factory=list)
    stamps_ns: list[int] = field(default_factory=list)
    contents: list[bytes | None] = field(default_factory=list)

    def take(self, message: Message, arrival_ns: int) -> None:
        """Take one message."""
        self.arrivals_ns.append(arrival_ns)
        self.stamps_ns.append(message.stamp_ns or 0)
        self.contents.append(_content(message))

    @property
    def rate_hz(self) -> float:
        """How many came in a second."""
        return _rate_hz(self.arrivals_ns)

    @property
    def stamped_hz(self) -> float:
        """How many there are in a second of the sensor's clock."""
        return _rate_hz(self.stamps_ns)

    @property
    def stands_still(self) -> bool:
        """Whether stamps do not rise although messages come."""
        return self._is_long and self.stamps_ns[-1] <= self.stamps_ns[0]

    @property
    def repeats(self) -> bool:
        """Whether every message is like the one before."""
        return self._is_long and None not in self.contents and len(set(self.contents)) == 1

    @property
    def _is_long(self) -> bool:
        return len(self.arrivals_ns) >= FEWEST and self.arrivals_ns[-1] - self.arrivals_ns[0] >= FROZEN_NS


def _rate_hz(times_ns: list[int]) -> float:
    span_ns = times_ns[-1] - times_ns[0] if len(times_ns) >= FEWEST else 0
    return (len(times_ns) - 1) * SECOND_NS / span_ns if span_ns > 0 else 0.0


def _content(message: Message) -> bytes | None:
    """Return what a camera's noise would change; None for a frame without anybody, and for any other message."""
    match message:
        case Image(valid=True, data=data):
            return hashlib.blake2b(data).digest()
        case Skeleton(agents=[_, *_]):
            return repr([agent.joints for agent in message.agents]).encode()
        case _:
            return None
