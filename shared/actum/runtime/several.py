"""Several services of one name in a process, each for a sensor of its own: they share the session and the model."""

import logging
import threading
from collections.abc import Sequence

import zenoh

from actum.runtime.place import PlaceTakenError
from actum.runtime.service import Service
from actum.runtime.sharing import SharingService
from actum.runtime.stopping import wait_for

LOOK_S = 0.1
"""How late (s) the end of one service may be noticed."""


Served = Service | SharingService
"""What a process runs for one sensor: a service, or one that several processes share."""


def serve_all(services: Sequence[Served], session: zenoh.Session, stop: threading.Event, settling_s: float) -> None:
    """Serve until all have ended: when stopped, or each when another instance takes over its sensor.

    A bug in one of them, or a sensor that another instance serves and keeps, ends all.

    Raises:
        PlaceTakenError: another instance runs for one of the sensors, and stays.
    """
    if len(services) == 1:
        services[0].serve(session, stop, settling_s)
        return
    running = [_Serving(service, session, settling_s) for service in services]
    for served in running:  # all write one health file: that of the process
        served.service.is_healthy_beside = lambda: all(
            each.service.is_healthy for each in running if each.thread.is_alive()
        )
    while any(each.thread.is_alive() for each in running):
        if wait_for(stop, LOOK_S) or any(each.refusal or each.service.failed for each in running):
            break
    for each in running:
        each.stop.set()
    for each in running:
        each.thread.join()
    for refusal in filter(None, (each.refusal for each in running)):
        raise refusal


class _Serving:
    """A service that runs in a thread of its own."""

    def __init__(self, service: Served, session: zenoh.Session, settling_s: float) -> None:
        self.service, self.stop = service, threading.Event()
        self.refusal: PlaceTakenError | None = None
        self.thread = threading.Thread(target=self._serve, args=(session, settling_s), name=service.thread_name)
        self.thread.start()

    def _serve(self, session: zenoh.Session, settling_s: float) -> None:
        try:
            self.service.serve(session, self.stop, settling_s)
        except PlaceTakenError as error:
            self.refusal = error


def end_at_bugs(services: Sequence[Served], stop: threading.Event) -> None:
    """Have the process end where any of its threads does by an exception: without it a service is mute or deaf."""

    def ended(thread: threading.ExceptHookArgs) -> None:
        name = str(thread.thread and thread.thread.name)
        sensor = name.partition(" ")[0]
        owner = next((each for each in services if each.thread_name == sensor), services[0])
        if not stop.is_set() and not owner.has_ended and thread.exc_value is not None:
            owner.end_at_bug(f"in the thread {name}", thread.exc_value, stop)

    threading.excepthook = ended


def name_sensors(sensors: Sequence[str]) -> None:
    """Have each line of the log begin with the sensor whose thread writes it."""

    def named(record: logging.LogRecord) -> bool:
        sensor = str(record.threadName).partition(" ")[0]
        if sensor in sensors:
            record.msg = f"{sensor}: {record.msg}"
        return True

    for handler in logging.getLogger().handlers:
        handler.addFilter(named)
