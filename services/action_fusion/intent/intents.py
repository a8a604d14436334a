"""Says with each posture which objects a person is about to touch, what is done then, and when."""

from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from action_fusion.intake.stream_samples import ObjectsSample, PostureSample
from action_fusion.intent.approach import Approach, approach
from action_fusion.intent.contact_network import ContactNetwork, Foreseen, shipped_network
from action_fusion.intent.recent_paths import SIDES, RecentArms, RecentObjects, arms_of
from actum.arrays import Array
from actum.limits import MOST_STREAMS
from actum.messages import Action, Intended, Intent
from actum.node import SECOND_NS

LEAST = 0.05
"""Contacts that are less probable are not told."""
ACTIONS_LATE_NS = SECOND_NS // 10
"""How much older (ns) a partial action is than the posture that it is used with: so what is said does not depend on
which message came first."""
ACTION_LASTS_NS = SECOND_NS // 2
"""How long (ns) a partial action counts: the next comes with the next frame."""
TOUCH_M = 0.12
"""Distance (m) of a hand's joint from the middle of a thing that it touches, as in the recordings learnt from."""
SOONEST_S, LATEST_S = 0.02, 1.5
"""Range of the times to contact (s): a frame, and the horizon."""


@dataclass
class Person:
    """What is known of a person: the way of the arms, the newest partial actions, and whether a reach is under way."""

    arms: RecentArms = field(default_factory=RecentArms)
    actions: list[Action] = field(default_factory=list)
    reaches: bool = False

    def take(self, action: Action) -> None:
        """Take a partial action, or the final one that ends it."""
        if action.final:
            self.actions = [each for each in self.actions if each.segment_id != action.segment_id]
        else:
            self.actions = [each for each in self.actions if each.stamp_ns > action.stamp_ns - SECOND_NS] + [action]

    def ongoing(self, stamp_ns: int) -> Action | None:
        """Return the partial action that goes on at a stamp, as far as it is known everywhere."""
        known = [each for each in self.actions if each.stamp_ns <= stamp_ns - ACTIONS_LATE_NS]
        if not known or known[-1].stamp_ns < stamp_ns - ACTIONS_LATE_NS - ACTION_LASTS_NS:
            return None
        return known[-1]


class Intents:
    """Turns postures, objects and partial actions into intents, of `MOST_STREAMS` people at most.

    Args:
        network: foresees contacts.
    """

    def __init__(self, network: ContactNetwork | None = None) -> None:
        self._network = network or shipped_network()
        self._objects = RecentObjects()
        self._people: OrderedDict[int, Person] = OrderedDict()

    def posture(self, sample: PostureSample, agent: int, sensor: str) -> Intent | None:
        """Return the intent after a valid posture; None where no reach is under way and none has just ended."""
        assert sample.body is not None
        person = self._person(agent)
        person.arms.append(sample.stamp_ns, arms_of(sample.body))
        ongoing = person.ongoing(sample.stamp_ns)
        seen = approach(person.arms, self._objects, sample.stamp_ns)
        foreseen = self._network.foresee(seen.features)
        likely = sorted(self._intended(seen, foreseen, ongoing), key=lambda each: -each.probability)
        ended, person.reaches = person.reaches and not likely, bool(likely)
        if not likely and not ended:
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

    def objects(self, sample: ObjectsSample) -> None:
        """Take where the objects are."""
        self._objects.append(sample)

    def action(self, action: Action) -> None:
        """Take a partial action, or the final one that ends it."""
        if action.agent and action.valid:
            self._person(action.agent).take(action)

    def clear(self) -> None:
        """Forget everything, after a restart of a stream."""
        self._objects.clear()
        self._people.clear()

    def _person(self, agent: int) -> Person:
        """Return what is known of a person, the newest of all; the one that was newest longest ago makes room."""
        person = self._people.setdefault(agent, Person())
        self._people.move_to_end(agent)
        if len(self._people) > MOST_STREAMS:
            self._people.popitem(last=False)
        return person

    def _intended(self, seen: Approach, foreseen: Foreseen, ongoing: Action | None) -> Iterator[Intended]:
        """Yield the contacts of both hands that are probable: with the action that goes on, and with another one.

        Each hand has probabilities of its own, as if the other did nothing; together they are scaled to sum to 1 at
        most.
        """
        scale = 1 / max(float(foreseen.probability.sum()), 1.0)
        acts: list[tuple[str | None, float]] = [(None, 1.0)]
        if ongoing is not None and ongoing.action is not None and not ongoing.unknown:
            acts = [(ongoing.action, ongoing.confidence), (None, 1 - ongoing.confidence)]
        for hand, k in np.argwhere(scale * foreseen.probability >= LEAST).tolist():
            number, name = list(seen.names.items())[k]
            contact_s = min(max(float(foreseen.contact_s[hand, k]), SOONEST_S), LATEST_S)
            for action, share in acts:
                probability = scale * float(foreseen.probability[hand, k]) * share
                if probability >= LEAST:
                    yield Intended(
                        action=action,
                        object_id=number,
                        object_name=name,
                        hand=SIDES[hand],
                        probability=probability,
                        contact_s=contact_s,
                        contact_std_s=contact_s * float(self._network.time_sd),
                        place_m=touched_place(seen.hands_m[hand], seen.objects_m[k]).tolist(),
                    )


def touched_place(hand_m: Array, object_m: Array) -> Array:
    """Return where a hand (3,) will be as it touches an object (3,): `TOUCH_M` from its middle, on its own side."""
    apart_m = hand_m - object_m
    place: Array = object_m + apart_m * min(TOUCH_M / max(float(np.linalg.norm(apart_m)), 1e-9), 1.0)
    return place
