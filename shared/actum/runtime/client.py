"""A session for programs beside the services: commands, tests, benchmarks."""

import secrets
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self, TypeVar

import zenoh

from actum import keys
from actum.commands import MSGPACK, Refusal, packed, unpacked
from actum.messages import Info, Message
from actum.runtime.inbox import ENDING_S, Listening, Received, received
from actum.runtime.outbox import Outbox
from actum.runtime.session import RouterUnreachableError, connected, secret_config
from actum.runtime.subscribing import Past, RecoveringSubscriber, Subscriber, subscribe
from actum.settings import ServiceSettings

T = TypeVar("T")
OPEN_S = 5.0
"""How long a program waits for the router (s) by default."""
ANSWER_S = 10.0
"""How long a command may take to be answered (s): a service may be busy with a large message."""
STARTING_S = 1.0
"""How long a service that is alive may not answer yet (s): its liveliness may be known before its commands are."""
OFFER_S = 0.2
"""How long (s) a router may take to say who would answer: some round trips."""
POLL_S = 0.05
"""Interval (s) at which a program looks for a subscriber."""
DEEP_RING = 8192
"""Depth of a program's ring: half a minute of all streams, for one that reads late."""


@dataclass(frozen=True)
class Answer:
    """A service's description, and when it was asked for and came.

    Attributes:
        info: the description; its stamp is the wall clock of its host.
        asked_ns: when it was asked for (monotonic clock, ns).
        answered_ns: when it came (monotonic clock, ns).
        came_ns: the wall clock of this host at that time (ns).
    """

    info: Info
    asked_ns: int
    answered_ns: int
    came_ns: int


class NotAnsweredError(RuntimeError):
    """Nobody answered a command in time."""


