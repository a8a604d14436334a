"""A service whose node has a bug that shows at its third tick: a program for tests of live processes."""

from actum import keys
from actum.messages import Message
from actum.node import Counters, Tick
from actum.runtime import run
from actum.settings import SharedSettings


class FailingAtTicks:
    name = "pose_preprocessor"
    inputs = (keys.SKELETON,)

    def __init__(self) -> None:
        self.counters = Counters()
        self._ticks = 0

    def handle(self, message: Message | Tick) -> list[Message]:
        self._ticks += isinstance(message, Tick)
        assert self._ticks < 3, "the third tick"
        return []


if __name__ == "__main__":
    run(SharedSettings, lambda _settings: FailingAtTicks())
