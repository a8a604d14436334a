"""The programme: a list of tasks, each an action on one object."""

from dataclasses import dataclass

import numpy as np

from scene_simulator.parameters import load_parameters
from scene_simulator.random_streams import random_stream

ACTIONS: tuple[str, ...] = ("push", "pull", "put", "lift", "point")

NO_OBJECT = -1
"""Object id of a pantomime, which is done in empty space as if an object were there."""


@dataclass(frozen=True)
class Task:
    """The task of one repetition: an action of `ACTIONS` on the object with that id, or a pantomime (`NO_OBJECT`).

    Raises:
        ValueError: there is no such action or object, or pointing is to be pantomimed.
    """

    action: str
    object_id: int

    def __post_init__(self) -> None:
        if self.action not in ACTIONS:
            raise ValueError(
                f"{self.action!r} is not an action of the simulated person: use one of {', '.join(ACTIONS)}"
            )
        if self.is_pantomime and self.action == "point":
            raise ValueError("the action 'point' has no pantomime (a form without an object): choose another action")
        if self.object_id not in (*object_ids(), NO_OBJECT):
            raise ValueError(f"{self.object_id} is not the id of an object: use one of {object_ids()}")

    @property
    def is_pantomime(self) -> bool:
        """Whether the action is done without an object."""
        return self.object_id == NO_OBJECT


def object_ids() -> tuple[int, ...]:
    """List the ids of the scene's objects."""
    return tuple(item.id for item in load_parameters().objects.items)


def balanced_programme(repetitions: int, seed: int, actor_seed: int = 0) -> list[Task]:
    """Return `repetitions` of each action in random order, with the objects in turn within each action.

    Any three actors with successive seeds apply each action to each object equally often, so that the object cannot be
    inferred from the action.
    """
    rng = random_stream("programme", seed)
    ids = rng.permutation(object_ids())
    tasks = [
        Task(action, int(ids[(row + repetition + actor_seed) % len(ids)]))
        for row, action in enumerate(ACTIONS)
        for repetition in range(repetitions)
    ]
    return [tasks[i] for i in np.asarray(rng.permutation(len(tasks)))]
