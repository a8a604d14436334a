"""A service of a sensor that several processes share: it stands by, and serves while the sensor is this process's.

While it stands by it listens to the answers that the serving process puts. So it knows, when its turn comes, which
segments are answered, and requests the marks and frames of all others.
"""

import logging
import threading
from collections.abc import Callable

import zenoh

from actum import keys
from actum.codec import DecodeError, Frame, decode
from actum.health import HealthFile
from actum.messages import Action
from actum.node import Node, Remembering
from actum.runtime.inbox import RESUMED_S, Reach, Subscriber, subscribe_recovering
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


class SharingService:
    """Stands by for a sensor, and serves it by a node of its own at each turn.

    Args:
        node: the node of the first turn.
        build: makes those of later turns.
        settings: of the sensor.
    """

    def __init__(self, node: Node, build: Callable[[], Node], settings: ServiceSettings) -> None:
        self.name, self.thread_name = node.name, settings.sensor
        self.is_healthy_beside: Callable[[], bool] = lambda: True
        self._build, self._settings = build, settings
        self._heard = HeardAnswers()
        self._answers = node.answers if isinstance(node, Remembering) else None
        self._is_serving = False
        self._prepare(node)

    @property
    def failed(self) -> bool:
        """Whether a bug ended it."""
        return self._service.failed

    @property
    def has_ended(self) -> bool:
        """Whether it was stopped while it served."""
        return self._service.has_ended

    @property
    def is_healthy(self) -> bool:
        """Whether it works, if this is its turn."""
        return self._service.is_healthy or not self._is_serving

    def introduce(self) -> None:
        """Log any problem that there is already."""
        self._service.introduce()

    def end_at_bug(self, where: str, error: BaseException, stop: threading.Event) -> None:
        """Log a bug, and stop."""
        self._service.end_at_bug(where, error, stop)

    def serve(self, session: zenoh.Session, stop: threading.Event, settling_s: float) -> None:
        """Stand by until stopped, and serve the sensor at each turn."""
        place = SharedPlace(session, self._settings, self.name, lambda: self._service.is_busy)
        health_file = HealthFile(self._settings.health_file)
        listening = None if self._answers is None else self._listen(session, self._answers)
        place.join()
        try:
            while not (wait_for(stop, LOOK_S) or self.failed):
                health_file.write(self.is_healthy_beside() and connected(session))
                if place.is_this_ones_turn():
                    self._take_turn(place, session, stop, settling_s)
        finally:
            place.resign()
            if listening is not None:
                listening.undeclare()

    def _take_turn(self, place: SharedPlace, session: zenoh.Session, stop: threading.Event, settling_s: float) -> None:
        """Serve until stopped, or until the sensor is another process's."""
        try:
            if not place.claim(stop, settling_s):
                return
        except PlaceTakenError:  # another process was faster
            return
        log.info("this instance now serves sensor %s", self._settings.sensor)
        self._heard.is_new = self._heard.is_new and not place.has_been_held
        turn_ends = threading.Event()
        given, name = (place, session, turn_ends), f"{self.thread_name} turn"
        turn = threading.Thread(target=self._service.hold, args=given, name=name)
        self._is_serving = True
        turn.start()
        while turn.is_alive() and not wait_for(stop, LOOK_S):
            pass
        turn_ends.set()
        turn.join()
        self._is_serving, self._heard.is_new = False, False
        if not (stop.is_set() or self.failed):
            self._prepare(self._build())

    def _prepare(self, node: Node) -> None:
        """Make the service of the next turn: its answers are kept beside those that are heard."""
        resumption = Resumption(node, self._heard, node.counters) if isinstance(node, Remembering) else None
        self._service = NodeService(node, self._settings, resumption)

    def _listen(self, session: zenoh.Session, answers: keys.Topic) -> Subscriber:
        """Keep the answers that any process has put lately and will put."""
        lately = Reach(requested_s=RESUMED_S, depth=None).history(answers)
        subscriber = subscribe_recovering(session, keys.pattern(answers, self._settings.sensor), answers.ring, lately)

        def keep() -> None:
            for sample in subscriber:
                self._keep(sample)

        threading.Thread(target=keep, name=f"{self.thread_name} listening", daemon=True).start()
        return subscriber

    def _keep(self, sample: zenoh.Sample) -> None:
        """Keep an answer; a partial action is none, and what cannot be decoded the serving process counts."""
        key, payload, encoding = str(sample.key_expr), sample.payload.to_bytes(), str(sample.encoding)
        try:
            message = decode(key, payload, encoding)
        except DecodeError:
            return
        if not isinstance(message, Action) or message.final:
            attachment = b"" if sample.attachment is None else sample.attachment.to_bytes()
            self._heard.add(Frame(key, payload, encoding, attachment))
