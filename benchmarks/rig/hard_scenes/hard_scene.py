"""The scene under conditions, with pantomimes."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from scene_simulator.everyday import Everyday
from scene_simulator.parameters import load_parameters
from scene_simulator.programme import Task
from scene_simulator.random_streams import random_stream
from scene_simulator.simulated_scene import Scene
from scene_simulator.timeline import Episode
from scene_simulator.trial import Trial

from .conditions import Conditions
from .exposure import ExposedState
from .pantomime import FAR_M, Pantomime, draw_pantomime

PANTOMIME_RANGE_M = 0.05
"""Range of distances above `pantomime_m` between a pantomime and the nearest object."""


class HardScene(Scene):
    """A scene under conditions, with a programme of tasks and pantomimes; the same arguments give the same scene.

    Raises:
        ValueError: the programme is empty without everyday doings, or there is no room for a pantomime.
    """

    def __init__(
        self,
        programme: Sequence[Task],
        actor_seed: int,
        seed: int,
        conditions: Conditions,
        everyday: Everyday | None = None,
    ) -> None:
        self.conditions = conditions
        super().__init__(programme, actor_seed, seed, conditions.arranged(load_parameters()), everyday)

    def states(self, tail_s: float = 3.0) -> Iterator[ExposedState]:
        """Yield the state of every frame, each with the one before it."""
        before = None
        for state in super().states(tail_s):
            yield ExposedState(**vars(state), before=before)
            before = state

    def _trial(self, number: int, task: Task) -> Trial:
        if not isinstance(task, Pantomime):
            return super()._trial(number, task)
        near_m, rng = self.conditions.pantomime_m, random_stream("trial", *self.seeds, number)
        clear_range_m = FAR_M if near_m is None else (near_m, near_m + PANTOMIME_RANGE_M)
        return draw_pantomime(self.parameters, self.actor, task, self.places_x_m, clear_range_m, rng)

    def _acting(self, trial: Trial, number: int) -> Episode:
        """Return the episode of one repetition; a pantomime has no object and moves none."""
        done = super()._acting(trial, number)
        if not isinstance(trial.task, Pantomime):
            return done
        return replace(done, trial=None, positions_m=np.broadcast_to(done.positions_m[0], done.positions_m.shape))
