"""One run: faults strike, the client marks and listens, and what ends is started again."""

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from actum import keys
from actum.messages import Skeleton
from actum.runtime import Client, Listening

from .faults import SERVICES, Fault
from .hearing import Heard
from .hosts import TwoHosts
from .marking import Marker
from .recovery import Signs, Strike

STEP_S = 0.01
"""Interval of the loop (s): a third of a frame's."""
READY_S = 60.0
"""How long all programs may take to start (s), on a busy machine."""
SETTLE_S = 75.0
"""How long answers may take after the last mark (s): a longest segment, and all waiting that there is."""
STREAMS = (keys.SKELETON, keys.POSTURE, keys.OBJECTS, keys.STATUS)
"""What tells that all works; images stay on their host."""
ANSWERS = (keys.SEGMENT, keys.ACTION, keys.EVENT)
Tell = Callable[[str], object]


class NotReadyError(RuntimeError):
    """The programs did not all come up."""


@dataclass
class Run:
    """A run in progress, and what comes of it.

    Attributes:
        hosts: the processes, which run.
        marker: the switch.
        faults: those to come, by their time.
        segments: how many actions have to be over before it ends.
    """

    hosts: TwoHosts
    marker: Marker
    faults: Sequence[Fault]
    segments: int
    tell: Tell
    heard: Heard = field(default_factory=Heard)
    signs: Signs = field(default_factory=Signs)
    strikes: list[Strike] = field(default_factory=list)
    _going_on: list[Strike] = field(default_factory=list)

    def play(self) -> None:
        """Run until so many actions were done, all faults are over, all is well, and every mark is answered or too old.

        Raises:
            NotReadyError: a program is missing.
            RouterUnreachableError: there is no router.
        """
        with Client(self.hosts.client_settings, READY_S) as client:
            streams = [client.listen(keys.pattern(topic, client.sensor)) for topic in STREAMS]
            answers = [client.listen_back(keys.pattern(topic, client.sensor), SETTLE_S) for topic in ANSWERS]
            listening = [*streams, *answers]
            self._wait_until_ready(client, listening)
            began_s, waiting = time.monotonic(), deque(self.faults)
            while waiting or self._going_on or self.marker.played < self.segments:
                if waiting and time.monotonic() - began_s >= waiting[0].at_s:
                    self._strike(waiting.popleft())
                self._relieve()
                self._step(client, listening, marking=True)
            deadline_s = time.monotonic() + SETTLE_S
            while self._is_unsettled() and time.monotonic() < deadline_s:
                self._step(client, listening, marking=False)

    def _wait_until_ready(self, client: Client, listening: Sequence[Listening]) -> None:
        deadline_s = time.monotonic() + READY_S
        while missing := [service for service in SERVICES if not self.signs.by_service[service]]:
            if time.monotonic() > deadline_s:
                raise NotReadyError(f"{', '.join(missing)} did not start: see {self.hosts.log}")
            self._step(client, listening, marking=False)

    def _step(self, client: Client, listening: Sequence[Listening], marking: bool) -> None:
        """Take what has come, put the marks that are due (those begun are ended), and start what has ended."""
        for stream in listening:
            while (received := stream.receive()) is not None:
                if received.message is not None:
                    now_s = time.monotonic()
                    for line in self.heard.hear(received.message, now_s):
                        self.hosts.note(line)
                    self.signs.hear(received.message, now_s, time.time_ns())
                    if isinstance(received.message, Skeleton):
                        self.marker.hear(received.message, now_s)
        for mark in self.marker.due(time.monotonic(), client.sensor, marking):
            self.hosts.note(f"{mark.kind} of {mark.segment_id}")
            client.put(mark)
        for line in self.hosts.restart_ended():
            self.tell(line)
        time.sleep(STEP_S)

    def _strike(self, fault: Fault) -> None:
        self.tell(f"{len(self.strikes) + 1} of {len(self.faults)}: {fault}")
        self.hosts.strike(fault)
        now_s = time.monotonic()
        strike = Strike(fault, now_s, now_s + fault.lasts_s)
        self.strikes.append(strike)
        self._going_on.append(strike)

    def _relieve(self) -> None:
        for strike in [each for each in self._going_on if each.over_s <= time.monotonic()]:
            self.hosts.relieve(strike.fault)
            strike.over_s = time.monotonic()
            self._going_on.remove(strike)

    def _is_unsettled(self) -> bool:
        """Tell whether a mark has no answer yet, or what the last fault struck does not work yet."""
        unwell = any(self.signs.well_s(strike) is None for strike in self.strikes[-1:])
        return unwell or any(not self.heard.events[name] for name in self.marker.marked)
