"""Open subscriptions of programs beside the services, and what comes from them."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import zenoh

from actum.codec import DecodeError, decode
from actum.messages import Message
from actum.runtime.inbox import Subscriber


@dataclass(frozen=True)
class Received:
    """A sample that was received: its message or the error of decoding it, and the payload's size (bytes)."""

    key: str
    message: Message | None
    error: DecodeError | None
    size: int


def received(sample: zenoh.Sample) -> Received:
    """Decode a sample."""
    key, payload = str(sample.key_expr), sample.payload.to_bytes()
    try:
        return Received(key, decode(key, payload, str(sample.encoding)), None, len(payload))
    except DecodeError as error:
        return Received(key, None, error, len(payload))


class Listening:
    """An open subscription: iterate it; `close` ends the iteration from another thread."""

    def __init__(self, subscriber: Subscriber) -> None:
        self._subscriber = subscriber

    def __iter__(self) -> Iterator[Received]:
        for sample in self._subscriber:
            yield received(sample)

    def each(self, take: Callable[[Received], None]) -> None:
        """Call `take` with each message until closed."""
        for came in self:
            take(came)

    def drain(self, take: Callable[[zenoh.Sample], None]) -> None:
        """Call `take` with each sample until closed."""
        for sample in self._subscriber:
            take(sample)

    def take(self) -> Received | None:
        """Return the next sample if there is one."""
        sample = self._subscriber.try_recv()
        return None if sample is None else received(sample)

    def close(self) -> None:
        """End the subscription."""
        self._subscriber.undeclare()
