"""What segments are answered with, said as it comes."""

import time
from collections.abc import Callable, Iterator

from actum import keys
from actum.messages import Action, Event, Message
from actum.runtime import Client, Listening
from actum_command.context import console, say
from actum_command.describing import describe

ANSWER_S = 6.0
"""Two seconds at the most for the classifier's late frames, two for the fusion's objects, and some to be sure."""
POLL_S = 0.02


class Answers:
    """Says the answers to segments that were asked for; those to earlier ones that were not waited for come, too."""

    def __init__(self, client: Client) -> None:
        self._events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        self._actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        self._asked: dict[str, Action | None] = {}

    def say(self, segment_id: str, interrupted: Callable[[], bool]) -> None:
        """Wait until a segment's event has come, for `ANSWER_S`, or until interrupted."""
        self._asked[segment_id] = None
        deadline_s = time.monotonic() + ANSWER_S
        while not self._said(segment_id) and time.monotonic() < deadline_s:
            if interrupted():
                return
            time.sleep(POLL_S)
        if segment_id in self._asked:
            self._tell_lack(segment_id, self._asked.pop(segment_id))

    def _said(self, segment_id: str) -> bool:
        """Say the events that have come; True once the segment's own is among them."""
        for message in _messages(self._actions):
            if isinstance(message, Action) and message.final and message.segment_id in self._asked:
                self._asked[message.segment_id] = message
        for message in _messages(self._events):
            if isinstance(message, Event) and message.segment_id in self._asked:
                del self._asked[message.segment_id]
                console.print(describe(message), soft_wrap=True)
        return segment_id not in self._asked

    def _tell_lack(self, segment_id: str, action: Action | None) -> None:
        if action is None:
            say(f"{segment_id}: no answer within {ANSWER_S:g} s; see actum doctor", style="yellow")
        else:
            console.print(f"{describe(action)}; no event: does action_fusion run?", soft_wrap=True)


def _messages(listening: Listening) -> Iterator[Message]:
    while (received := listening.take()) is not None:
        if received.message is not None:
            yield received.message
