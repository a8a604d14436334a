"""Runs a source: puts each of its frames when the stamp is due."""

import threading

import zenoh

from actum import keys
from actum.node import Source
from actum.runtime.outbox import Outbox
from actum.runtime.service import Service
from actum.runtime.waiting import Pace, wait_for
from actum.settings import ServiceSettings
from actum.states import State


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
            self._source.counters.state = State.SOURCE_ENDED
            self._state_log.log_change()
        wait_for(stop)