class Client:
    """Puts and listens on one sensor's keys, by a session of its own or one that is open already.

    Raises:
        RouterUnreachableError: no router answered within `wait_s`.
    """

    def __init__(self, settings: ServiceSettings, wait_s: float = OPEN_S, session: zenoh.Session | None = None) -> None:
        self.sensor = settings.sensor
        self.run = secrets.token_hex(6)
        deadline_s = time.monotonic() + wait_s
        while session is None:
            try:
                session = zenoh.open(secret_config(settings))
            except zenoh.ZError:
                if time.monotonic() > deadline_s:
                    raise RouterUnreachableError(settings.connect) from None
        self._session = session
        self._outbox = Outbox(self._session)
        self._listening: list[Listening] = []
        self._threads: list[threading.Thread] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: type[BaseException] | BaseException | TracebackType | None) -> None:
        for listening in self._listening:
            listening.close()
        for thread in self._threads:
            thread.join(timeout=ENDING_S)
        self._session.close()

    def put(self, message: Message) -> None:
        """Put a message on its key."""
        self._outbox.put(message)

    def put_raw(self, key: str, payload: bytes, encoding: str = "", attachment: bytes | None = None) -> None:
        """Put bytes as a client without this library does."""
        self._session.put(
            key,
            payload,
            encoding=encoding,
            attachment=attachment,
            congestion_control=zenoh.CongestionControl.BLOCK,
            priority=zenoh.Priority.DATA_HIGH,
            express=True,
        )

    def tap(self, key_expr: str, take: Callable[[zenoh.Sample], None]) -> None:
        """Call `take` with each sample as it arrives, from a thread of its own, until this client is left."""
        self._take_each(self.listen(key_expr).samples(), take)

    def follow(self, key_expr: str, take: Callable[[Received], None]) -> None:
        """Call `take` with each message as it arrives, from a thread of its own, until this client is left."""
        self._take_each(self.listen(key_expr), take)

    def listen(self, key_expr: str, ring: int = DEEP_RING) -> Listening:
        """Subscribe to what is put from now on on keys."""
        return self._listening_to(subscribe(self._session, key_expr, ring))

    def listen_back(self, key_expr: str, history_s: float) -> Listening:
        """Subscribe to keys, request what is lost on the way, and what was put in the last `history_s` (s) and is kept.

        The first read, also by `receive`, waits for what is kept: as a rule some milliseconds, two seconds at most.
        With a history of 0 nothing of the past is requested, nor waited for.
        A service that was started anew offers its last answers once more: the same `segment_id` says the same.
        """
        past = Past(history_s) if history_s else None
        return self._listening_to(RecoveringSubscriber(self._session, key_expr, DEEP_RING, past))

    def _take_each(self, stream: Iterable[T], take: Callable[[T], None]) -> None:
        def run() -> None:
            for item in stream:
                take(item)

        thread = threading.Thread(target=run, daemon=True)
        thread.start()
        self._threads.append(thread)

    def _listening_to(self, subscriber: Subscriber) -> Listening:
        listening = Listening(subscriber)
        self._listening.append(listening)
        return listening

    def wait_for_subscriber(self, topic: keys.Topic, timeout_s: float) -> bool:
        """Wait until somebody subscribes to this sensor's key of the topic; False if nobody does in time."""
        publisher = self._session.declare_publisher(keys.key(topic, self.sensor))
        self._outbox.declare(keys.key(topic, self.sensor))
        return _matches(publisher, timeout_s)

    def alive(self) -> list[str]:
        """List the liveliness tokens of this sensor's services."""
        return self._tokens(self.sensor, "alive")

    def sensors(self) -> list[str]:
        """List the sensors of all services whose liveliness tokens this program may see."""
        return sorted({token.split("/")[1] for token in self._tokens("*", "alive")})

    def members(self) -> list[str]:
        """List the liveliness tokens of the instances that share this sensor."""
        return self._tokens(self.sensor, "member")

    def _tokens(self, sensor: str, role: str) -> list[str]:
        replies = self._session.liveliness().get(f"{keys.BASE}/{sensor}/{role}/**", timeout=1.0)
        return sorted(str(reply.ok.key_expr) for reply in replies if reply.ok is not None)

    def infos(self) -> list[Info]:
        """Return the descriptions of all services of this sensor."""
        return [answer.info for answer in self.answers()]

    def answers(self) -> list[Answer]:
        """Return the descriptions of all services of this sensor, each with when it came."""
        every = zenoh.ConsolidationMode.NONE  # two instances of a service answer on one key
        asked_ns, answers = time.monotonic_ns(), []
        for reply in self._session.get(keys.pattern(keys.INFO, self.sensor), timeout=1.0, consolidation=every):
            answered_ns, came_ns = time.monotonic_ns(), time.time_ns()
            info = None if reply.ok is None else received(reply.ok).message
            if isinstance(info, Info):
                answers.append(Answer(info, asked_ns, answered_ns, came_ns))
        return answers

    def router_tells(self) -> bool:
        """Tell whether the router describes itself to this session, as it does unless its access control forbids it."""
        return any(reply.ok is not None for reply in self._session.get("@/*/router", timeout=1.0))

    def offers(self, service: str, timeout_s: float = OFFER_S) -> bool:
        """Tell whether the router knows of such a service that would answer, also where it lets no question through."""
        querier = self._session.declare_querier(keys.key(keys.INFO, self.sensor, service))
        try:
            return _matches(querier, timeout_s)
        finally:
            querier.undeclare()

    def ask(self, service: str, command: str = "", /, timeout_s: float = ANSWER_S, **fields: Any) -> dict[str, Any]:
        """Ask a service of this sensor for a command, or without one for the list of its commands; return its reply.

        Raises:
            Refusal: the service does not carry it out, and says why, or the fields cannot be encoded.
            NotAnsweredError: no such service answered in time.
        """
        key = "/".join(filter(None, [keys.commands_key(self.sensor, service), command]))
        patient_until_s = time.monotonic() + min(timeout_s, STARTING_S)
        while True:
            for reply in self._session.get(key, payload=packed(fields, MSGPACK), encoding=MSGPACK, timeout=timeout_s):
                if reply.ok is not None:
                    return unpacked(reply.ok.payload.to_bytes(), str(reply.ok.encoding))
                if reply.err is not None and str(reply.err.encoding).startswith(MSGPACK):
                    raise Refusal(unpacked(reply.err.payload.to_bytes(), MSGPACK)["error"])
            if time.monotonic() > patient_until_s:
                raise NotAnsweredError(
                    f"{service} of sensor {self.sensor} does not answer: run 'actum doctor' to see why"
                )
            threading.Event().wait(POLL_S)

    def connected(self) -> bool:
        """Tell whether there is a router now."""
        return connected(self._session)


def _matches(declared: zenoh.Publisher | zenoh.Querier, timeout_s: float) -> bool:
    """Wait until somebody listens to a publisher or answers a querier; False if nobody does in time."""
    deadline_s = time.monotonic() + timeout_s
    while not declared.matching_status.matching:  # type: ignore[attr-defined]
        if time.monotonic() > deadline_s:
            return False
        threading.Event().wait(POLL_S)
    return True
