"""A front serves each sensor that its settings name."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager

import pytest

from actum import keys
from actum.messages import Message
from actum.node import Counters, Tick
from actum.runtime import Client, run_front, serving
from actum.runtime.several import Served
from actum.settings import NodeSettings


class Speaker:
    """Says what happens to one sensor's objects, from a thread of its own."""

    name = "speaker"
    inputs = (keys.EVENT,)

    def __init__(self, settings: NodeSettings) -> None:
        self.counters, self.sensor, self.working = Counters(), settings.sensor, False

    def handle(self, _message: Message | Tick) -> list[Message]:
        return []

    def attach(self, _client: Client | None) -> None: ...

    @contextmanager
    def serving(self) -> Iterator[None]:
        self.working = True
        yield
        self.working = False


def test_the_threads_of_all_sensors_run_while_the_process_lives(monkeypatch: pytest.MonkeyPatch) -> None:
    speakers, working = list[Speaker](), list[dict[str, bool]]()

    def built(settings: NodeSettings) -> Speaker:
        speakers.append(Speaker(settings))
        return speakers[-1]

    def live(services: Sequence[Served], _: NodeSettings, beside: Callable[[], AbstractContextManager[None]]) -> None:
        assert [service.name for service in services] == ["speaker", "speaker"]
        with beside():
            working.append({speaker.sensor: speaker.working for speaker in speakers})
        working.append({speaker.sensor: speaker.working for speaker in speakers})

    monkeypatch.setattr(serving, "live", live)
    monkeypatch.setattr(sys, "argv", ["speaker", "--sensor", "left,right"])
    run_front(NodeSettings, built)
    assert working == [{"left": True, "right": True}, {"left": False, "right": False}]
