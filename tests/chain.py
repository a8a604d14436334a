"""The chain from postures, marks and objects to events, with every message arriving when a test says so."""

from collections.abc import Iterable, Iterator, Sequence

from action_fusion.node import ActionFusion
from action_fusion.settings import Settings
from actum import keys
from actum.messages import Action, Continuation, Intent, Message
from actum.node import Node, Numbering, Tick, replay
from continued import at_this_speed
from recognisers import tiny_model
from som_classifier.node import SomClassifier
from wire import without_seq

Arrival = tuple[int, Message]


class Clocked:
    """A node that notes at what time it puts each message."""

    def __init__(self, node: Node) -> None:
        self.counters, self.name, self.inputs = node.counters, node.name, node.inputs
        self.put: list[Arrival] = []
        self._node = node
        self._arrival_ns = 0

    def arriving(self, arrivals: Iterable[Arrival]) -> Iterator[Arrival]:
        for arrival_ns, message in arrivals:
            self._arrival_ns = arrival_ns
            yield arrival_ns, message

    def handle(self, message: Message | Tick) -> list[Message]:
        now_ns = message.monotonic_ns if isinstance(message, Tick) else self._arrival_ns
        outputs = list(self._node.handle(message))
        self.put += [(now_ns, output) for output in outputs]
        return outputs


def replayed(node: Node, arrivals: Iterable[Arrival]) -> list[Arrival]:
    """What a node puts, and when."""
    clocked = Clocked(node)
    for _ in replay(clocked, clocked.arriving(arrivals)):
        pass
    return clocked.put


def delayed(messages: Sequence[Message], delays_ns: Sequence[int]) -> list[Arrival]:
    """Let one key's messages arrive late by a cycle of delays, in their order."""
    arrivals: list[Arrival] = []
    for i, message in enumerate(messages):
        earliest_ns = arrivals[-1][0] if arrivals else 0
        arrivals.append((max(earliest_ns, message.stamp_ns + delays_ns[i % len(delays_ns)]), message))
    return arrivals


def by_key(messages: Iterable[Message]) -> dict[str, list[Message]]:
    """Number messages and sort them by the key they are put on, in their order."""
    numbering = Numbering()
    sorted_: dict[str, list[Message]] = {}
    for message in messages:
        sorted_.setdefault(keys.key_of(message), []).append(numbering.numbered(message))
    return sorted_


def merged(streams: Iterable[list[Arrival]]) -> list[Arrival]:
    """Put streams together by arrival; what arrives at the same time comes in the order of the streams."""
    return sorted((arrival for stream in streams for arrival in stream), key=lambda arrival: arrival[0])


def answers(streams: dict[str, list[Arrival]], actions_late_ns: int = 0) -> list[Message]:
    """Run the chain: every final action and every event, by segment."""
    put = replayed(SomClassifier(tiny_model()), merged(streams.values()))
    finals = [(at_ns + actions_late_ns, m) for at_ns, m in put if isinstance(m, Action) and m.final]
    events = replayed(ActionFusion(Settings()), merged([*streams.values(), finals]))
    answered = [message for _, message in [*finals, *events] if not isinstance(message, Intent)]
    return sorted(answered, key=lambda message: (message.segment_id, message.SCHEMA, without_seq([message])))


def continuations(streams: dict[str, list[Arrival]]) -> list[Message]:
    """Run the classifier: every continuation, by stamp."""
    return _by_stamp(m for _, m in _classified(streams) if isinstance(m, Continuation))


def foreseen(streams: dict[str, list[Arrival]], actions_late_ns: int = 0) -> list[Message]:
    """Run the chain: every intent and every continuation, by stamp; for these no service waits."""
    put = _classified(streams)
    actions = [(at_ns + actions_late_ns, m) for at_ns, m in put if isinstance(m, Action)]
    from_fusion = replayed(ActionFusion(Settings()), merged([*streams.values(), actions]))
    return _by_stamp(m for _, m in [*put, *from_fusion] if isinstance(m, Continuation | Intent))


def _classified(streams: dict[str, list[Arrival]]) -> list[Arrival]:
    return replayed(SomClassifier(at_this_speed()), merged(streams.values()))


def _by_stamp(messages: Iterable[Continuation | Intent]) -> list[Message]:
    return sorted(messages, key=lambda message: (message.stamp_ns, message.agent, message.SCHEMA))
