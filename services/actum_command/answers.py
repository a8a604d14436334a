"""Waits for the answers to marked segments, and describes them in words."""

import time
from collections.abc import Callable, Iterator

from rich.markup import escape

from actum import keys
from actum.messages import Action, Event, Message
from actum.runtime import Client, Listening
from actum_command.describing import describe

ANSWER_S = 6.0  # at most 2 s for the classifier's late frames and 2 s for the fusion's late objects, and a margin
POLL_S = 0.02  # less than a frame's interval


class Answers:
    """Waits for the answers to segments; late answers to earlier segments are described when they arrive."""

    def __init__(self, client: Client) -> None:
        self._events = client.listen(keys.pattern(keys.EVENT, client.sensor))
        self._actions = client.listen(keys.pattern(keys.ACTION, client.sensor))
        self._pending: dict[str, Action | None] = {}

    def until(self, segment_id: str, interrupted: Callable[[], bool]) -> Iterator[str]:
        """Yield lines of console markup until a segment's event has come, for `ANSWER_S`, or until interrupted."""
        self._pending[segment_id] = None
        deadline_s = time.monotonic() + ANSWER_S
        while True:
            yield from self._new_events()
            if segment_id not in self._pending:
                return
            if time.monotonic() >= deadline_s:
                break
            if interrupted():
                return
            time.sleep(POLL_S)
        yield _missing_answer(segment_id, self._pending.pop(segment_id))

    def _new_events(self) -> Iterator[str]:
        """Describe the events of pending segments that have arrived, and keep their final actions."""
        for message in _messages(self._actions):
            if isinstance(message, Action) and message.final and message.segment_id in self._pending:
                self._pending[message.segment_id] = message
        for message in _messages(self._events):
            if isinstance(message, Event) and message.segment_id in self._pending:
                del self._pending[message.segment_id]
                yield describe(message)


def _missing_answer(segment_id: str, action: Action | None) -> str:
    """Describe what a segment without an event lacks: any answer, or only the event after its final action."""
    if action is None:
        return f"[yellow]{escape(segment_id)}: no answer within {ANSWER_S:g} s: run 'actum doctor'[/yellow]"
    return f"{describe(action)}; no event arrived: check that action_fusion runs"


def _messages(listening: Listening) -> Iterator[Message]:
    while (received := listening.take()) is not None:
        if received.message is not None:
            yield received.message
