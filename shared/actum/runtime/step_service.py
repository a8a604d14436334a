"""Runs a pure step: gives it the messages of its topics, and ticks."""

import threading
import time
from abc import abstractmethod
from collections import OrderedDict
from collections.abc import Callable, Mapping

import zenoh

from actum import keys
from actum.bridge import Bridge
from actum.codec import DecodeError, decode, origin_of
from actum.messages import Action, Event, Message
from actum.node import TICK_NS, Node, OnDemand, Patient, Remembering, Tick
from actum.runtime.inbox import Inbox, Reach
from actum.runtime.outbox import Outbox
from actum.runtime.resuming import Resumption
from actum.runtime.service import Service
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings

LONGEST_TICK_NS = 2 * TICK_NS
"""Most that time goes on from one tick to the next (ns): a process that was stopped first reads what has come
meanwhile, before it gives up waiting for it."""
PAUSE_S = 0.08
"""How long messages wait of a node that has time (s): two or three frames, and no multiple of a frame's time, so that
they are not read whenever another frame has just come."""
REMEMBERED = 1024
"""Answers remembered: more than publishers keep for late subscribers on all keys together."""
_TURNS = Turns()
"""The turns of all services of this process that read no images: one handles messages, the others wait. Only one thread
runs Python at a time anyway, and threads that take turns within a message cost more than threads that take turns after
some of them. Images are mostly read outside of Python, several at a time."""


class StepService(Service):
    """Gives a pure step the messages of its topics, and ticks; what becomes of its answers a subclass says."""

    def __init__(self, step: Node | Bridge, settings: ServiceSettings) -> None:
        super().__init__(step, settings, _TURNS if keys.COLOR not in step.inputs else None)
        self._inputs = step.inputs
        self._inbox: Inbox | None = None
        self._repetitions = Repetitions()

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        self._serve_inputs(session, outbox, stop, Reach.unknown(vacant_s))

    def _serve_inputs(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, reach: Reach) -> None:
        """Handle messages and ticks until stopped, and before them the messages that the inbox is to reach back to."""
        self._meter.await_history()
        self._inbox = Inbox(session, self._inputs, self._settings.sensor, reach)
        self._inbox.start(lambda sample: self._receive(sample, outbox, stop), self._lock, self._pauses())
        tick_ns, before_ns = 0, time.monotonic_ns()
        try:
            while not stop.wait(TICK_NS / 1e9):
                now_ns = time.monotonic_ns()
                tick_ns += min(now_ns - before_ns, LONGEST_TICK_NS)
                before_ns = now_ns
                with self._lock:
                    self._step(Tick(tick_ns), outbox)
        finally:
            self._inbox.close()

    @property
    def is_healthy(self) -> bool:
        """Whether its subscriptions are read."""
        return self._inbox is not None and self._inbox.working

    def _receive(self, sample: zenoh.Sample, outbox: Outbox, stop: threading.Event) -> None:
        """Handle one sample; bad input is counted, a repetition left out, a bug ends the process. The lock is held."""
        began_ns = time.perf_counter_ns()
        key, payload = str(sample.key_expr), sample.payload.to_bytes()
        try:
            message = decode(key, payload, str(sample.encoding))
            if self._repetitions.has(message, payload):
                return
            self._step(message, outbox)
            self._meter.took((time.perf_counter_ns() - began_ns) / 1e6)
            self._meter.received(key, message, _origin(sample))  # no answer waits for it
        except DecodeError as error:
            self._counters.reject(error.kind, str(error))
        except Exception as error:
            self.end_at_bug(f"while handling a message on {key}", error, stop)

    def _pauses(self) -> Mapping[keys.Topic, Callable[[], object]]:
        """Return by topic what its thread calls before it waits for the next message."""
        return {}

    @abstractmethod
    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        """Let the step handle one message or tick, and put its answers; the lock is held."""


class NodeService(StepService):
    """Runs a node: gives it messages and ticks, and puts the messages that it returns.

    Args:
        node: the node.
        settings: of the service.
        resumption: by what the node goes on; None for the journal in the folder that is set, if there is one.
    """

    def __init__(self, node: Node, settings: ServiceSettings, resumption: Resumption | None = None) -> None:
        super().__init__(node, settings)
        self._node = node
        self._resumption = resumption
        self._patient = node if isinstance(node, Patient) else None
        self._hurry = threading.Event()
        if isinstance(node, OnDemand):
            node.is_demanded = False

    @property
    def is_busy(self) -> bool:
        """Whether the node is in the middle of a segment."""
        with self._lock:
            return isinstance(self._node, Remembering) and self._node.is_busy

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        if self._resumption is None:
            self._resumption = Resumption.of(self._node, self.name, self._settings, self._counters)
        if self._resumption is None:
            super()._work(session, outbox, stop, vacant_s)
            return
        try:
            self._serve_inputs(session, outbox, stop, self._resumption.resume(outbox, vacant_s))
        finally:
            self._resumption.close()

    def _pauses(self) -> Mapping[keys.Topic, Callable[[], object]]:
        topics = () if self._patient is None else self._patient.may_wait
        return dict.fromkeys(topics, lambda: self._hurry.wait(PAUSE_S))

    def _store(self) -> None:
        if self._resumption is None:
            return
        try:
            self._resumption.store()
        except OSError as error:
            with self._lock:
                self._resumption.report(error)

    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        if isinstance(message, Tick) and isinstance(self._node, OnDemand):
            pattern = keys.pattern(self._node.on_demand, self._settings.sensor)
            self._node.is_demanded = outbox.is_demanded(pattern)
        for output in self._node.handle(message):
            if self._resumption is None or self._resumption.admits(output):
                outbox.put(output)
        if self._patient is not None and self._patient.has_time:
            self._hurry.clear()
        else:
            self._hurry.set()


def _origin(sample: zenoh.Sample) -> str:
    """Return who put a sample: the outbox that its attachment names, else the session of its Zenoh timestamp; else "".

    The timestamp alone would not do: a router puts one of its own in place of that of a host whose clock is ahead.
    """
    origin = "" if sample.attachment is None else origin_of(sample.attachment.to_bytes())
    return origin or (str(sample.timestamp.get_id()) if sample.timestamp else "")


class Repetitions:
    """The answers received last. After a restart, the service that gave an answer may send it again, byte for byte."""

    def __init__(self) -> None:
        self._received: OrderedDict[int, None] = OrderedDict()

    def has(self, message: Message, payload: bytes) -> bool:
        """Tell whether an answer has been received before, and remember it; partial actions and others are not."""
        if not isinstance(message, Event) and not (isinstance(message, Action) and message.final):
            return False
        if message.seq is None:
            return False
        digest = hash(payload)
        repeated = digest in self._received
        self._received[digest] = None
        self._received.move_to_end(digest)
        if len(self._received) > REMEMBERED:
            self._received.popitem(last=False)
        return repeated
