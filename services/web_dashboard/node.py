"""The page's service: takes what is put on the sensor's keys, and gives it to the browsers."""

import logging
import time
from collections import deque
from collections.abc import Iterable
from contextlib import AbstractContextManager

from actum import keys
from actum.hops import Hops
from actum.messages import Continuation, Image, Message
from actum.node import SECOND_NS, Counters, Tick
from actum.runtime import Client
from web_dashboard.application import application
from web_dashboard.encoding import envelope_of
from web_dashboard.hub import Hub
from web_dashboard.orders import Orders
from web_dashboard.server import PageServer, bound_socket
from web_dashboard.settings import Settings

log = logging.getLogger("actum")

MOST_REFUSALS = 1000
"""Refusals that wait to be counted, which they are ten times a second."""


class WebDashboard:
    """Shows browsers what goes on, and passes on what people mark and ask there."""

    name = "web_dashboard"
    inputs = (
        keys.SKELETON,
        keys.COLOR,
        keys.POSTURE,
        keys.OBJECTS,
        keys.SEGMENT,
        keys.ACTION,
        keys.HELD_BACK,
        keys.EVENT,
        keys.INTENT,
        keys.CONTINUATION,
        keys.STATUS,
        keys.TRAINING,
    )

    def __init__(self, settings: Settings, hub: Hub, orders: Orders, server: PageServer) -> None:
        self.counters = Counters(details={"page": server.address})
        self._sensor = settings.sensor
        self._hub = hub
        self._orders = orders
        self._server = server
        self._hops = Hops(time.monotonic_ns)
        self._measured_s = 0

    @classmethod
    def configured(cls, settings: Settings) -> "WebDashboard":
        """Build the node with its server, which listens and does not serve yet.

        Raises:
            SettingsError: the port cannot be listened on.
        """
        hub, orders = Hub(), Orders(settings.sensor, deque(maxlen=MOST_REFUSALS))
        listening = bound_socket(settings.page_host, settings.page_port)
        return cls(settings, hub, orders, PageServer(application(settings, hub, orders), listening, settings.page_host))

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        """Give a message to the browsers, and measure how long after its cause it came; at a tick, report."""
        if isinstance(message, Tick):
            self._report(message)
            return ()
        self._hops.receive(message)
        if self._hub.watched or not isinstance(message, Image | Continuation):
            self._hub.publish(envelope_of(message))
        return ()

    def _report(self, tick: Tick) -> None:
        """Count what browsers were refused and did not get, and once a second report where the time goes."""
        if not self._server.working:
            raise RuntimeError(
                "the web server of the page stopped unexpectedly: see the log messages before this message"
            )
        while self._orders.refused:
            self.counters.reject("refused_browser", self._orders.refused.popleft())
        if self._hub.left_out:
            self.counters.counts["left_out"] = self._hub.left_out
        if tick.monotonic_ns // SECOND_NS != self._measured_s:
            self._measured_s = tick.monotonic_ns // SECOND_NS
            self.counters.hops = self._hops.times()

    def serving(self) -> AbstractContextManager[None]:
        """Serve browsers, also while there is no router yet."""
        log.info("sensor %s, the page: %s", self._sensor, self._server.address)
        return self._server.serving()

    def attach(self, client: Client | None) -> None:
        """Take the session by which marks and commands go; None where there is none any more."""
        self._orders.client = client

    @property
    def working(self) -> bool:
        """Whether browsers are served."""
        return self._server.working
