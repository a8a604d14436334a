"""Subscriptions with rings: a node reads each by a thread of its own, so that no stream can stall another."""

import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from types import MappingProxyType

import zenoh

from actum import keys
from actum.codec import DecodeError, decode
from actum.messages import Message
from actum.runtime.subscribing import Kept, Past, RecoveringSubscriber, Subscriber, subscribe

ANSWERED = (keys.SEGMENT, keys.ACTION, keys.EVENT)
"""Topics on which every message counts: lost ones are requested again, and those of the recent past."""
STREAMS = (keys.SKELETON, keys.POSTURE, keys.OBJECTS)
"""Topics on which every message counts as long as its segment is not answered: lost ones are requested again."""
HISTORY_DEPTH = 16
"""Most earlier messages requested on each key by a process that does not know what was answered before it."""
HISTORY_S = 4.0
"""Oldest message that it requests (s): two seconds of skew, two of waiting. Older ones have been answered."""
RESUMED_S = 90.0
"""Oldest message requested where it is known what was answered (s): a longest segment, and half as long away.
A link that was cut for longer loses what was put meanwhile."""
RESUMED_FRAMES_S = 10.0
"""Oldest frame requested then (s): as long as publishers keep them."""
ENDING_S = 1.0
"""How long a thread may take to end once its subscriber is gone (s). It is waited for: one that comes back from Zenoh
into an interpreter that is ending aborts the process."""
FREE = nullcontext()
"""A turn that nobody else takes."""
MOST_IN_A_TURN = 16
"""Most samples that a thread hands on in one turn: the postures of a frame with many people. On a busy machine, to pass
the turn on takes nearly as long as to handle a posture."""


@dataclass(frozen=True)
class Reach:
    """How far back messages are requested that were put before this process was there.

    Attributes:
        answered_s: oldest mark, action or event that is not answered yet (s); earlier ones are left out.
        requested_s: oldest of these that is requested (s), at the start and of a publisher that is back: of one that
            was cut off for longer, what it put meanwhile is lost.
        frames_s: oldest skeleton, posture or objects (s); 0 for those alone that come from now on.
        depth: most of all these on each key; None for as many as are kept.
    """

    answered_s: float = HISTORY_S
    requested_s: float = HISTORY_S
    frames_s: float = 0.0
    depth: int | None = HISTORY_DEPTH

    @classmethod
    def unknown(cls, vacant_s: float) -> "Reach":
        """Return the reach where it is not known what was answered, but how long nobody was there to do so (s)."""
        return cls(min(vacant_s, HISTORY_S), min(vacant_s, HISTORY_S))

    def past(self, topic: keys.Topic) -> Past | None:
        """Return which earlier messages of a topic are requested, None where there are to be none."""
        oldest_s = self.requested_s if topic in ANSWERED else self.frames_s
        return Past(oldest_s, min(self.depth or topic.cache, topic.cache)) if oldest_s else None


class Inbox:
    """The subscriptions of one node."""

    def __init__(self, session: zenoh.Session, topics: Sequence[keys.Topic], sensor: str, reach: Reach) -> None:
        answered = [topic for topic in topics if topic in ANSWERED and reach.answered_s < reach.requested_s]
        older = f"_time=[..now(-{reach.answered_s:.3f}s)]"
        self._left_out = {
            _digest(sample)
            for topic in answered
            for sample in Kept(session, keys.pattern(topic, sensor), older).samples()
        }
        self._subscribers: list[Subscriber] = [
            RecoveringSubscriber(session, keys.pattern(topic, sensor), topic.ring, reach.past(topic))
            if topic in (*ANSWERED, *STREAMS)
            else subscribe(session, keys.pattern(topic, sensor), topic.ring)
            for topic in topics
        ]
        self._threads: list[threading.Thread] = []
        self._sensor, self._topics = sensor, topics

    def start(
        self,
        receive: Callable[[zenoh.Sample], None],
        turn: AbstractContextManager[object] = FREE,
        pauses: Mapping[keys.Topic, Callable[[], object]] = MappingProxyType({}),
    ) -> None:
        """Call `receive` for each sample, from one thread per subscriber, which enters `turn` before.

        A thread hands on what has come meanwhile in the same turn, `MOST_IN_A_TURN` samples at the most. Once it has
        handed on all samples of a topic, it calls the topic's pause, if there is one.
        """
        for topic, subscriber in zip(self._topics, self._subscribers, strict=True):
            name = f"{self._sensor} inbox"
            given = (subscriber, receive, turn, pauses.get(topic, lambda: None))
            thread = threading.Thread(target=self._drain, args=given, name=name, daemon=True)
            thread.start()
            self._threads.append(thread)

    def close(self) -> None:
        """End the subscriptions and wait for their threads."""
        for subscriber in self._subscribers:
            subscriber.undeclare()
        for thread in self._threads:
            thread.join(timeout=ENDING_S)

    @property
    def working(self) -> bool:
        """Whether every thread still reads."""
        return all(thread.is_alive() for thread in self._threads)

    def _drain(
        self,
        subscriber: Subscriber,
        receive: Callable[[zenoh.Sample], None],
        turn: AbstractContextManager[object],
        pause: Callable[[], object],
    ) -> None:
        for first in subscriber:
            sample: zenoh.Sample | None = first
            while sample is not None:
                with turn:
                    sample = self._hand_on(sample, subscriber, receive)
            pause()

    def _hand_on(
        self, first: zenoh.Sample, subscriber: Subscriber, receive: Callable[[zenoh.Sample], None]
    ) -> zenoh.Sample | None:
        """Hand on the samples of one turn; return the one that is next, None where no other has come."""
        sample: zenoh.Sample | None = first
        for _ in range(MOST_IN_A_TURN):
            if sample is None:
                return None
            if not self._left_out or _digest(sample) not in self._left_out:
                receive(sample)
            try:
                sample = subscriber.try_recv()
            except zenoh.ZError:  # it was undeclared meanwhile
                return None
        return sample


@dataclass(frozen=True)
class Received:
    """A sample that was received: its message or the error of decoding it, and the payload's size (bytes)."""

    key: str
    message: Message | None
    error: DecodeError | None
    size: int


def received(sample: zenoh.Sample) -> Received:
    """Decode a sample."""
    key, payload = str(sample.key_expr), sample.payload.to_bytes()
    try:
        return Received(key, decode(key, payload, str(sample.encoding)), None, len(payload))
    except DecodeError as error:
        return Received(key, None, error, len(payload))


class Listening:
    """An open subscription: iterate it; `close` ends the iteration from another thread."""

    def __init__(self, subscriber: Subscriber) -> None:
        self._subscriber = subscriber

    def __iter__(self) -> Iterator[Received]:
        for sample in self._subscriber:
            yield received(sample)

    def samples(self) -> Iterable[zenoh.Sample]:
        """Return the subscription's samples, not decoded, until it is closed."""
        return self._subscriber

    def receive(self) -> Received | None:
        """Return the next sample if there is one."""
        sample = self._subscriber.try_recv()
        return None if sample is None else received(sample)

    def close(self) -> None:
        """End the subscription."""
        self._subscriber.undeclare()


def _digest(sample: zenoh.Sample) -> int:
    return hash((str(sample.key_expr), sample.payload.to_bytes()))
