"""Subscribers: to what is put from now on, or also to what publishers have put before and keep."""

import threading
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

import zenoh
from zenoh import ext, handlers

ANSWER_S = 1.0
"""How long publishers may take to send what they keep (s)."""
MOST_SOURCES = 1024
"""Publishers whose newest number is remembered: the one that is silent for longest makes room.
As many reports of Zenoh's subscriber are kept, that it has left messages of a publisher out."""
Source = tuple[str, int]
"""A publisher: its session's id and its number in this session."""


class Past(NamedTuple):
    """Which earlier messages are requested: those of the last `age_s` seconds, of each publisher the newest `most`."""

    age_s: float
    most: int | None = None

    @property
    def selected(self) -> str:
        """What is requested, as Zenoh writes it; each message's time is by the clock of who put it."""
        return f"_time=[now(-{self.age_s:.3f}s)..]" + (f";_max={self.most}" if self.most else "")


class Kept:
    """The messages that publishers keep: requested at once, awaited when they are read.

    Args:
        session: the connection.
        key_expr: of the messages.
        selected: which of them, by time or number, as Zenoh writes it.
        source: the publisher that is asked; None for each one.
    """

    def __init__(self, session: zenoh.Session, key_expr: str, selected: str, source: Source | None = None) -> None:
        self._replies: list[zenoh.Reply] = []
        self._is_complete = threading.Event()
        asked = "**" if source is None else "*/{}/{}/**".format(*source)
        # a channel that is full would block this call where the publisher is of the same session
        session.get(
            f"{key_expr}/@adv/{asked}?{selected}",
            handlers.Callback(self._replies.append, self._is_complete.set),
            target=zenoh.QueryTarget.ALL,
            consolidation=zenoh.ConsolidationMode.NONE,
            accept_replies=zenoh.ReplyKeyExpr.ANY,
            timeout=ANSWER_S,
        )

    def samples(self) -> list[zenoh.Sample]:
        """Return them in the order in which they were put, without those of publishers that do not answer in time."""
        self._is_complete.wait(2 * ANSWER_S)
        return sorted((reply.ok for reply in self._replies if reply.ok is not None), key=_put_at)

    def give_up(self) -> None:
        """Have nobody wait any longer."""
        self._is_complete.set()


class RecoveringSubscriber:
    """Returns the past in the order in which it was put, then what is put from now on; requests what gets lost.

    Zenoh's subscriber can request the past, but sometimes loses all of it: it requests each publisher's past twice, and
    passes on at once what is put between the two replies. Then it takes all earlier samples for repetitions, and drops
    them, with those put since its first request. It also returns the past of one publisher after that of another.
    Therefore the past is requested here, and then what Zenoh's subscriber has dropped. Zenoh's subscriber only adds the
    past of publishers that connect later.

    It requests what gets lost, but not what gets lost while it awaits an answer: it then gives up on that. So this is
    requested here, too. What its ring has no room for is not: the reader is too slow for it.
    """

    def __init__(self, session: zenoh.Session, key_expr: str, ring: int, past: Past | None) -> None:
        late = past and ext.HistoryConfig(detect_late_publishers=True, max_samples=past.most, max_age=past.age_s)
        channel: handlers.RingChannel[zenoh.Sample] = handlers.RingChannel(ring)
        recovery = ext.RecoveryConfig(heartbeat=True, periodic_queries=None)
        self._session = session
        self._subscriber = ext.declare_advanced_subscriber(session, key_expr, channel, history=late, recovery=recovery)
        self._live = self._subscriber.handler  # which ends quietly where the subscriber is undeclared
        misses: handlers.RingChannel[ext.Miss] = handlers.RingChannel(MOST_SOURCES)
        self._misses = self._subscriber.sample_miss_listener(misses)
        self._kept = past and Kept(session, key_expr, past.selected)
        self._taken: deque[zenoh.Sample] = deque()
        self._newest: dict[Source, int] = {}
        self._gaps: deque[Source] = deque(maxlen=MOST_SOURCES)
        self._is_undeclared = False

    def __iter__(self) -> Iterator[zenoh.Sample]:
        """Yield samples until the subscriber is undeclared."""
        yield from iter(self._next_taken, None)
        for sample in self._live:
            self._take(sample)
            yield from iter(self._next_taken, None)

    def try_recv(self) -> zenoh.Sample | None:
        """Return the next sample if there is one.

        Raises:
            zenoh.ZError: the subscriber was undeclared.
        """
        while (taken := self._next_taken()) is None:
            if (sample := self._live.try_recv()) is None:
                return None
            self._take(sample)
        return taken

    def undeclare(self) -> None:
        """End the subscription, also for a thread that awaits the past or is in the middle of it."""
        self._is_undeclared = True
        if (kept := self._kept) is not None:
            kept.give_up()
        self._subscriber.undeclare()

    def _next_taken(self) -> zenoh.Sample | None:
        """Return the next of the samples that are to be returned; None where there is none, or once undeclared.

        The first call awaits the past.
        """
        if self._kept is not None:
            self._taken.extend(self._kept.samples())
            for source, number in filter(None, map(_numbered, self._taken)):
                self._newest[source] = max(number, self._newest.get(source, 0))
            self._gaps.extend(self._newest)
            self._kept = None
        return self._taken.popleft() if self._taken and not self._is_undeclared else None

    def _take(self, sample: zenoh.Sample) -> None:
        """Take a sample of Zenoh's subscriber unless it is of the past, behind those that it left out before it."""
        if (numbered := _numbered(sample)) is None:
            self._taken.append(sample)
            return
        source, number = numbered
        newest = self._newest.pop(source, number - 1)
        if number > newest:  # a publisher's numbers rise
            if number > newest + 1 and self._has_gap(source):
                left_out = f"_sn={newest + 1}..{number - 1}"
                self._kept = kept = Kept(self._session, str(sample.key_expr), left_out, source)
                self._taken.extend(kept.samples())
                self._kept = None
            self._taken.append(sample)
        self._newest[source] = max(number, newest)
        if len(self._newest) > MOST_SOURCES:
            del self._newest[next(iter(self._newest))]

    def _has_gap(self, source: Source) -> bool:
        """Tell whether it was Zenoh's subscriber that left out messages of a publisher, and not its ring."""
        while (miss := self._misses.try_recv()) is not None:
            self._gaps.append(_source(miss.source))
        if source not in self._gaps:
            return False
        self._gaps.remove(source)
        return True


Subscriber = (
    zenoh.Subscriber[zenoh.Handler[zenoh.Sample]]
    | ext.AdvancedSubscriber[zenoh.Handler[zenoh.Sample]]
    | RecoveringSubscriber
)


def subscribe(session: zenoh.Session, key_expr: str, ring: int) -> Subscriber:
    """Declare a subscriber to what is put from now on."""
    return session.declare_subscriber(key_expr, handlers.RingChannel(ring))


def _numbered(sample: zenoh.Sample) -> tuple[Source, int] | None:
    """Return the publisher of a sample, and the sample's number there; None where it has none."""
    info = sample.source_info
    return None if info is None else (_source(info.source_id), info.source_sn)


def _source(of: zenoh.EntityGlobalId) -> Source:
    return str(of.zid), of.eid


def _put_at(sample: zenoh.Sample) -> float:
    return 0.0 if sample.timestamp is None else sample.timestamp.get_time().timestamp()
