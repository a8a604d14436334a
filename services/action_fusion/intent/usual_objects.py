"""What each action is usually done to: people drink from the cup, not from the box."""

import math
from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from actum.arrays import Array
from actum.limits import MOST_STREAMS
from actum.messages import Event
from actum.node import SECOND_NS

Pair = tuple[str, int]
"""An action, and the number of the object that it was done to."""
KNOWN_AFTER_NS = SECOND_NS
"""How long (ns) after its end an action counts. By then its event is there, also if the action was found without marks
and objects are up to 0.1 s late: so what is said does not depend on which message came first."""
MOST_EVENTS = 200
"""So many of the newest events count: habits change, and others come to the table."""
LATE_EVENTS = 64
"""So many more are kept, for the newest ones that do not count yet."""
STRENGTHS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0)
"""How many events the assumption is worth that the object does not depend on the action: from little to nearly all."""


class Done(NamedTuple):
    """What a person who may do several actions does to each of n objects.

    Attributes:
        likelier: (n,), how much likelier each object is than if nothing were known of the action.
        actions: the likeliest action with each object.
        shares: (n,), its probability if that object is touched.
    """

    likelier: Array
    actions: list[str]
    shares: Array

    def with_object(self, k: int) -> tuple[str, float]:
        """Return the likeliest action with an object, and its probability if that object is touched."""
        return self.actions[k], float(self.shares[k])


class UsualObjects:
    """The objects of the newest events, of all people whom a sensor sees."""

    def __init__(self) -> None:
        self._events: list[tuple[int, Pair]] = []

    def append(self, event: Event) -> None:
        """Add an event, in any order; one whose action or object is doubtful says nothing."""
        if event.valid and event.action is not None and event.object and not event.unknown and not event.candidates:
            insort(self._events, (event.end_ns, (event.action, event.object.id)))
            del self._events[: -MOST_EVENTS - LATE_EVENTS]

    def clear(self) -> None:
        """Forget everything."""
        self._events.clear()

    def ratios(self, stamp_ns: int, actions: Sequence[str], objects: Sequence[int]) -> Array:
        """Return how much more often each action is done to each object than by chance, (actions, n).

        Args:
            stamp_ns: the events that end `KNOWN_AFTER_NS` earlier count.
            actions: the labels; of one without an event all is 1.
            objects: the numbers of the objects that are there; others do not count.
        """
        known = self._events[: bisect_right(self._events, stamp_ns - KNOWN_AFTER_NS, key=itemgetter(0))]
        counted = Counter(map(itemgetter(1), known[-MOST_EVENTS:]))
        of_action = associations(frozenset(counted.items()), tuple(objects))
        nothing = np.ones(len(objects))
        return np.array([of_action.get(action, nothing) for action in actions])

    def done(self, stamp_ns: int, shares: Mapping[str, float], objects: Sequence[int]) -> Done:
        """Return what is done to each object by a person who may do several actions.

        Args:
            stamp_ns: as in `ratios`.
            shares: the probability of each action, the likeliest first; the rest is that of others, done to anything.
            objects: the numbers of the objects that are there.
        """
        ratios, actions = self.ratios(stamp_ns, [*shares], objects), [*shares]
        probability = np.array([*shares.values()])
        likelier = 1 + probability @ (ratios - 1)
        joint = probability[:, None] * ratios
        chosen = joint.argmax(axis=0)
        best = joint[chosen, np.arange(len(objects))]
        return Done(likelier, [actions[k] for k in chosen.tolist()], best / likelier)


@lru_cache(maxsize=MOST_STREAMS)
def associations(counted: frozenset[tuple[Pair, int]], objects: tuple[int, ...]) -> dict[str, Array]:
    """Return of each action how much more often it is done to each of n objects than by chance, (n,).

    Gamma-Poisson shrinkage (DuMouchel, Bayesian data mining in large frequency tables, 1999): (O + k) / (E + k), of the
    count O of a pair and the count E that is expected if the object does not depend on the action. The strength k is
    unknown. So the ratios of all `STRENGTHS`, and that of independence, which is 1, are averaged, weighted by how
    probable each makes the counts.

    Args:
        counted: how often each pair occurred.
        objects: the numbers of the objects that are there.
    """
    there = {pair: count for pair, count in sorted(counted) if pair[1] in objects}
    actions = sorted({action for action, _ in there})
    counts = np.array([[there.get((action, number), 0) for number in objects] for action in actions])
    if not actions:
        return {}
    expected = counts.sum(axis=1, keepdims=True) * counts.sum(axis=0) / counts.sum()
    logs = np.array([*(_log_likelihood(counts, expected, k) for k in STRENGTHS), -expected.sum()])
    weights = np.exp(logs - logs.max())
    lifts = np.array([(counts + k) / (expected + k) - 1 for k in STRENGTHS])
    ratios = 1 + np.tensordot(weights[:-1] / weights.sum(), lifts, axes=1)
    return dict(zip(actions, ratios, strict=True))


def _log_likelihood(counts: Array, expected: Array, k: float) -> float:
    """Return the logarithm of the probability of all counts, the rates being `expected` times a gamma of mean 1.

    The gamma has shape k. What does not depend on k is left out.
    """
    shape: float = sum(
        math.lgamma(count + k) - math.lgamma(k) - count * math.log(k) for count in counts[counts > 0].tolist()
    )
    return shape - float(((counts + k) * np.log1p(expected / k)).sum())
