"""The interface of a service, a pure step over messages and ticks; and its replay without a transport."""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from actum import keys
from actum.codec import encodable
from actum.messages import HopTime, Message
from actum.states import State

SECOND_NS = 1_000_000_000
"""Nanoseconds in a second."""
TICK_NS = SECOND_NS // 10
"""Interval between two ticks (ns): no service needs a finer one."""
SETTLE_NS = 70 * SECOND_NS
"""How long ticks go on after a replay (ns): longer than any service waits (a segment of 60 s and 2 s of skew)."""
MOST_KEYS = 4096
"""Keys whose numbers are remembered: agents come and go with new ones, and the key silent for longest begins anew."""
LONGEST_COMPLAINT = 500
"""Characters reported of an error or a state: it may quote a megabyte of input, and nobody could read the status."""


@dataclass(frozen=True)
class Tick:
    """The passing of time, 10 Hz. It only bounds waiting and is never compared with a stamp."""

    monotonic_ns: int


@dataclass
class Counters:
    """A node's counters: rejected inputs by kind, the text of the newest error, and the node's state in a word or two.

    `counts` is of what else happened and is no fault. `details` names the `model`, the `calibration` or the `source` in
    use, and the source's `rate_hz`, for the message `info`. `hops` is how long messages took, as the page's service has
    measured it.
    """

    rejects: Counter[str] = field(default_factory=Counter)
    last_error: str | None = None
    state: str = State.RUNNING
    counts: Counter[str] = field(default_factory=Counter)
    details: dict[str, str] = field(default_factory=dict)
    hops: list[HopTime] = field(default_factory=list)

    @property
    def told_state(self) -> str:
        """The state as a status and a log tell it: it may quote whatever names somebody has set."""
        return encodable(self.state[:LONGEST_COMPLAINT])

    def reject(self, kind: str, detail: str = "") -> None:
        """Count one rejected input under its kind; kind and detail, of any text, become the newest error."""
        self.rejects[encodable(kind)] += 1
        complaint = f"{kind}: {detail}" if detail else kind
        self.last_error = encodable(complaint[:LONGEST_COMPLAINT])


class Servable(Protocol):
    """What the runtime runs as a service."""

    counters: Counters

    @property
    def name(self) -> str:
        """The service's name, as in its keys."""
        ...


class Node(Servable, Protocol):
    """A service's logic: it keeps state, but uses no socket, no clock and no sleep."""

    @property
    def inputs(self) -> tuple[keys.Topic, ...]:
        """The topics of the messages that `handle` takes."""
        ...

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Handle one message or tick, and return the messages to put."""
        ...


@runtime_checkable
class Remembering(Protocol):
    """A node that answers segments, each once, also across its restarts.

    Attributes:
        answers: the topic of its answers.
    """

    answers: keys.Topic

    @property
    def is_busy(self) -> bool:
        """Whether a segment is under way whose answer another process would have to begin anew."""
        ...

    def remember(self, answers: Sequence[Message]) -> None:
        """Take the answers that were given before this process was started: to their segments it gives no others.

        Called before all else, and only where these are known. Messages of that time may then come once more.
        """
        ...


@runtime_checkable
class OnDemand(Protocol):
    """A node that puts one of its topics only while somebody listens: few do, and it is put with every posture.

    Attributes:
        on_demand: the topic.
        is_demanded: whether somebody listens. True at first, so that a replay yields everything; the runtime changes it
            before each tick. Nothing that the node puts on other topics depends on it.
    """

    on_demand: keys.Topic
    is_demanded: bool


@runtime_checkable
class Patient(Protocol):
    """A node that mostly has time: the runtime then reads some of its topics only now and then.

    Several messages that are read together take less time than each that wakes a thread up, and they leave the
    processor to the services that handle the newest frame.

    Attributes:
        may_wait: these topics.
    """

    may_wait: Sequence[keys.Topic]

    @property
    def has_time(self) -> bool:
        """Whether nothing depends on the messages that come now."""
        ...


class Source(Servable, Protocol):
    """A sensor that yields frames in the order of their stamps. The runtime decides when to put each."""

    @property
    def paced(self) -> bool:
        """True where the runtime must pace the frames by their stamps; false where reading them takes the time."""
        ...

    def frames(self) -> Iterator[list[Message]]:
        """Yield the messages of one captured instant, all with the same stamp."""
        ...


class Numbering:
    """Assigns sequence numbers (`seq`), counted from 0 on each key."""

    def __init__(self) -> None:
        self._next: dict[str, int] = {}

    def numbered(self, message: Message) -> Message:
        """Return the message with `seq` set. A message that has a number keeps it, and the next one continues there."""
        seq = self.number(message)
        return message if message.seq is not None else message.model_copy(update={"seq": seq})

    def number(self, message: Message) -> int:
        """Return the number that a message has or gets."""
        key = keys.key_of(message)
        expected = self._next.pop(key, 0)
        seq = expected if message.seq is None else message.seq
        self._next[key] = seq + 1
        if len(self._next) > MOST_KEYS:
            del self._next[next(iter(self._next))]
        return seq


def replay(node: Node, messages: Iterable[tuple[int, Message]], settle_ns: int = SETTLE_NS) -> Iterator[Message]:
    """Feed a node messages at their arrival times (ns), with ticks between, and yield the messages that it puts.

    Ticks go on for `settle_ns` after the last message, so that segments still waiting are answered, too. Between two
    messages they go on for `SETTLE_NS` at the most, for nothing waits longer: a wrong stamp costs 700 ticks. They start
    with the first arrival time, and do not go back where a message arrives before the one before it.
    """
    numbering = Numbering()
    inputs = tuple(topic.message for topic in node.inputs)
    newest_ns: int | None = None
    now = next_tick = 0
    for arrival_ns, message in messages:
        if newest_ns is None:
            newest_ns = now = next_tick = arrival_ns
        now += min(max(arrival_ns - newest_ns, 0), SETTLE_NS)
        newest_ns = max(newest_ns, arrival_ns)
        while next_tick <= now:
            yield from map(numbering.numbered, node.handle(Tick(next_tick)))
            next_tick += TICK_NS
        if isinstance(message, inputs):
            yield from map(numbering.numbered, node.handle(message))
    for tick in range(next_tick, now + settle_ns, TICK_NS):
        yield from map(numbering.numbered, node.handle(Tick(tick)))
