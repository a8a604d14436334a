"""What a program that only listens and asks learns of one sensor's services in some seconds, for `actum doctor`."""

import socket
import time
from collections import defaultdict
from dataclasses import dataclass

from actum import keys
from actum.keys import Topic
from actum.messages import Info, Status
from actum.runtime import Answer, Client
from actum_command.clock_offsets import ROUNDS
from actum_command.watched_streams import Watched

POLL_S = 0.02
"""Interval (s) at which messages are fetched: short beside that of frames."""
IMAGES_HELD = 64
"""Images that may wait to be looked at: several seconds of them would fill the memory."""


@dataclass(frozen=True)
class Heard:
    """What was heard of a sensor.

    Attributes:
        tokens: the instances that are alive, by service.
        answers: what services answered, several times each.
        statuses: the statuses of each service, in the order they came.
        streams: skeletons, postures and objects, and images where the sensor is on this host.
    """

    tokens: dict[str, list[str]]
    answers: list[Answer]
    statuses: dict[str, list[Status]]
    streams: dict[Topic, Watched]

    @property
    def infos(self) -> list[Info]:
        """The description of each instance, from the question that most answered; of two with one name, both."""
        rounds: defaultdict[int, list[Info]] = defaultdict(list)
        for answer in self.answers:
            rounds[answer.asked_ns].append(answer.info)
        return max(rounds.values(), key=len, default=[])


def hear(client: Client, seconds: float) -> Heard:
    """Ask all services, and listen to them for some seconds."""
    answers = [answer for _ in range(ROUNDS) for answer in client.answers()]
    hosts = {answer.info.host for answer in answers if answer.info.service == "sensor_gateway"}
    topics = [keys.SKELETON, keys.POSTURE, keys.OBJECTS]
    if socket.gethostname() in hosts:
        topics.append(keys.COLOR)  # elsewhere they would cross the network for nothing but this
    statuses, streams = _listened(client, topics, seconds)
    tokens: defaultdict[str, list[str]] = defaultdict(list)
    for key in client.alive():
        service, instance = key.split("/")[-2:]
        tokens[service].append(instance)
    return Heard(dict(tokens), answers, statuses, streams)


def _listened(
    client: Client, topics: list[Topic], seconds: float
) -> tuple[dict[str, list[Status]], dict[Topic, Watched]]:
    """Return the statuses that come within so many seconds, by service, and what comes on some topics."""
    rings = {topic: {"ring": IMAGES_HELD} if topic is keys.COLOR else {} for topic in (keys.STATUS, *topics)}
    listening = [client.listen(keys.pattern(topic, client.sensor), **ring) for topic, ring in rings.items()]
    statuses: defaultdict[str, list[Status]] = defaultdict(list)
    streams = {topic: Watched() for topic in (*topics, keys.COLOR)}
    deadline_s = time.monotonic() + seconds
    while time.monotonic() < deadline_s:
        for each in listening:
            while (received := each.take()) is not None:
                if isinstance(received.message, Status):
                    statuses[received.message.service].append(received.message)
                elif received.message is not None:
                    streams[keys.address_of(received.message).topic].take(received.message, time.monotonic_ns())
        time.sleep(POLL_S)
    return dict(statuses), streams
