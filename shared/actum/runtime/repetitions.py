"""Recognises answers that come once more, as after a restart of the service that gave them."""

from collections import OrderedDict

from actum.messages import Action, Event, Message

REMEMBERED = 1024
"""Answers remembered: more than publishers keep for late subscribers on all keys together."""


class Repetitions:
    """The answers received last. One that is the same byte for byte says nothing new."""

    def __init__(self) -> None:
        self._received: OrderedDict[int, None] = OrderedDict()

    def has(self, message: Message, payload: bytes) -> bool:
        """Tell whether an answer has been received before, and remember it; partial actions and others are not."""
        if not isinstance(message, Event) and not (isinstance(message, Action) and message.final):
            return False
        if message.seq is None:
            return False
        digest = hash(payload)
        repeated = digest in self._received
        self._received[digest] = None
        self._received.move_to_end(digest)
        if len(self._received) > REMEMBERED:
            self._received.popitem(last=False)
        return repeated
