"""Who is there: the ids of bodies and persons, which are never used again, and the topics that each has."""

import hashlib
import string
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import count

from actum.messages import MOST_AGENTS
from actum.node import SECOND_NS
from ros2_bridge.hri import types as hri
from ros2_bridge.message_types import PERSON_ACTION, STRING
from ros2_bridge.topics import RosTopic

GONE_NS = 3 * SECOND_NS // 2
"""How long a person may be unseen (ns) and still be there: as long as the gateway looks for who was lost."""
PREFIX = 3
"""Letters of an id that depend on the Zenoh session, so that two bridges give different ids."""
LEAST_LETTERS = 2
"""Letters of an id that count, at least: with the prefix five, as REP 155 proposes."""


@dataclass(frozen=True)
class Human:
    """One person while they are seen: ROS4HRI's body, and the anonymous person whose it is."""

    agent: int
    body: str
    person: str

    def body_topic(self, leaf: str) -> str:
        """Return the name of a topic of the body."""
        return f"/humans/bodies/{self.body}/{leaf}"

    def person_topic(self, leaf: str) -> str:
        """Return the name of a topic of the person."""
        return f"/humans/persons/{self.person}/{leaf}"

    def topics(self, of_image: bool, gestures: bool) -> Iterator[RosTopic]:
        """Yield all topics of body and person; of the body's those in the image, and gestures, only if there are any.

        libhri subscribes to `body_id` and `anonymous` as transient local, so only latched ones reach it.
        """
        yield RosTopic(self.body_topic("joint_states"), hri.JOINT_STATE, "bodies")
        yield RosTopic(self.body_topic("urdf"), STRING, "bodies", depth=1, latched=True)
        yield RosTopic(self.body_topic("posture"), hri.BODY_POSTURE, "bodies")
        if of_image:
            yield from self.topics_of_image()
        if gestures:
            yield RosTopic(self.body_topic("gesture"), hri.GESTURE, "bodies")
        yield RosTopic(self.person_topic("body_id"), STRING, "persons", depth=1, latched=True)
        yield RosTopic(self.person_topic("anonymous"), hri.BOOL, "persons", depth=1, latched=True)
        yield RosTopic(self.person_topic("location_confidence"), hri.FLOAT, "persons")
        yield RosTopic(self.person_topic("action"), PERSON_ACTION, "persons")

    def topics_of_image(self) -> Iterator[RosTopic]:
        """Yield the body's topics that a camera is needed for."""
        yield RosTopic(self.body_topic("roi"), hri.REGION, "bodies")
        yield RosTopic(self.body_topic("skeleton2d"), hri.SKELETON_2D, "bodies")
        yield RosTopic(self.body_topic("cropped"), hri.IMAGE, "cropped")


class Present:
    """The people who are there, by the agents' numbers of one run of the source.

    Attributes:
        run: the session id of that run.
    """

    def __init__(self) -> None:
        self._prefix = ""
        self._numbers = count()
        self.run = ""
        self._humans: dict[int, Human] = {}
        self._seen_ns: dict[int, int] = {}

    def begin(self, session_id: str) -> None:
        """Forget everybody, whose topics ended with the Zenoh session before this one."""
        digest = hashlib.blake2b(session_id.encode(), digest_size=8).digest()
        self._prefix = _letters(int.from_bytes(digest, "big"), PREFIX)[-PREFIX:]
        self._humans, self._seen_ns = {}, {}

    @property
    def humans(self) -> list[Human]:
        """Everybody who is there."""
        return list(self._humans.values())

    def of(self, agent: int, run: str) -> Human | None:
        """Return who has a number in a run of the source, "" where that is not known; None where nobody has it now."""
        return self._humans.get(agent) if run in (self.run, "") else None

    def see(self, agents: Iterable[int], now_ns: int) -> list[Human]:
        """Take note of who is seen, and return who is new: at most so many that `MOST_AGENTS` are there."""
        new = []
        for agent in agents:
            if agent not in self._humans and len(self._humans) < MOST_AGENTS:
                self._humans[agent] = Human(agent, self._new_id(), self._new_id())
                new.append(self._humans[agent])
            if agent in self._humans:
                self._seen_ns[agent] = now_ns
        return new

    def leave(self, run: str, now_ns: int) -> list[Human]:
        """Remove and return who is gone: unseen for too long, or of another run of the source than `run`."""
        over = run != self.run
        self.run = run
        gone = [agent for agent, seen_ns in self._seen_ns.items() if over or now_ns - seen_ns > GONE_NS]
        for agent in gone:
            del self._seen_ns[agent]
        return [self._humans.pop(agent) for agent in gone]

    def _new_id(self) -> str:
        return self._prefix + _letters(next(self._numbers), LEAST_LETTERS)


def _letters(number: int, least: int) -> str:
    """Write a number in letters a to z, with a's before it up to so many."""
    written = ""
    while number or len(written) < least:
        number, digit = divmod(number, len(string.ascii_lowercase))
        written = string.ascii_lowercase[digit] + written
    return written
