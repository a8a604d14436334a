"""The life of a service: connect, subscribe, step, report, and leave cleanly."""

import _thread
import gc
import logging
import os
import signal
import sys
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import TypeVar

import zenoh
from pydantic import ValidationError

from actum.codec import DecodeError, decode, encode
from actum.command_line import from_command_line
from actum.health import write_health
from actum.keys import key_of
from actum.messages import Message
from actum.node import TICK_NS, Node, Source, Tally, Tick
from actum.runtime.inbox import Inbox
from actum.runtime.meter import Meter
from actum.runtime.outbox import Outbox
from actum.runtime.parent import end_with_parent
from actum.runtime.session import client_config, connected, open_session
from actum.settings import ServiceSettings, complaint

log = logging.getLogger("actum")
S = TypeVar("S", bound=ServiceSettings)
N = TypeVar("N")
UNUSABLE = 2
REPORT_S = 1.0
SLICE_S = 0.1


def run(settings_type: type[S], build: Callable[[S], Node]) -> None:
    """Serve a node until SIGTERM or SIGINT; the process's whole life."""
    settings, node = _configured(settings_type, build)
    _live(NodeService(node, settings), settings, node.name)


def run_source(settings_type: type[S], build: Callable[[S], Source]) -> None:
    """Serve a source until SIGTERM or SIGINT; the process's whole life."""
    settings, source = _configured(settings_type, build)
    _live(SourceService(source, settings), settings, source.name)


def _configured(settings_type: type[S], build: Callable[[S], N]) -> tuple[S, N]:
    """Read the settings and build what they describe; what cannot be used ends the process with a line, code 2."""
    end_with_parent()
    service = settings_type.__module__.partition(".")[0]
    try:
        settings = from_command_line(settings_type, f"python -m {service}")
        client_config(settings)  # refused now, not after what takes long to build
        return settings, build(settings)
    except ValidationError as error:
        print(f"{service}: {complaint(error)} (see --help)", file=sys.stderr)
    except ValueError as error:
        print(f"{service}: {error}", file=sys.stderr)
    sys.exit(UNUSABLE)


def stop_on_signals() -> threading.Event:
    """Return an event that SIGTERM and SIGINT set.

    A thread of its own sets it: a handler runs in the main thread, perhaps while that holds the event's lock.
    """
    stop = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: _thread.start_new_thread(stop.set, ()))
    return stop


def wait_for(stop: threading.Event, seconds: float = float("inf")) -> bool:
    """Wait until stopped or for so long; True if stopped.

    The wait is cut into slices: a signal that the kernel hands to one of Zenoh's threads does not end a wait of the
    main thread, and its handler runs only once that thread moves.
    """
    deadline_s = time.monotonic() + seconds
    while (left_s := deadline_s - time.monotonic()) > 0:
        if stop.wait(min(left_s, SLICE_S)):
            return True
    return stop.is_set()


def _live(service: "Service", settings: ServiceSettings, name: str) -> None:
    logging.basicConfig(level=os.environ.get("ACTUM_LOG", "INFO"), format=f"{name}: %(message)s")
    stop = stop_on_signals()
    session = open_session(settings, stop)
    if session is None:
        return
    gc.freeze()  # what is there now stays; collections need not walk through it again
    try:
        service.serve(session, stop)
    finally:
        session.close()
    sys.exit(1 if service.failed else 0)


class Service(ABC):
    """What nodes and sources share: the way out, the report, the token and the description."""

    def __init__(self, name: str, tally: Tally, settings: ServiceSettings) -> None:
        self.failed = False
        self._health_unwritable = False
        self._settings = settings
        self._meter = Meter(name, tally, settings)
        self._lock = threading.Lock()

    def serve(self, session: zenoh.Session, stop: threading.Event) -> None:
        """Work until stopped."""
        outbox = Outbox(session)
        token = session.liveliness().declare_token(self._meter.keys["alive"])
        queryable = session.declare_queryable(self._meter.keys["info"], self._answer_info)
        reporter = threading.Thread(target=self._report, args=(session, outbox, stop), daemon=True)
        reporter.start()
        try:
            self._work(session, outbox, stop)
        finally:
            stop.set()
            reporter.join(timeout=0.5)
            queryable.undeclare()
            token.undeclare()

    @abstractmethod
    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event) -> None:
        """Do what this kind of service does, until stopped."""

    def _healthy(self) -> bool:
        return True

    def _answer_info(self, query: zenoh.Query) -> None:
        with query:
            with self._lock:
                frame = encode(self._meter.info())
            query.reply(frame.key, frame.payload, encoding=frame.encoding)

    def _report(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event) -> None:
        while not stop.wait(REPORT_S):
            with self._lock:
                status = self._meter.status()
            outbox.put(status)
            self._tell_health(self._healthy() and connected(session))

    def _tell_health(self, healthy: bool) -> None:
        """Write the health file if there is to be one; where it cannot be written, say so once and go on."""
        if self._settings.health_file is None:
            return
        try:
            write_health(self._settings.health_file, healthy)
        except OSError as error:
            if not self._health_unwritable:
                log.warning("the health file cannot be written: %s", error)
            self._health_unwritable = True


class NodeService(Service):
    """A node: messages in, messages out, ticks between."""

    def __init__(self, node: Node, settings: ServiceSettings) -> None:
        super().__init__(node.name, node.tally, settings)
        self._node = node
        self._inbox: Inbox | None = None

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event) -> None:
        self._inbox = Inbox(session, self._node.inputs, self._settings.sensor)
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
        try:
            with self._lock:
                self._meter.received(key, message, _origin(sample))
            self._step(message, outbox)
            with self._lock:
                self._meter.took((time.perf_counter_ns() - began_ns) / 1e6)
        except Exception:
            log.exception("a bug, met while handling a message on %s", key)
            self.failed = True
            stop.set()

    def _step(self, message: Message | Tick, outbox: Outbox) -> None:
        with self._lock:
            for output in self._node.handle(message):
                outbox.put(output)


def _origin(sample: zenoh.Sample) -> str:
    """Name the session that put a sample: the one that stamped it."""
    return str(sample.timestamp.get_id()) if sample.timestamp else ""


class SourceService(Service):
    """A source: each frame is put when its stamp is due."""

    def __init__(self, source: Source, settings: ServiceSettings) -> None:
        super().__init__(source.name, source.tally, settings)
        self._source = source

    def _work(self, _session: zenoh.Session, outbox: Outbox, stop: threading.Event) -> None:
        pace = Pace(speed=1.0)
        for messages in self._source.frames():
            if self._source.paced and messages and not pace.wait(messages[0].stamp_ns, stop):
                return
            for message in messages:
                outbox.put(message)
                with self._lock:
                    self._meter.put(key_of(message))
            if stop.is_set():
                return
        self._source.tally.state = "source ended"
        log.info("the source has ended")
        wait_for(stop)


class Pace:
    """Lets stamps pass at the speed at which they were captured, or a multiple of it."""

    def __init__(self, speed: float) -> None:
        self._speed = speed
        self._origin: tuple[int, int] | None = None

    def wait(self, stamp_ns: int, stop: threading.Event) -> bool:
        """Wait until the stamp is due; False if stopped meanwhile."""
        if self._origin is None:
            self._origin = stamp_ns, time.monotonic_ns()
        first_stamp_ns, began_ns = self._origin
        due_ns = began_ns + (stamp_ns - first_stamp_ns) / self._speed
        return not wait_for(stop, (due_ns - time.monotonic_ns()) / 1e9)
