"""What marked segments are answered with, in words, as the answers come."""

import time
from collections.abc import Callable, Iterator

from rich.markup import escape

from actum import keys
from actum.messages import Action, Event, Message
from actum.runtime import Client, Listening
from actum_command.describing import describe

ANSWER_S = 6.0  # 2 s at the most for the classifier's late frames, 2 s for the fusion's objects, and some to be sure
POLL_S = 0.02  # less than a frame's interval


class Answers:
    """Waits for the answers to segments; those to earlier segments that were not waited for come, too."""

    def __init__(self, client: Client) -> None:
        self._events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        self._actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        self._asked: dict[str, Action | None] = {}

    def until(self, segment_id: str, interrupted: Callable[[], bool]) -> Iterator[str]:
        """Yield lines of console markup until a segment's event has come, for `ANSWER_S`, or until interrupted."""
        self._asked[segment_id] = None
        deadline_s = time.monotonic() + ANSWER_S
        while True:
            yield from self._events_come()
            if segment_id not in self._asked:
                return
            if time.monotonic() >= deadline_s:
                break
            if interrupted():
                return
            time.sleep(POLL_S)
        yield _lack(segment_id, self._asked.pop(segment_id))

    def _events_come(self) -> Iterator[str]:
        """Describe the events of segments asked for that have come, and remember their final actions."""
        for message in _messages(self._actions):
            if isinstance(message, Action) and message.final and message.segment_id in self._asked:
                self._asked[message.segment_id] = message
        for message in _messages(self._events):
            if isinstance(message, Event) and message.segment_id in self._asked:
                del self._asked[message.segment_id]
                yield describe(message)


def _lack(segment_id: str, action: Action | None) -> str:
    if action is None:
        return f"[yellow]{escape(segment_id)}: no answer within {ANSWER_S:g} s; see actum doctor[/yellow]"
    return f"{describe(action)}; no event: does action_fusion run?"


def _messages(listening: Listening) -> Iterator[Message]:
    while (received := listening.take()) is not None:
        if received.message is not None:
            yield received.message
