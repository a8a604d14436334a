"""What every running service does: holds its place, reports, describes itself, obeys commands."""

import logging
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import zenoh

from actum import keys
from actum.codec import encode
from actum.commands import Commanded
from actum.node import Servable, Source
from actum.runtime.commanding import Commander
from actum.runtime.outbox import Outbox
from actum.runtime.place import Place
from actum.runtime.reporting import Meter, Reporter
from actum.runtime.stopping import Pace, wait_for
from actum.runtime.turns import Turns
from actum.settings import ServiceSettings
from actum.states import State

log = logging.getLogger("actum")


class Service(ABC):
    """The part common to nodes and sources: start and end, the one instance per sensor, status and description."""

    def __init__(self, what: Servable, settings: ServiceSettings, turns: Turns | None = None) -> None:
        self.name, counters = what.name, what.counters
        self.failed = self.has_ended = False
        self.is_healthy_beside: Callable[[], bool] = lambda: True
        self.thread_name = settings.sensor
        self._commands = what.commands if isinstance(what, Commanded) else ()
        self._settings = settings
        self._counters = counters
        self._meter = Meter(self.name, counters, settings)
        self._lock = turns or Turns()
        self._reporter = Reporter(self._meter, counters, settings, self._lock)

    def introduce(self) -> None:
        """Log the source that is read, and any problem that there is already."""
        if "source" in self._counters.details:
            log.info("sensor %s: %s", self._settings.sensor, self._counters.details["source"])
        self._reporter.log_state()

    def serve(self, session: zenoh.Session, stop: threading.Event, settling_s: float) -> None:
        """Run until stopped, once for `settling_s` no other instance is seen.

        Raises:
            PlaceTakenError: another instance runs and stays.
        """
        place = Place(session, self._settings, self.name)
        if place.claim(stop, settling_s):
            self.hold(place, session, stop)

    def hold(self, place: Place, session: zenoh.Session, stop: threading.Event) -> None:
        """Run at a place that this service has claimed until stopped, and leave it."""
        queryables = self._queryables(session, stop)
        given = (session, place, stop, lambda: self.is_healthy and self.is_healthy_beside(), self._store)
        name = f"{self.thread_name} reporting"
        reporting = threading.Thread(target=self._reporter.report, args=given, name=name, daemon=True)
        reporting.start()
        try:
            self._work(session, Outbox(session), stop, place.vacant_s)
        except Exception as error:
            self.end_at_bug("while the service worked", error, stop)
        finally:
            self.has_ended = True
            stop.set()
            reporting.join(timeout=0.5)
            for queryable in queryables:
                queryable.undeclare()
            place.leave()

    @abstractmethod
    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        """Handle messages or put frames until stopped. No other instance has run for `vacant_s` seconds."""

    @property
    def is_healthy(self) -> bool:
        """Whether it works."""
        return True

    def _store(self) -> None:  # noqa: B027 - most services write nothing
        """Have stored on the disk what was written, once a second."""

    def end_at_bug(self, where: str, error: BaseException, stop: threading.Event) -> None:
        """Log a bug, and stop."""
        log.error(
            "the service stops, because a bug occurred %s: report the bug with the lines that follow",
            where,
            exc_info=error,
        )
        self.failed = True
        stop.set()

    @contextmanager
    def _ending_at_a_bug(self, where: str, stop: threading.Event) -> Iterator[None]:
        """Return a context for what Zenoh calls: it would swallow an exception, which is a bug and ends the process."""
        try:
            yield
        except Exception as error:
            self.end_at_bug(where, error, stop)

    def _queryables(self, session: zenoh.Session, stop: threading.Event) -> "list[zenoh.Queryable[None]]":
        """Declare what answers queries for the description of the service, and for its commands where it has any."""
        info = keys.key(keys.INFO, self._settings.sensor, self.name)
        queryables = [session.declare_queryable(info, lambda query: self._answer_info(query, stop))]
        if self._commands:

            def end_at_bug(where: str, error: BaseException) -> None:
                self.end_at_bug(where, error, stop)

            commander = Commander(self._commands, self._settings, self.name, self._counters, self._lock, end_at_bug)
            queryables.append(commander.declare(session))
        return queryables

    def _answer_info(self, query: zenoh.Query, stop: threading.Event) -> None:
        with self._ending_at_a_bug("while describing the service", stop), query:
            with self._lock:
                commands = sorted(each.name for each in self._commands)
                frame = encode(self._meter.info().model_copy(update={"commands": commands}))
            query.reply(frame.key, frame.payload, encoding=frame.encoding)


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
                    self._meter.count(keys.key_of(message))
            if stop.is_set():
                return
        with self._lock:
            self._source.counters.state = State.SOURCE_ENDED
            self._reporter.log_state()
        wait_for(stop)
