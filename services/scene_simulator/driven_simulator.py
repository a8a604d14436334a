"""A simulated person who stands at the table and does what is asked for by command."""

from collections import deque
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from typing import Any

from pydantic import BaseModel, Field

from actum.commands import Command, NoFields, Refusal, Request
from scene_simulator.everyday import FAMILIAR, Everyday, EverydayPerson
from scene_simulator.programme import ACTIONS, Task, object_ids
from scene_simulator.random_streams import random_stream
from scene_simulator.settings import Settings
from scene_simulator.simulated_scene import Scene
from scene_simulator.simulator import Simulator, session_of
from scene_simulator.timeline import Episode, resetting, still
from scene_simulator.trial import draw_bulge, draw_timing

MOST_WAITING = 20
"""Performances that may wait: enough for a script that asks ahead, and the memory stays bounded."""
IDLE_S = 0.1
"""How long the person stands before the next performance is looked for (s): it seems to begin at once."""
USUAL_PAUSE_S = 2.0
"""Pause after an action where nobody says how long (s): the hand is back, and rests."""
CHANGE_S = 1.5
"""How long (s) it takes to arrange the objects for another action."""
RETURN_SHARE = 0.85
"""Share of a pause at most in which the hands move."""


class Perform(Request):
    """What the person is to do next."""

    actions: list[str] = Field([], max_length=100)
    """The actions, one after the other, with pauses."""
    object_id: int | None = None
    """The object that they are done to; null: each to the next one."""
    pause_s: float = Field(USUAL_PAUSE_S, ge=0.5, le=60)
    """From the end of an action to the next one (s), the way back of the hand included."""
    everyday_s: float = Field(0.0, ge=0, le=600)
    """Least length of the performance (s), filled with everyday doings between and after the actions; 0: none."""


class Performances(BaseModel):
    """What is still to be done."""

    waiting: int
    """Performances that have not begun."""


class Repertoire(BaseModel):
    """What the person can be asked to do."""

    actions: list[str]
    """The actions, each of which `perform` takes."""


class DrivenScene(Scene):
    """A scene without end, in which the person rests, swaying, until a performance waits.

    An action on an object is done in the same place each time, in another tempo and on another way.
    """

    def __init__(self, settings: Settings, waiting: deque[Perform]) -> None:
        super().__init__([Task(ACTIONS[0], object_ids()[0])], settings.actor, settings.seed)
        self.programme: list[Task] = []
        self._waiting = waiting
        self._drawn = {self.trials[0].task: self.trials[0]}
        self._newest = still(self.parameters, self.trials[0].layout, self.parameters.pause.lead_in_s)
        self._layout = self.trials[0].layout
        self.trials = ()

    def _episodes(self, _tail_s: float) -> Iterator[Episode]:
        yield self._newest
        while True:
            if self._waiting:
                yield from self._performance(self._waiting.popleft())
            else:
                yield still(self.parameters, self._layout, IDLE_S)

    def _performance(self, asked: Perform) -> Iterator[Episode]:
        """Yield the actions, and everyday doings between and after them where these are asked for."""
        person, frames = None, 0
        if asked.everyday_s:
            person = EverydayPerson(Everyday(FAMILIAR, asked.everyday_s), self.parameters, self.actor, self.seeds)
        for task in programme_of(asked):
            for episode in self._act(task, asked.pause_s, person):
                frames += len(episode)
                yield episode
        pauses = count(len(self.trials))
        while person is not None and frames < asked.everyday_s * self.parameters.camera.frame_rate_hz:
            for episode in person.pause(next(pauses), self._layout):
                frames += len(episode)
                yield episode

    def _act(self, task: Task, pause_s: float, person: EverydayPerson | None) -> Iterator[Episode]:
        """Yield an action and the pause after it; before it the way to where its object stands, where that changes."""
        number = len(self.trials)
        trial = self._drawn.setdefault(task, self._trial(number, task))
        rng = random_stream("driven", *self.seeds, number)
        timing = draw_timing(self.parameters.trial, self.actor, task.action, rng)
        trial = replace(trial, timing=timing, bulge_m=draw_bulge(self.parameters.trial, self.actor, rng))
        self.trials = (*self.trials, trial)
        self.programme.append(task)
        if trial.layout is not self._layout:
            yield resetting(self.parameters, self._newest, trial.layout, CHANGE_S, RETURN_SHARE * CHANGE_S)
            self._layout = trial.layout
        if person is not None:
            yield from person.pause(number, trial.layout)
        done = self._acting(trial, number)
        yield done
        self._newest = resetting(
            self.parameters, done, trial.layout, pause_s, min(trial.pause_s, RETURN_SHARE * pause_s)
        )
        yield self._newest


class DrivenSimulator(Simulator):
    """An endless stream of one person, who stands still or performs."""

    def __init__(self, settings: Settings, start_ns: int) -> None:
        super().__init__(
            [Task(ACTIONS[0], object_ids()[0])],
            settings.actor,
            settings.seed,
            sensor=settings.sensor,
            image_hz=settings.image_hz,
            start_ns=start_ns,
            session_id=session_of(start_ns),
        )
        self._waiting: deque[Perform] = deque()
        self.scene: DrivenScene = DrivenScene(settings, self._waiting)

    @property
    def commands(self) -> tuple[Command[Any, Any], ...]:
        """The commands `perform` and `repertoire`."""
        return (
            Command("perform", Perform, Performances, self._perform),
            Command("repertoire", NoFields, Repertoire, self._list_actions),
        )

    def _list_actions(self, _: NoFields) -> Repertoire:
        """List the actions that the simulated person can do."""
        return Repertoire(actions=list(ACTIONS))

    def _perform(self, request: Perform) -> Performances:
        """Have the simulated person do actions, or everyday things, as soon as the ones before are done."""
        if not request.actions and not request.everyday_s:
            raise Refusal(
                "the simulated person was given nothing to do: name at least one action in the field 'actions', or set "
                "the field 'everyday_s' to the number of seconds of background activities"
            )
        if len(self._waiting) >= MOST_WAITING:
            raise Refusal(
                f"{MOST_WAITING} requests are already waiting for the simulated person, and no more are accepted: try "
                "again when the person has carried out some of these requests"
            )
        try:
            programme_of(request)
        except ValueError as error:
            raise Refusal(str(error)) from None
        self._waiting.append(request)
        return Performances(waiting=len(self._waiting))


def programme_of(request: Perform) -> list[Task]:
    """Return the tasks of a performance.

    Raises:
        ValueError: there is no such action or object.
    """
    ids = object_ids() if request.object_id is None else (request.object_id,)
    return [Task(action, ids[n % len(ids)]) for n, action in enumerate(request.actions)]
