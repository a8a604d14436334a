"""A simulated person who stands at the table and does what is asked for by command."""

from collections import deque
from collections.abc import Iterator
from itertools import islice
from typing import Any

from pydantic import BaseModel, Field

from actum.commands import Command, Refusal, Request
from actum.messages import Message
from actum.node import SECOND_NS, Counters
from scene_simulator.everyday import FAMILIAR, Everyday
from scene_simulator.parameters import load_parameters
from scene_simulator.programme import ACTIONS, Task, object_ids
from scene_simulator.settings import Settings
from scene_simulator.simulator import GATEWAY, Simulator

MOST_WAITING = 20
"""Performances that may wait: enough for a script that asks ahead, and the memory stays bounded."""
FRAME_RATE_HZ = load_parameters().camera.frame_rate_hz
"""Of every scene."""
IDLE_S = 0.5
"""How long the person stands before the next performance is looked for (s): it seems to begin at once."""


class Perform(Request):
    """What the person is to do next."""

    actions: list[str] = Field([], max_length=100)
    """The actions, one after the other, with pauses."""
    object_id: int | None = None
    """The object that they are done to; null: each to the next one."""
    everyday_s: float = Field(0.0, ge=0, le=600)
    """Least length of the performance (s), filled with everyday doings between and after the actions; 0: none."""


class Performances(BaseModel):
    """What is still to be done."""

    waiting: int
    """Performances that have not begun."""


class DrivenSimulator:
    """An endless stream of one person, who stands still or performs."""

    name = GATEWAY
    paced = True

    def __init__(self, settings: Settings, start_ns: int) -> None:
        self.counters = Counters()
        self._settings, self._start_ns = settings, start_ns
        self._waiting: deque[Perform] = deque()

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """The command `perform`."""
        return (Command("perform", Perform, Performances, self._perform),)

    def frames(self) -> Iterator[list[Message]]:
        """Yield frames for ever."""
        start_ns, performed = self._start_ns, 0
        while True:
            asked = self._waiting.popleft() if self._waiting else None
            performed += asked is not None
            for messages in self._standing(start_ns) if asked is None else self._performing(asked, start_ns, performed):
                yield messages
                newest_ns = messages[0].stamp_ns
            start_ns = newest_ns + SECOND_NS // FRAME_RATE_HZ

    def _perform(self, request: Perform) -> Performances:
        """Have the simulated person do actions, or everyday things, as soon as the ones before are done."""
        if not request.actions and not request.everyday_s:
            raise Refusal("nothing to do: give actions, or seconds of everyday doings")
        if len(self._waiting) >= MOST_WAITING:
            raise Refusal(f"{MOST_WAITING} performances wait already: ask again when some are done")
        try:
            _programme(request)
        except ValueError as error:
            raise Refusal(str(error)) from None
        self._waiting.append(request)
        return Performances(waiting=len(self._waiting))

    def _standing(self, start_ns: int) -> Iterator[list[Message]]:
        """Yield the moments before a performance, in which the person rests."""
        scene = self._simulator([Task(ACTIONS[0], object_ids()[0])], None, start_ns, 0)
        return islice(scene.frames(), round(IDLE_S * FRAME_RATE_HZ))

    def _performing(self, asked: Perform, start_ns: int, number: int) -> Iterator[list[Message]]:
        everyday = Everyday(FAMILIAR, asked.everyday_s) if asked.everyday_s else None
        return self._simulator(_programme(asked), everyday, start_ns, number).frames()

    def _simulator(self, programme: list[Task], everyday: Everyday | None, start_ns: int, number: int) -> Simulator:
        settings = self._settings
        return Simulator(
            programme,
            settings.actor,
            settings.seed + number,
            sensor=settings.sensor,
            image_hz=settings.image_hz,
            start_ns=start_ns,
            session_id=f"simulator-{self._start_ns}",
            everyday=everyday,
        )


def _programme(request: Perform) -> list[Task]:
    ids = object_ids() if request.object_id is None else (request.object_id,)
    return [Task(action, ids[n % len(ids)]) for n, action in enumerate(request.actions)]
