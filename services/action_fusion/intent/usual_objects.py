"""What each action is usually done to: people drink from the cup, not from the box."""

from bisect import bisect_right, insort
from collections import Counter
from collections.abc import Mapping, Sequence
from operator import itemgetter
from typing import NamedTuple

import numpy as np

from actum.arrays import Array
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
PRIOR = 1.0
"""Pairs of an action and an object that are assumed to have been seen, and expected, before the first event. Chosen on
simulated people 91 to 98: with fewer, chance counts for a habit where objects are drawn at random."""


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
        """Return how much more often each action was done to each object than by chance, (actions, n).

        (O + k) / (E + k) with the count O of a pair, k = `PRIOR`, and the count E that the counts of its action and of
        its object lead to expect if they were independent. Without events it is 1.

        Args:
            stamp_ns: the events that end `KNOWN_AFTER_NS` earlier count.
            actions: the labels.
            objects: the numbers of the objects that are there; others do not count.
        """
        known = self._events[: bisect_right(self._events, stamp_ns - KNOWN_AFTER_NS, key=itemgetter(0))]
        columns = {number: k for k, number in enumerate(objects)}
        rows = {action: k for k, action in enumerate(actions)}
        counts = np.zeros((len(actions) + 1, len(objects)))
        for (action, number), count in Counter(map(itemgetter(1), known[-MOST_EVENTS:])).items():
            if number in columns:
                counts[rows.get(action, -1), columns[number]] += count
        expected = counts.sum(axis=1, keepdims=True) * counts.sum(axis=0) / max(float(counts.sum()), 1.0)
        ratios: Array = (counts[:-1] + PRIOR) / (expected[:-1] + PRIOR)
        return ratios

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
