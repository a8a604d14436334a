"""Reports of a running service: its status once a second, and a line of its log where something has changed."""

import logging
import threading
from collections.abc import Callable

import zenoh

from actum.node import Counters
from actum.runtime.health_file import HealthFile
from actum.runtime.meter import Meter
from actum.runtime.outbox import Outbox
from actum.runtime.place import Place
from actum.runtime.session import connected
from actum.settings import ServiceSettings
from actum.states import State

log = logging.getLogger("actum")

REPORT_S = 1.0
"""Interval between two reports (s)."""


class StateLog:
    """Logs each new problem of a service once, and its end; other changes of state are not logged."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._trouble: str | None = None

    def log_change(self) -> None:
        """Log the problem if it is new, or that there is none any more."""
        well = State.of(self._counters.state) is State.RUNNING
        trouble = None if well else self._counters.told_state
        source = self._counters.details.get("source")
        if trouble is not None and trouble != self._trouble:
            log.warning("%s", f"{trouble} ({source})" if source else trouble)
        elif trouble is None and self._trouble is not None:
            log.info("running again")
        self._trouble = trouble


class Reporter:
    """Reports while a service runs, and stops it where another instance takes over."""

    def __init__(self, meter: Meter, state_log: StateLog, settings: ServiceSettings, lock: threading.Lock) -> None:
        self._meter, self._state_log, self._settings, self._lock = meter, state_log, settings, lock
        self._health_file = HealthFile(settings.health_file)
        self._connected = True

    def report(
        self,
        session: zenoh.Session,
        place: Place,
        stop: threading.Event,
        healthy: Callable[[], bool],
        store: Callable[[], None],
    ) -> None:
        """Report once a second until stopped, and have stored what the service writes."""
        outbox = Outbox(session)
        while not stop.wait(REPORT_S):
            with self._lock:
                status = self._meter.status()
                self._state_log.log_change()
            outbox.put(status)
            self._log_connection(connected(session))
            self._health_file.write(healthy() and self._connected)
            store()
            successor = place.lost_to()
            if successor is not None:
                log.warning(
                    "the instance %s replaces this instance for sensor %s: this instance stops",
                    successor,
                    self._settings.sensor,
                )
                stop.set()

    def _log_connection(self, now: bool) -> None:
        """Log once that the router is lost, and once that it is back."""
        if self._connected and not now:
            log.warning("the connection to the router at %s is lost: waiting for the router", self._settings.connect)
        elif now and not self._connected:
            log.info("connected to %s again", self._settings.connect)
        self._connected = now
