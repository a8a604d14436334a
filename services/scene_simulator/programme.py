"""The programme: a list of tasks, each an action on one object."""

from dataclasses import dataclass

import numpy as np

from scene_simulator.parameters import load_parameters
from scene_simulator.random_streams import random_stream

ACTIONS: tuple[str, ...] = ("push", "pull", "put", "lift", "point")


@dataclass(frozen=True)
class Task:
    """The task of one repetition: an action of `ACTIONS` on the object with that id.

    Raises:
        ValueError: there is no such action or object.
    """

    action: str
    object_id: int

    def __post_init__(self) -> None:
        if self.action not in ACTIONS:
            raise ValueError(
                f"{self.action!r} is not an action of the simulated person: use one of {', '.join(ACTIONS)}"
            )
        if self.object_id not in object_ids():
            raise ValueError(f"{self.object_id} is not the id of an object: use one of {object_ids()}")


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
