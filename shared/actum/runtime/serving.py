"""Runs a service: connects, subscribes, steps, reports, and ends cleanly."""

import gc
import logging
import os
import sys
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import TypeVar

import zenoh
from pydantic import ValidationError

from actum import keys
from actum.bridge import Bridge
from actum.codec import DecodeError, decode, encode
from actum.command_line import from_command_line
from actum.commands import Commanded
from actum.messages import Message
from actum.node import TICK_NS, Node, Source, Tick
from actum.runtime.commanding import Commander
from actum.runtime.inbox import Inbox
from actum.runtime.meter import Meter
from actum.runtime.outbox import Outbox
from actum.runtime.parent import end_with_parent
from actum.runtime.place import RETURNING_S, SETTLING_S, Place, PlaceTakenError
from actum.runtime.reporting import Reporter, StateLog
from actum.runtime.session import RETRY_S, open_session, secret_config
from actum.runtime.waiting import Pace, stop_on_signals, wait_for
from actum.settings import ServiceSettings, complaint

log = logging.getLogger("actum")
S = TypeVar("S", bound=ServiceSettings)
N = TypeVar("N")
UNUSABLE = 2
"""Exit code of a process whose settings cannot be used."""
TAKEN = 3
"""Exit code of a process whose service another process runs already."""


def run(settings_type: type[S], build: Callable[[S], Node]) -> None:
    """Run a node as this process's service until SIGTERM or SIGINT."""
    settings, node = configured(settings_type, build)
    live(NodeService(node, settings), settings)


def run_source(settings_type: type[S], build: Callable[[S], Source]) -> None:
    """Run a source as this process's service until SIGTERM or SIGINT."""
    settings, source = configured(settings_type, build)
    live(SourceService(source, settings), settings)


def configured(settings_type: type[S], build: Callable[[S], N], flags: Sequence[str] | None = None) -> tuple[S, N]:
    """Read the settings, from this process's flags or given ones, and build; if unusable, say why and exit with 2."""
    end_with_parent()
    service = settings_type.__module__.partition(".")[0]
    try:
        settings = from_command_line(settings_type, f"python -m {service}", flags)
        secret_config(settings)  # a wrong one is refused now, before the build, which may take long
        return settings, build(settings)
    except ValidationError as error:
        print(f"{service}: {complaint(error)} (see --help)", file=sys.stderr)
    except ValueError as error:
        print(f"{service}: {error}", file=sys.stderr)
    sys.exit(UNUSABLE)


