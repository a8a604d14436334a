"""Says with each posture which objects a person is about to touch, what is done then, and when."""

from collections import OrderedDict, deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple, Self

import numpy as np

from action_fusion.intake.stream_samples import ObjectsSample, PostureSample
from action_fusion.intent.action_shares import shares_of
from action_fusion.intent.approach import Approach, approach
from action_fusion.intent.contact_network import ContactNetwork, shipped_network
from action_fusion.intent.recent_beginnings import RecentBeginnings
from action_fusion.intent.recent_paths import LONGEST_GAP_NS, SIDES, RecentArms, RecentObjects, arms_of
from action_fusion.intent.usual_objects import Done, UsualObjects
from actum.arrays import Array
from actum.limits import MOST_STREAMS
from actum.messages import Action, Event, Hand, Intended, Intent
from actum.node import SECOND_NS

LEAST = 0.05
"""Contacts that are less probable are not told."""
ACTIONS_LATE_NS = SECOND_NS // 10
"""How much older (ns) a partial action is than the posture that it is used with: so what is said does not depend on
which message came first."""
MOST_ESTIMATES = 128
"""Estimates kept of a person: two seconds of two segments at 30 a second."""
ACTION_LASTS_NS = SECOND_NS // 2
"""How long (ns) a partial action counts: the next comes with the next frame."""
TOUCH_M = 0.12
"""Distance (m) of a hand's joint from the middle of a thing that it touches, as in the recordings learnt from."""
SOONEST_S, LATEST_S = 0.02, 1.5
"""Range of the times to contact (s): a frame, and the horizon."""


class Estimate(NamedTuple):
    """What an intent needs of a partial action, or of the final one; that is little, however large the message is.

    `shares` are the probabilities of the likeliest actions, the named one first; empty where no action is known.
    """

    stamp_ns: int
    segment_id: str
    final: bool
    shares: dict[str, float]
    hand: Hand | None
    completeness: float | None

    @classmethod
    def of(cls, action: Action) -> Self:
        """Take it from an action; one that may be unknown counts as none."""
        shares: dict[str, float] = {}
        if action.action is not None and not action.unknown and not action.final:
            shares = shares_of(action.action, min(max(action.confidence, 0.0), 1.0), action.activations)
        return cls(action.stamp_ns, action.segment_id, action.final, shares, action.hand, action.completeness)


@dataclass
class Person:
    """What is known of a person in one session: arms, objects moved lately, newest estimates, and latest reach."""

    session_id: str = ""
    arms: RecentArms = field(default_factory=RecentArms)
    beginnings: RecentBeginnings = field(default_factory=RecentBeginnings)
    estimates: deque[Estimate] = field(default_factory=lambda: deque(maxlen=MOST_ESTIMATES))
    reached_ns: int | None = None

    def ongoing(self, stamp_ns: int) -> Estimate | None:
        """Return the estimate of the action that goes on at a stamp, as far as it is known everywhere by then."""
        known = [each for each in self.estimates if each.stamp_ns <= stamp_ns - ACTIONS_LATE_NS]
        ended = {each.segment_id for each in known if each.final}
        going = [
            each
            for each in known
            if each.segment_id not in ended and each.stamp_ns >= stamp_ns - ACTIONS_LATE_NS - ACTION_LASTS_NS
        ]
        return max(going, key=lambda each: (each.stamp_ns, each.segment_id), default=None)


