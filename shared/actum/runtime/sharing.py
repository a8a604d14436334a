"""A service of a sensor that several processes share: it stands by, and serves while the sensor is this process's.

While it stands by it listens to the answers that the serving process puts. So it knows, when its turn comes, which
segments are answered, and requests the marks and frames of all others.
"""

import logging
import math
import threading
import time
from collections.abc import Callable

import zenoh

from actum.codec import DecodeError, Frame, decode
from actum.health import HealthFile
from actum.messages import Action
from actum.node import SECOND_NS, Node, Remembering
from actum.runtime.inbox import RESUMED_S, Inbox, Reach
from actum.runtime.journal import WrittenAnswer
from actum.runtime.place import PlaceTakenError
from actum.runtime.rendezvous import SharedPlace
from actum.runtime.resuming import HeardAnswers, Resumption
from actum.runtime.session import connected
from actum.runtime.step_service import NodeService
from actum.runtime.stopping import wait_for
from actum.settings import ServiceSettings

log = logging.getLogger("actum")

LOOK_S = 0.2
"""Interval (s) between two looks at who serves the sensor: a process that died is replaced within ten of them."""
STARTING_S = 5.0
"""How long (s) a turn may take to begin, before the process counts as unhealthy."""


class SharingService:
    """Stands by for a sensor, and serves it by a node of its own at each turn.

    Args:
        node: built at the start, so that wrong settings are refused then; it holds the model in memory until a turn.
        build: makes the node of each turn.
        settings: of the sensor.
    """

    def __init__(self, node: Node, build: Callable[[], Node], settings: ServiceSettings) -> None:
        self.name, self.thread_name = node.name, settings.sensor
        self.is_healthy_beside: Callable[[], bool] = lambda: True
        self.has_ended = False
        self._build, self._settings = build, settings
        self._heard = HeardAnswers()
        self._answers = node.answers if isinstance(node, Remembering) else None
        self._begun_s = math.inf
        self._prepare(node)

    @property
    def failed(self) -> bool:
        """Whether a bug ended it."""
        return self._service.failed

    @property
    def is_healthy(self) -> bool:
        """Whether it works, if this is its turn."""
        return self._service.is_healthy or time.monotonic() - self._begun_s < STARTING_S

    def introduce(self) -> None:
        """Log any problem that there is already."""
        self._service.introduce()

    def end_at_bug(self, where: str, error: BaseException, stop: threading.Event) -> None:
        """Log a bug, and stop."""
        self._service.end_at_bug(where, error, stop)

    def serve(self, session: zenoh.Session, stop: threading.Event, _settling_s: float) -> None:
        """Stand by until stopped, and serve the sensor at each turn."""
        place = SharedPlace(session, self._settings, self.name, lambda: self._service.is_busy)
        health_file = HealthFile(self._settings.health_file)
        lately = Reach(RESUMED_S, RESUMED_S, depth=None)
        listening = Inbox(session, () if self._answers is None else (self._answers,), self._settings.sensor, lately)
        listening.start(self._keep)
        place.join()
        try:
            while not (wait_for(stop, LOOK_S) or self.failed):
                health_file.write(self.is_healthy_beside() and connected(session))
                if place.is_this_ones_turn():
                    self._take_turn(place, session, stop)
        finally:
            place.resign()
            listening.close()
        self.has_ended = True

    def _take_turn(self, place: SharedPlace, session: zenoh.Session, stop: threading.Event) -> None:
        """Serve until stopped, or until the sensor is another process's."""
        self._prepare(self._build())  # one that has stood by may be of an older model
        try:
            if not place.claim(stop, place.settling_s):
                return
        except PlaceTakenError:  # another process was faster
            return
        log.info("this instance now serves sensor %s", self._settings.sensor)
        self._heard.is_new = self._heard.is_new and not (place.has_been_held or self._heard.answers)
        turn_ends = threading.Event()
        given, name = (place, session, turn_ends), f"{self.thread_name} turn"
        turn = threading.Thread(target=self._service.hold, args=given, name=name)
        self._begun_s = time.monotonic()
        turn.start()
        while turn.is_alive() and not wait_for(stop, LOOK_S):
            pass
        turn_ends.set()
        turn.join()
        self._begun_s, self._heard.is_new = math.inf, False

    def _prepare(self, node: Node) -> None:
        """Make the service of the next turn: its answers are kept beside those that are heard."""
        resumption = Resumption(node, self._heard, node.counters) if isinstance(node, Remembering) else None
        self._service = NodeService(node, self._settings, resumption)
        self._service.is_healthy_beside = self.is_healthy_beside

    def _keep(self, sample: zenoh.Sample) -> None:
        """Keep an answer; a partial action is none, and what cannot be decoded the serving process counts."""
        key, payload, encoding = str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding)
        try:
            message = decode(key, payload, encoding)
        except DecodeError:
            return
        if isinstance(message, Action) and not message.final:
            return
        attachment = b"" if sample.attachment is None else sample.attachment.to_bytes()
        given_ns = time.time_ns()
        if sample.timestamp is not None:
            given_ns = round(sample.timestamp.get_time().timestamp() * SECOND_NS)
        self._heard.hear(WrittenAnswer(given_ns, Frame(key, payload, encoding, attachment)), message)
