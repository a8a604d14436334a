"""Everyday doings between the actions of a scene, and in place of them."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from actum.arrays import Array
from scene_simulator.actor import Actor
from scene_simulator.doings import KINDS, stand_at_ease
from scene_simulator.key_poses import moving
from scene_simulator.motion import Manner, Motion
from scene_simulator.parameters import Parameters
from scene_simulator.random_streams import random_stream
from scene_simulator.timeline import Episode, still
from scene_simulator.trial import Layout

ALL: tuple[str, ...] = tuple(KINDS)
"""Every kind of doing."""
KEPT_ASIDE: tuple[str, ...] = ("rub_nose", "drink", "stretch", "adjust_clothing", "wipe_hands")
"""Kinds that only tests show. All but drinking have a relative in training; drinking is as near to lifting as any."""
FAMILIAR: tuple[str, ...] = tuple(kind for kind in ALL if kind not in KEPT_ASIDE)
"""Kinds for training recordings, so that tests ask for more than what was learnt by heart."""
Choice = Literal["none", "familiar", "all", "only"]
"""Which doings a scene has: none, those for training, all, or all and no actions."""
Pauses = Literal["long", "short"]
"""How much goes on between two actions: up to three doings and rests of seconds, or at most one and short rests."""
LIKING = 2.0
"""Shape of the gamma distribution of a person's liking for a kind: some kinds are several times as frequent."""


@dataclass(frozen=True)
class Everyday:
    """What a person does besides the actions.

    Attributes:
        kinds: which doings, of `ALL`.
        least_s: the scene goes on with doings after the last action until it is this long.
        pauses: how much goes on between two actions.

    Raises:
        ValueError: there is no such kind, or none at all.
    """

    kinds: tuple[str, ...] = ALL
    least_s: float = 0.0
    pauses: Pauses = "long"

    def __post_init__(self) -> None:
        unknown = [kind for kind in self.kinds if kind not in ALL]
        if unknown or not self.kinds:
            raise ValueError(
                f"{', '.join(unknown) or 'an empty list'} is not an everyday activity: use one or more of "
                f"{', '.join(ALL)}"
            )


def chosen(choice: Choice, minutes: float, pauses: Pauses = "long") -> Everyday | None:
    """Return the doings of a scene that lasts at least some minutes, or None."""
    if choice == "none":
        return None
    return Everyday(FAMILIAR if choice == "familiar" else ALL, 60 * minutes, pauses)


class EverydayPerson:
    """A person with everyday doings; how often each kind comes, and in which manner, is the person's own."""

    def __init__(self, everyday: Everyday, parameters: Parameters, actor: Actor, seeds: tuple[int, int]) -> None:
        self._parameters, self._actor, self._seeds = parameters, actor, seeds
        self._pauses = parameters.everyday.long if everyday.pauses == "long" else parameters.everyday.short
        self._manner = Manner.of(actor, seeds[0])
        liking = dict(zip(ALL, random_stream("liking", seeds[0]).gamma(LIKING, size=len(ALL)), strict=True))
        self._kinds = everyday.kinds
        weights = np.array([liking[kind] for kind in self._kinds])
        self._probabilities: Array = weights / weights.sum()

    def pause(self, number: int, layout: Layout) -> Sequence[Episode]:
        """Return what comes before the action of a number: often doings and rests, sometimes nothing."""
        rng = random_stream("everyday", *self._seeds, number)
        if rng.random() < self._pauses.at_once_probability:
            return []
        rest = still(self._parameters, layout, rng.uniform(*self._pauses.rest_range_s))
        return [rest, self._doings(layout, rng)]

    def _doings(self, layout: Layout, rng: np.random.Generator) -> Episode:
        """Return one doing or several, from the rest at the table to it."""
        motion = Motion(self._parameters, self._actor, self._manner, layout, rng)
        low, high = self._pauses.rest_range_s
        for _ in range(rng.integers(1, self._pauses.most_doings + 1)):
            motion.doing = str(rng.choice(self._kinds, p=self._probabilities))
            KINDS[motion.doing](motion)
            stand_at_ease(motion)
            motion.doing = None
            motion.hold(low, high)
        motion.to_rest()
        motion.hold(low, high)
        rate_hz = self._parameters.camera.frame_rate_hz
        return moving(motion.poses, still(self._parameters, layout, 1 / rate_hz), rate_hz)