class Intents:
    """Turns postures, objects and partial actions into intents, of `MOST_STREAMS` people at most.

    Args:
        network: foresees contacts.
    """

    def __init__(self, network: ContactNetwork | None = None) -> None:
        self._network = network or shipped_network()
        self._objects = RecentObjects()
        self._usual = UsualObjects()
        self._people: OrderedDict[int, Person] = OrderedDict()

    def posture(self, sample: PostureSample, agent: int, sensor: str) -> Intent | None:
        """Return the intent after a valid posture; None where no reach is under way and none has just ended.

        A posture of another session, or one that is older than the newest, begins a person anew.
        """
        person, seen, begun = self.take(sample, agent)
        ongoing = person.ongoing(sample.stamp_ns)
        intended = () if seen is None else self._intended(seen, begun, sample.stamp_ns, ongoing)
        likely = sorted(intended, key=lambda each: -each.probability)
        before_ns, person.reached_ns = person.reached_ns, sample.stamp_ns if likely else None
        has_ended = before_ns is not None and sample.stamp_ns - before_ns <= LONGEST_GAP_NS
        if not likely and not has_ended:
            return None
        return Intent.of_checked(
            stamp_ns=sample.stamp_ns,
            sensor=sensor,
            agent=agent,
            intended=likely,
            completeness=None if ongoing is None else ongoing.completeness,
            segment_id=None if ongoing is None else ongoing.segment_id,
            session_id=sample.session_id,
        )

    def take(self, sample: PostureSample, agent: int) -> tuple[Person, Approach | None, float]:
        """Take a valid posture, as later intents need it also where this one is not wanted.

        Returns:
            The person, how the hands approach the objects, which is None where no object is known, and how many
            objects have begun to move lately.
        """
        assert sample.body is not None
        person = self._person(agent)
        if person.session_id != sample.session_id or sample.stamp_ns <= person.arms.newest_ns:
            person = self._people[agent] = Person(sample.session_id)
        person.arms.append(sample.stamp_ns, arms_of(sample.body))
        seen = approach(person.arms, self._objects, sample.stamp_ns) if self._objects else None
        return person, seen, person.beginnings.with_moved(sample.stamp_ns, [] if seen is None else seen.moved)

    def objects(self, sample: ObjectsSample) -> None:
        """Take where the objects are."""
        self._objects.append(sample)

    def action(self, action: Action) -> None:
        """Take a partial action, or the final one that ends it."""
        if action.agent and (action.valid or action.final):
            self._person(action.agent).estimates.append(Estimate.of(action))

    def event(self, event: Event) -> None:
        """Take which object an action was done to."""
        self._usual.append(event)

    def clear(self) -> None:
        """Forget everything, after a restart of a stream."""
        self._objects.clear()
        self._usual.clear()
        self._people.clear()

    def _person(self, agent: int) -> Person:
        """Return what is known of a person, the newest of all; the one that was newest longest ago makes room."""
        person = self._people.setdefault(agent, Person())
        self._people.move_to_end(agent)
        if len(self._people) > MOST_STREAMS:
            self._people.popitem(last=False)
        return person

    def _intended(self, seen: Approach, begun: float, stamp_ns: int, ongoing: Estimate | None) -> Iterator[Intended]:
        """Yield the contacts that are probable, each by the likelier hand."""
        foreseen = self._network.foresee(seen.features, begun)
        done = self._done(stamp_ns, ongoing, [*seen.names])
        probability = np.stack([touched_given(*of_hand) for of_hand in zip(done, foreseen.probability, strict=True)])
        soon = touched_soon(probability)
        touched = touched_next(soon)
        for k in np.flatnonzero(soon >= LEAST).tolist():
            number, name = [*seen.names.items()][k]
            hand = int(probability[:, k].argmax())
            action, share = (None, 0.0) if (doing := done[hand]) is None else doing.with_object(k)
            yield Intended(
                object_id=number,
                object_name=name,
                hand=SIDES[hand],
                probability=float(touched[k]),
                soon_probability=float(soon[k]),
                action=action,
                action_probability=None if action is None else float(touched[k]) * share,
                **self._when(float(foreseen.contact_s[hand, k])),
                place_m=touched_place(seen.hands_m[hand], seen.objects_m[k]).tolist(),
            )

    def _when(self, contact_s: float) -> dict[str, float]:
        """Return the time until a contact and its standard deviation (s), as an intent has them."""
        within_s = min(max(contact_s, SOONEST_S), LATEST_S)
        return {"contact_s": within_s, "contact_std_s": within_s * float(self._network.time_sd)}

    def _done(self, stamp_ns: int, ongoing: Estimate | None, objects: list[int]) -> list[Done | None]:
        """Return what each hand does to the objects; None where it does no known action."""
        if ongoing is None or not ongoing.shares:
            return [None, None]
        done = self._usual.done(stamp_ns, ongoing.shares, objects)
        return [done if ongoing.hand in (None, side) else None for side in SIDES]


def touched_soon(probability: Array) -> Array:
    """Return the probability that each of n objects is touched by either hand, (n,), of that of each hand (2, n).

    The hands are independent: 1 - (1 - p)(1 - q).
    """
    by_either: Array = 1 - np.prod(1 - probability, axis=0)
    return by_either


def touched_next(soon: Array) -> Array:
    """Return the probability that each of n objects is touched first, (n,), of that of being touched at all (n,).

    They are scaled to sum to 1 at most: of two objects that both hands are about to touch, either may be next.
    """
    touched: Array = soon / max(float(soon.sum()), 1.0)
    return touched


def touched_given(done: Done | None, probability: Array) -> Array:
    """Return the probability that a hand touches each of n objects, (n,), given what it does; the sum stays."""
    if done is None:
        return probability
    weighed = probability * done.likelier
    given: Array = weighed * (probability.sum() / max(float(weighed.sum()), 1e-300))
    return given


def touched_place(hand_m: Array, object_m: Array) -> Array:
    """Return where a hand (3,) will be as it touches an object (3,): `TOUCH_M` from its middle, on its own side."""
    apart_m = hand_m - object_m
    place: Array = object_m + apart_m * min(TOUCH_M / max(float(np.linalg.norm(apart_m)), 1e-9), 1.0)
    return place
