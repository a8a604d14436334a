"""What goes on right now, one line a person, for the lower edge of a terminal."""

import threading
import time
from collections.abc import Callable

from rich.console import Group
from rich.text import Text

from actum.messages import Action, Message
from actum_command.describing import describe_ongoing

STALE_S = 0.7  # an action of which nothing more is heard is over: partial ones come with every frame


class OngoingLines:
    """The newest partial action of each person, until its final one has come or nothing more is heard of it.

    It is fed by one thread and drawn by another.
    """

    def __init__(self, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._clock_s = clock_s
        self._newest: dict[tuple[str, int], tuple[float, Action]] = {}
        self._lock = threading.Lock()

    def take(self, message: Message | None) -> None:
        """Note a partial action, or the end of one."""
        if not isinstance(message, Action):
            return
        person = message.sensor, message.agent
        with self._lock:
            if not message.final:
                self._newest[person] = self._clock_s(), message
            elif person in self._newest and self._newest[person][1].segment_id == message.segment_id:
                del self._newest[person]

    def __rich__(self) -> Group:
        """Return a line for each person who is doing something."""
        oldest_s = self._clock_s() - STALE_S
        with self._lock:
            self._newest = {person: (at_s, a) for person, (at_s, a) in self._newest.items() if at_s > oldest_s}
            actions = [action for _, (_, action) in sorted(self._newest.items())]
        return Group(*(Text.from_markup(describe_ongoing(action)) for action in actions))
