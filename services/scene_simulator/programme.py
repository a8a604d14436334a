"""What the actor is to do: a list of actions, each on one object."""

from dataclasses import dataclass

import numpy as np

from scene_simulator.chance import stream
from scene_simulator.parameters import load_parameters

ACTIONS: tuple[str, ...] = ("push", "pull", "put", "lift", "point")

NO_OBJECT = -1
"""Where an id belongs: a pantomime, done in empty space as if an object were there."""


@dataclass(frozen=True)
class Sample:
    """One repetition: an action of `ACTIONS` on the object with that id, or a pantomime of it (`NO_OBJECT`).

    Raises:
        ValueError: there is no such action or object, or pointing is to be pantomimed.
    """

    action: str
    object_id: int

    def __post_init__(self) -> None:
        if self.action not in ACTIONS:
            raise ValueError(f"no action {self.action!r}: use one of {', '.join(ACTIONS)}")
        if self.is_pantomime and self.action == "point":
            raise ValueError("pointing has no pantomime: it touches no object")
        if self.object_id not in (*object_ids(), NO_OBJECT):
            raise ValueError(f"no object {self.object_id}: use one of {object_ids()}")

    @property
    def is_pantomime(self) -> bool:
        """Whether there is no object where the action is done."""
        return self.object_id == NO_OBJECT


def object_ids() -> tuple[int, ...]:
    """List the ids of the scene's objects."""
    return tuple(item.id for item in load_parameters().objects.items)


def balanced_programme(repetitions: int, seed: int, actor_seed: int = 0) -> list[Sample]:
    """Shuffle `repetitions` of each action; the objects take turns within every action, and from person to person.

    Of people numbered in a row, any three do each action to each object as often, so that no action tells its object.
    """
    rng = stream("programme", seed)
    ids = rng.permutation(object_ids())
    samples = [
        Sample(action, int(ids[(row + repetition + actor_seed) % len(ids)]))
        for row, action in enumerate(ACTIONS)
        for repetition in range(repetitions)
    ]
    return [samples[i] for i in np.asarray(rng.permutation(len(samples)))]
