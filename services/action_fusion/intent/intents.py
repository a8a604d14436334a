"""Says with each posture which object a hand is on its way to.

The rule is plain: the nearest object within `NEAR_M` of a hand that comes closer.
"""

from collections import OrderedDict
from dataclasses import dataclass, replace

import numpy as np

from action_fusion.intake.stream_samples import Body, ObjectsSample, PostureSample
from action_fusion.settings import Settings
from actum.limits import MOST_STREAMS
from actum.messages import Action, Hand, Intended, Intent
from actum.node import SECOND_NS

NEAR_M = 0.3
"""Largest distance of a hand from an object that it may be on its way to (m)."""
SLOWEST_MPS = 0.05
"""A hand that comes closer more slowly (m/s) rests: less is jitter."""
LONGEST_S = 1.5
"""A contact that is further ahead (s) is not foreseen."""
SIDES: tuple[Hand, Hand] = ("right", "left")
"""The hands in the order of `Body.hands_m`."""


@dataclass(frozen=True)
class Person:
    """What is known of a person: the newest posture, the partial action, and whether the last intent was not empty."""

    sample: PostureSample | None = None
    action: Action | None = None
    reaches: bool = False


class Intents:
    """Turns postures, objects and actions into intents; keeps the newest of each, of `MOST_STREAMS` people at most."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        self._objects: ObjectsSample | None = None
        self._people: OrderedDict[int, Person] = OrderedDict()

    def posture(self, sample: PostureSample, agent: int, sensor: str) -> Intent | None:
        """Return the intent after a valid posture; None where no reach is under way and none has just ended."""
        person = self._person(agent)
        ongoing = person.action
        intended = self._intended(person, sample)
        self._people[agent] = replace(person, sample=sample, reaches=bool(intended))
        if not intended and not person.reaches:
            return None
        return Intent(
            stamp_ns=sample.stamp_ns,
            sensor=sensor,
            agent=agent,
            intended=intended,
            completeness=ongoing.completeness if ongoing else None,
            segment_id=ongoing.segment_id if ongoing else None,
            session_id=sample.session_id,
        )

    def objects(self, sample: ObjectsSample) -> None:
        """Take where the objects are."""
        self._objects = sample

    def action(self, action: Action) -> None:
        """Take a partial action, or the final one that ends it."""
        if action.agent:
            goes_on = action.valid and not action.final
            self._people[action.agent] = replace(self._person(action.agent), action=action if goes_on else None)

    def clear(self) -> None:
        """Forget everything, after a restart of a stream."""
        self._objects = None
        self._people.clear()

    def _person(self, agent: int) -> Person:
        """Return what is known of a person, the newest of all; the one that was newest longest ago makes room."""
        person = self._people.setdefault(agent, Person())
        self._people.move_to_end(agent)
        if len(self._people) > MOST_STREAMS:
            self._people.popitem(last=False)
        return person

    def _intended(self, person: Person, sample: PostureSample) -> list[Intended]:
        before = person.sample
        if before is None or before.body is None or sample.body is None or self._objects is None:
            return []
        elapsed_s = (sample.stamp_ns - before.stamp_ns) / SECOND_NS
        found = [self._approached(person, hand, before.body, sample.body, elapsed_s) for hand in range(len(SIDES))]
        likely = sorted((each for each in found if each), key=lambda each: -each.probability)
        return [each.model_copy(update={"probability": each.probability / len(likely)}) for each in likely]

    def _approached(self, person: Person, hand: int, before: Body, now: Body, elapsed_s: float) -> Intended | None:
        """Return the contact of one hand with the nearest object, if the hand comes closer to it."""
        assert self._objects is not None
        if not self._objects.positions_m or not np.isfinite([before.hands_m[hand], now.hands_m[hand]]).all():
            return None
        gaps_m = {i: float(np.linalg.norm(now.hands_m[hand] - at)) for i, at in self._objects.positions_m.items()}
        nearest = min(gaps_m, key=lambda i: gaps_m[i])
        place_m, gap_m = self._objects.positions_m[nearest], gaps_m[nearest]
        speed_mps = (float(np.linalg.norm(before.hands_m[hand] - place_m)) - gap_m) / elapsed_s
        if gap_m > NEAR_M or speed_mps < SLOWEST_MPS or gap_m / speed_mps > LONGEST_S:
            return None
        return Intended(
            action=person.action.action if person.action else None,
            object_id=nearest,
            object_name=self._objects.names[nearest],
            hand=SIDES[hand],
            probability=1 - gap_m / NEAR_M,
            contact_s=gap_m / speed_mps,
            contact_std_s=gap_m / speed_mps / 2,
            place_m=np.asarray(place_m).tolist(),
        )
