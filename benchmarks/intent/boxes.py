"""Which of several objects is reached for, of which only the bearing is known: actum beside what is simpler."""

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from benchmarks.intent.cad120 import WITHIN_M, Reach, reaches

from action_fusion.intent.contact_network import shipped_network
from actum.arrays import Array, Mask
from actum_model_trainer.foreseeing import baselines
from actum_model_trainer.foreseeing.said import seen_in
from actum_model_trainer.foreseeing.takes import Take

SHARES = (0.5, 0.8)
"""Shares of the reach that have been seen."""
CHOSEN = "actum, at any depth"
"""What the others are compared with: chosen on simulated people."""


class Guess(NamedTuple):
    """How the object that is reached for is guessed.

    Attributes:
        placed: where the objects are thought to be, with as many places for each.
        scores: of each place at every instant of a take.
        joined: joins the scores of an object's places, the last axis.
    """

    placed: Callable[[Reach], Take]
    scores: baselines.Method
    joined: Callable[..., Array]

    def is_right(self, reach: Reach, share: float) -> bool:
        """Tell whether the guess is right when a share of the reach has been seen."""
        row = round(share * (len(reach.stamps_ns) - 1))
        scores = self.joined(self.scores(self.placed(reach))[row].reshape(len(reach.rays), -1), axis=1)
        return bool(np.isfinite(scores.max())) and int(scores.argmax()) == reach.target


def probabilities(take: Take) -> Array:
    """Return what actum says of each object at every instant of a take."""
    network = shipped_network()
    return np.array([network.foresee(*each).probability.sum(axis=0) for each in zip(*seen_in(take), strict=True)])


GUESSES = {
    CHOSEN: Guess(Reach.anywhere, probabilities, np.sum),
    "actum, as far as the hands": Guess(Reach.as_far_as_hands, probabilities, np.sum),
    "nearest object, at any depth": Guess(Reach.anywhere, baselines.nearest, np.max),
    "nearest object, as far as the hands": Guess(Reach.as_far_as_hands, baselines.nearest, np.max),
    "constant velocity, at any depth": Guess(Reach.anywhere, baselines.constant_velocity, np.max),
    "constant velocity, as far as the hands": Guess(Reach.as_far_as_hands, baselines.constant_velocity, np.max),
}


def table(folder: Path) -> Iterator[str]:
    """Yield how often the likeliest object is the one that is reached for, and how sure the differences are."""
    seen = list(reaches(folder))
    chance = float(np.mean([1 / len(reach.rays) for reach in seen]))
    yield (
        f"{len(seen)} reaches of four people among two or more objects. Objects are known by their boxes in the image "
        "alone. So each is either on the ray through its box, as far from the camera as the hands at the beginning; "
        f"or anywhere on that ray within {WITHIN_M:.0f} m of the shoulders, where the probabilities of all places are "
        f"summed, and the distances of a baseline count where they are least. By chance {chance:.2f} would be right. "
        f"*Only*: reaches in which *{CHOSEN}* alone is right, and in which the other alone is; *p*: exact McNemar "
        "test, as if the reaches were independent."
    )
    right = {name: np.array([[guess.is_right(r, s) for r in seen] for s in SHARES]) for name, guess in GUESSES.items()}
    heads = [f"right after {share:.0%} of the reach | only, after {share:.0%} | p" for share in SHARES]
    rows = [f"| {name} | {' | '.join(_cells(each, right[CHOSEN]))} |" for name, each in right.items()]
    yield "\n".join([f"| | {' | '.join(heads)} |", f"|---|{'---:|---:|---:|' * len(SHARES)}", *rows])


def _cells(right: Mask, chosen: Mask) -> Sequence[str]:
    """Return the cells of a row of which it is known what was right, (shares, reaches)."""
    cells = []
    for other, ours in zip(right, chosen, strict=True):
        only = int((ours & ~other).sum()), int((other & ~ours).sum())
        compared = ["", ""] if right is chosen else [f"{only[0]}, {only[1]}", f"{mcnemar_p(*only):.2f}"]
        cells += [f"{other.mean():.2f}", *compared]
    return cells


def mcnemar_p(only_ours: int, only_theirs: int) -> float:
    """Return the probability that, of two methods that are right as often, one alone is right so unequally often."""
    count = only_ours + only_theirs
    tail = sum(math.comb(count, k) for k in range(min(only_ours, only_theirs) + 1))
    return min(1.0, 2 * tail / 2**count)
