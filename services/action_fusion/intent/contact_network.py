"""A small network that turns an approach into the probability of a contact, and the time until then."""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import NamedTuple, Self

import numpy as np

from actum.arrays import Array, Mask

SHIPPED = "contact_network.npz"
"""The network that comes with actum; `python -m benchmarks.intent.learning` makes it."""
WIDEST = 4.0
"""Features further than so many standard deviations from their mean count as no further."""


class Foreseen(NamedTuple):
    """Contacts foreseen: `probability` (2, n) of each hand and object within the horizon, `contact_s` (2, n)."""

    probability: Array
    contact_s: Array


@dataclass(frozen=True)
class ContactNetwork:
    """Several networks of two hidden layers whose probabilities are averaged; one for all objects and both hands.

    The score of an object is that of its own approach, softmax over the objects and a score of 0 for none of them.
    The more objects the person has begun to move lately, the higher are all scores; the more objects there are, the
    lower, for a person does not act more often among many.

    Attributes:
        mean, sd: (features,), of the training data.
        into: (networks, features, hidden), with `into_bias` (networks, hidden).
        between: (networks, hidden, hidden), with `between_bias` (networks, hidden).
        out: (networks, hidden), with `out_bias` (networks,).
        lively: (networks,), added to every score, times the logarithm of 1 + how many have begun to move lately.
        among: (networks,), added to every score, times the logarithm of how many objects there are.
        time: (features + 1,), weights of the logarithm of the time to contact (s), the last one constant.
        time_sd: standard deviation of that logarithm.
    """

    mean: Array
    sd: Array
    into: Array
    into_bias: Array
    between: Array
    between_bias: Array
    out: Array
    out_bias: Array
    lively: Array
    among: Array
    time: Array
    time_sd: Array

    @classmethod
    def of(cls, arrays: dict[str, Array]) -> Self:
        """Build a network of its arrays."""
        return cls(**{name: np.asarray(arrays[name], np.float64) for name in cls.__dataclass_fields__})

    def foresee(self, features: Array, begun: float) -> Foreseen:
        """Return the probability of each contact of the hands with n objects.

        Args:
            features: (2, n, features); NaN counts as no contact.
            begun: how many objects have begun to move lately.
        """
        unit = np.clip((features - self.mean) / self.sd, -WIDEST, WIDEST)
        known: Mask = np.isfinite(unit.sum(axis=2))
        unit = np.where(known[..., None], unit, 0.0)
        rows = unit.reshape(-1, unit.shape[2])
        hidden = np.tanh(rows @ self.into + self.into_bias[:, None])
        hidden = np.tanh(hidden @ self.between + self.between_bias[:, None])
        of_all = self.out_bias + self.lively * np.log1p(begun) + self.among * np.log(max(features.shape[1], 1))
        scores = np.einsum("krh,kh->kr", hidden, self.out) + of_all[:, None]
        scores = np.where(known, scores.reshape(len(self.out), *known.shape), -np.inf)
        most = np.maximum(scores.max(axis=2, keepdims=True, initial=0.0), 0.0)
        likely = np.exp(scores - most)
        each = likely / (likely.sum(axis=2, keepdims=True) + np.exp(-most))
        return Foreseen(each.mean(axis=0), np.exp(unit @ self.time[:-1] + self.time[-1]))


@cache
def shipped_network() -> ContactNetwork:
    """Load the network that comes with actum."""
    with files("action_fusion.intent").joinpath(SHIPPED).open("rb") as file, np.load(file) as arrays:
        return ContactNetwork.of(dict(arrays))
