"""What a program that only listens and asks learns of one sensor's services in some seconds, for `actum doctor`."""

import hashlib
import socket
import threading
import time
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field

from actum import keys
from actum.hops import Hops
from actum.keys import Topic
from actum.messages import HopTime, Image, Info, Message, Skeleton, Status
from actum.node import SECOND_NS
from actum.runtime import Answer, Client, Received

STATUS_S = 2.5  # a little more than two of the reports that every service sends each second

ROUNDS = 5
"""Questions to each service: the one that was answered fastest counts."""
FROZEN_NS = SECOND_NS
"""How long (ns, by arrival) frames may be alike: noise changes every real one."""
FEWEST = 5
"""Frames that have to have come before anything is said of a stream."""


@dataclass
class Watched:
    """One stream while it is listened to.

    Attributes:
        arrivals_ns: when each message came (ns, monotonic clock).
        stamps_ns: their stamps.
        contents: what tells whether one is like the one before; None where there is nobody and nothing in it.
    """

    arrivals_ns: list[int] = field(default_factory=list)
    stamps_ns: list[int] = field(default_factory=list)
    contents: list[bytes | None] = field(default_factory=list)

    def receive(self, message: Message, arrival_ns: int) -> None:
        """Receive one message."""
        self.arrivals_ns.append(arrival_ns)
        self.stamps_ns.append(message.stamp_ns or 0)
        self.contents.append(_content(message))

    @property
    def rate_hz(self) -> float:
        """How many came in a second."""
        return _rate_hz(self.arrivals_ns)

    @property
    def stamped_hz(self) -> float:
        """How many there are in a second of the sensor's clock."""
        return _rate_hz(self.stamps_ns)

    @property
    def stands_still(self) -> bool:
        """Whether stamps do not rise although messages come."""
        return self._is_long and self.stamps_ns[-1] <= self.stamps_ns[0]

    @property
    def repeats(self) -> bool:
        """Whether every message is like the one before."""
        return self._is_long and None not in self.contents and len(set(self.contents)) == 1

    @property
    def _is_long(self) -> bool:
        return len(self.arrivals_ns) >= FEWEST and self.arrivals_ns[-1] - self.arrivals_ns[0] >= FROZEN_NS


@dataclass(frozen=True)
class Heard:
    """What was heard of a sensor.

    Attributes:
        tokens: the instances that are alive, by service.
        answers: what services answered, several times each.
        statuses: the statuses of each service, in the order they came.
        streams: skeletons, postures, objects and actions, and images where the sensor is on this host.
        members: the instances that share the sensor, by service.
        hops: how long after its cause each message came.
    """

    tokens: dict[str, list[str]]
    answers: list[Answer]
    statuses: dict[str, list[Status]]
    streams: dict[Topic, Watched]
    members: dict[str, list[str]] = field(default_factory=dict)
    hops: list[HopTime] = field(default_factory=list)

    @property
    def infos(self) -> list[Info]:
        """The description of each instance, from the question that most answered; of two with one name, both."""
        rounds: defaultdict[int, list[Info]] = defaultdict(list)
        for answer in self.answers:
            rounds[answer.asked_ns].append(answer.info)
        return max(rounds.values(), key=len, default=[])


def hear(client: Client) -> Heard:
    """Ask all services, and listen to them for `STATUS_S`."""
    answers = [answer for _ in range(ROUNDS) for answer in client.answers()]
    hosts = {answer.info.host for answer in answers if answer.info.service == "sensor_gateway"}
    topics = [keys.SKELETON, keys.POSTURE, keys.OBJECTS, keys.ACTION]
    if socket.gethostname() in hosts:
        topics.append(keys.COLOR)  # elsewhere they would cross the network for nothing but this
    hops = Hops(time.monotonic_ns)
    statuses, streams = _listened(client, topics, hops)
    members = _by_service(client.members())
    return Heard(_by_service(client.alive()), answers, statuses, streams, members, hops.times())


def _by_service(tokens: Iterable[str]) -> dict[str, list[str]]:
    """Return the instances whose liveliness tokens these are, by service."""
    found: defaultdict[str, list[str]] = defaultdict(list)
    for token in tokens:
        claim = keys.claim_of(token)
        if claim is not None:
            found[token.split("/")[3]].append(claim.instance)
    return dict(found)


def _listened(client: Client, topics: list[Topic], hops: Hops) -> tuple[dict[str, list[Status]], dict[Topic, Watched]]:
    """Return the statuses that come within `STATUS_S`, by service, and what comes on some topics; measure its hops."""
    statuses: defaultdict[str, list[Status]] = defaultdict(list)
    streams = {topic: Watched() for topic in (*topics, keys.COLOR)}
    lock, is_over = threading.Lock(), threading.Event()

    def take(received: Received) -> None:
        arrival_ns, message = time.monotonic_ns(), received.message
        with lock:
            if message is None or is_over.is_set():
                return
            if isinstance(message, Status):
                statuses[message.service].append(message)
            else:
                streams[keys.address_of(message).topic].receive(message, arrival_ns)
                hops.receive(message)

    for topic in (keys.STATUS, *topics):
        client.follow(keys.pattern(topic, client.sensor), take)
    time.sleep(STATUS_S)
    with lock:
        is_over.set()
    return dict(statuses), streams


def _rate_hz(times_ns: list[int]) -> float:
    span_ns = times_ns[-1] - times_ns[0] if len(times_ns) >= FEWEST else 0
    return (len(times_ns) - 1) * SECOND_NS / span_ns if span_ns > 0 else 0.0


def _content(message: Message) -> bytes | None:
    """Return what a camera's noise would change; None for a frame without anybody, and for any other message."""
    match message:
        case Image(valid=True, data=data):
            return hashlib.blake2b(data).digest()
        case Skeleton(agents=[_, *_]):
            return repr([agent.joints for agent in message.agents]).encode()
        case _:
            return None
