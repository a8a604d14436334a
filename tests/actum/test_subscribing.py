"""A subscriber requests what gets lost on the way, and what gets lost while it does so."""

import threading
from collections.abc import Container, Iterable, Iterator

import pytest
import zenoh
from zenoh import ext

from actum.runtime.subscribing import RecoveringSubscriber
from live import wait_until

KEY = "actum/kinect0/posture/1"
RING = 8


class LossyPublisher:
    """A publisher that keeps what it puts. Only some of it arrives; its answers last until `answered`."""

    def __init__(self, session: zenoh.Session) -> None:
        self._kept = ext.declare_advanced_publisher(
            session,
            KEY,
            allowed_destination=zenoh.Locality.REMOTE,
            cache=ext.CacheConfig(4 * RING),
            sample_miss_detection=ext.MissDetectionConfig(),
        )
        self._arriving = session.declare_publisher(KEY)
        self._under_way = list[zenoh.Query]()
        self._waits, self.asked = True, list[str]()
        its = self._kept.id
        self._queryable = session.declare_queryable(f"{KEY}/@adv/pub/{its.zid}/{its.eid}/late", self._answer)

    def put(self, numbers: Iterable[int], arriving: Container[int]) -> None:
        for number in numbers:
            self._kept.put(str(number))
            if number in arriving:
                self._arriving.put(str(number), source_info=zenoh.SourceInfo(self._kept.id, number))

    def answered(self) -> None:
        wait_until(lambda: bool(self._under_way), "what is lost is requested")
        self._waits = False
        self._under_way.clear()

    def _answer(self, query: zenoh.Query) -> None:
        self.asked.append(query.parameters["_sn"])
        if self._waits:
            self._under_way.append(query)


@pytest.fixture
def session() -> Iterator[zenoh.Session]:
    config = zenoh.Config()
    config.insert_json5("mode", '"peer"')
    config.insert_json5("listen/endpoints", "[]")
    config.insert_json5("scouting/multicast/enabled", "false")
    with zenoh.open(config) as opened:
        yield opened


def received_until(subscriber: RecoveringSubscriber, last: int) -> list[int]:
    """What is received up to a message; all that is received in ten seconds if it does not come."""
    found = list[int]()
    impatience = threading.Timer(10, subscriber.undeclare)
    impatience.start()
    for sample in subscriber:
        found.append(int(sample.payload.to_string()))
        if found[-1] == last:
            break
    impatience.cancel()
    return found


def test_what_gets_lost_while_lost_messages_are_requested_is_requested_as_well(session: zenoh.Session) -> None:
    publisher, subscriber = LossyPublisher(session), RecoveringSubscriber(session, KEY, RING, None)
    publisher.put(range(3), arriving={0, 2})
    assert received_until(subscriber, last=2) == [0, 1, 2]
    publisher.put(range(3, 6), arriving={5})
    publisher.answered()
    assert received_until(subscriber, last=5) == [3, 4, 5]
    assert publisher.asked == ["1..", "3..4"]
    subscriber.undeclare()


def test_what_the_ring_has_no_room_for_is_not_requested(session: zenoh.Session) -> None:
    """The reader is too slow already."""
    publisher, subscriber = LossyPublisher(session), RecoveringSubscriber(session, KEY, RING, None)
    publisher.put([0], arriving={0})
    assert received_until(subscriber, last=0) == [0]
    numbers = range(1, 1 + 2 * RING)
    publisher.put(numbers, arriving=numbers)
    assert received_until(subscriber, last=2 * RING) == [*numbers[RING:]]
    assert publisher.asked == []
    subscriber.undeclare()
