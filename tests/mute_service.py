"""A service with a bug, as a process: `python tests/mute_service.py BUG`.

With `status` its counters cannot stand in a status, with `info` its details cannot in its description; with `thread`
a thread of its own ends by an exception.
"""

import sys
import threading
from typing import Any

from actum import keys
from actum.messages import Message
from actum.node import Counters, Tick
from actum.runtime import run
from actum.settings import ServiceSettings


class MuteService:
    """Takes skeletons, and does nothing."""

    name = "pose_preprocessor"
    inputs = (keys.SKELETON,)

    def __init__(self, bug: str) -> None:
        wrong: Any = {"status": {"odd": "many"}}.get(bug, {})
        self.counters = Counters(counts=wrong, details={"rate_hz": "often"} if bug == "info" else {})
        self._bug = bug

    def handle(self, message: Message | Tick) -> list[Message]:
        if self._bug == "thread":
            threading.Thread(target=[].pop, name="own").start()
        return []


if __name__ == "__main__":
    bug = sys.argv.pop()
    run(ServiceSettings, lambda _settings: MuteService(bug))