def live(
    service: "Service",
    settings: ServiceSettings,
    beside: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> None:
    """Connect, serve until SIGTERM or SIGINT, and exit: with code 0, 1 after a bug, 3 where another runs already.

    `beside` is entered before there is a router, and left at the end.
    """
    logging.basicConfig(level=os.environ.get("ACTUM_LOG", "INFO"), format=f"{service.name}: %(message)s")
    stop = stop_on_signals()
    service.introduce()
    with beside():
        _serve(service, settings, stop)
    sys.exit(1 if service.failed else 0)


def _serve(service: "Service", settings: ServiceSettings, stop: threading.Event) -> None:
    began_s = time.monotonic()
    session = open_session(settings, stop)
    if session is None:
        return
    settling_s = SETTLING_S if time.monotonic() - began_s < RETRY_S else RETURNING_S
    gc.freeze()  # objects that exist now live as long as the process: collections need not visit them again
    try:
        service.serve(session, stop, settling_s)
    except PlaceTakenError as error:
        log.error("%s", error)
        sys.exit(TAKEN)
    finally:
        session.close()


class Service(ABC):
    """The part common to nodes and sources: start and end, the one instance per sensor, status and description."""

    def __init__(self, what: Node | Source | Bridge, settings: ServiceSettings) -> None:
        self.name, counters = what.name, what.counters
        self.failed = False
        self._commands = what.commands if isinstance(what, Commanded) else ()
        self._settings = settings
        self._counters = counters
        self._state_log = StateLog(counters)
        self._meter = Meter(self.name, counters, settings)
        self._lock = threading.Lock()

    def introduce(self) -> None:
        """Log the source that is read, and any problem that there is already."""
        if "source" in self._counters.details:
            log.info("sensor %s: %s", self._settings.sensor, self._counters.details["source"])
        self._state_log.log_change()

    def serve(self, session: zenoh.Session, stop: threading.Event, settling_s: float) -> None:
        """Run until stopped, once for `settling_s` no other instance is seen.

        Raises:
            PlaceTakenError: another instance runs and stays.
        """
        place = Place(session, self._settings, self.name)
        if not place.take(stop, settling_s):
            return
        info = keys.key(keys.INFO, self._settings.sensor, self.name)
        queryables = [session.declare_queryable(info, self._answer_info)]
        if self._commands:
            queryables.append(self._commander(stop).declare(session))
        reporter = Reporter(self._meter, self._state_log, self._settings, self._lock)
        reporting = threading.Thread(target=reporter.report, args=(session, place, stop, self._healthy), daemon=True)
        reporting.start()
        try:
            self._work(session, Outbox(session), stop, place.vacant_s)
        finally:
            stop.set()
            reporting.join(timeout=0.5)
            for queryable in queryables:
                queryable.undeclare()
            place.leave()

    @abstractmethod
    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        """Handle messages or put frames until stopped. No other instance has run for `vacant_s` seconds."""

    def _healthy(self) -> bool:
        return True

    def _commander(self, stop: threading.Event) -> Commander:
        def failed() -> None:
            self.failed = True
            stop.set()

        return Commander(self._commands, self._settings, self.name, self._counters, self._lock, failed)

    def _answer_info(self, query: zenoh.Query) -> None:
        with query:
            with self._lock:
                commands = sorted(each.name for each in self._commands)
                frame = encode(self._meter.info().model_copy(update={"commands": commands}))
            query.reply(frame.key, frame.payload, encoding=frame.encoding)


class StepService(Service):
    """Gives a pure step the messages of its topics, and ticks; what becomes of its answers a subclass says."""

    def __init__(self, step: Node | Bridge, settings: ServiceSettings) -> None:
        super().__init__(step, settings)
        self._inputs = step.inputs
        self._inbox: Inbox | None = None

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        self._inbox = Inbox(session, self._inputs, self._settings.sensor, vacant_s)
        self._inbox.start(lambda sample: self._receive(sample, outbox, stop))
        try:
            while not stop.wait(TICK_NS / 1e9):
                self._step(Tick(time.monotonic_ns()), outbox)
        finally:
            self._inbox.close()

    def _healthy(self) -> bool:
        return self._inbox is not None and self._inbox.working

    def _receive(self, sample: zenoh.Sample, outbox: Outbox, stop: threading.Event) -> None:
        """Handle one sample; bad input is counted, a bug ends the process."""
        began_ns = time.perf_counter_ns()
        key = str(sample.key_expr)
        try:
            message = decode(key, sample.payload.to_bytes(), str(sample.encoding))
        except DecodeError as error:
            with self._lock:
                self._meter.rejected(error.kind, str(error))
            return
        with self._ending_at_a_bug(key, stop):
            with self._lock:
                self._meter.received(key, message, _origin(sample))
            self._step(message, outbox)
            with self._lock:
                self._meter.took((time.perf_counter_ns() - began_ns) / 1e6)

    @contextmanager
    def _ending_at_a_bug(self, key: str, stop: threading.Event) -> Iterator[None]:
        """Return a context in which to handle a sample: an exception is a bug, which is logged and ends the process."""
        try:
            yield
        except Exception:
            log.exception("a bug, met while handling a message on %s", key)
            self.failed = True
            stop.set()

    @abstractmethod
    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        """Let the step handle one message or tick, and put its answers."""


class NodeService(StepService):
    """Runs a node: gives it messages and ticks, and puts the messages that it returns."""

    def __init__(self, node: Node, settings: ServiceSettings) -> None:
        super().__init__(node, settings)
        self._node = node

    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        with self._lock:
            for output in self._node.handle(message):
                outbox.put(output)


def _origin(sample: zenoh.Sample) -> str:
    """Return the id of the session that put a sample, from its Zenoh timestamp; "" where it has none."""
    return str(sample.timestamp.get_id()) if sample.timestamp else ""


class SourceService(Service):
    """Runs a source: puts each of its frames when the stamp is due."""

    def __init__(self, source: Source, settings: ServiceSettings) -> None:
        super().__init__(source, settings)
        self._source = source

    def _work(self, _session: zenoh.Session, outbox: Outbox, stop: threading.Event, _vacant_s: float) -> None:
        pace = Pace(speed=1.0)
        for messages in self._source.frames():
            if self._source.paced and messages and not pace.wait(messages[0].stamp_ns, stop):
                return
            for message in messages:
                outbox.put(message)
                with self._lock:
                    self._meter.put(keys.key_of(message))
            if stop.is_set():
                return
        with self._lock:
            self._source.counters.state = "source ended"
            self._state_log.log_change()
        wait_for(stop)
