"""A webcam, a stream, a depth camera or a file of pictures as a sensor."""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace

from actum.messages import Message
from actum.node import SECOND_NS, Counters
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError, Capture, CaptureEndedError
from sensor_gateway.devices.watch import BackOff, Watch
from sensor_gateway.optics import Optics
from sensor_gateway.people.pose_estimator import Estimator
from sensor_gateway.perceiver import Perceiver

PATIENCE_S = 0.1
"""How long one wait for a picture may take, and so how long a stop is delayed."""

REMINDER_NS = SECOND_NS
"""How often a lost camera is reported again."""

Seen = Picture | str | None
"""A usable picture, why there is none, or None: it only takes longer."""


class CameraSource:
    """Images and skeletons of a camera; while it is lost, invalid skeletons that say why, and attempts to reopen it.

    A device, a stream or a file that cannot be read, or whose pictures are frozen or stay black, is opened again after
    ever longer waits. A file that is over ends the source.
    """

    name = "sensor_gateway"
    paced = False

    def __init__(
        self,
        open_estimator: Callable[[], AbstractContextManager[Estimator]],
        optics: Optics,
        open_capture: Callable[[], Capture],
        *,
        sensor: str,
        session_id: str,
        perceiver: type[Perceiver] = Perceiver,
        now_ns: Callable[[], int] = time.time_ns,
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        self.counters = Counters()
        self.counters.details["calibration"] = str(optics)
        self._open_estimator, self._open_capture = open_estimator, open_capture
        self._optics, self._sensor, self._session_id = optics, sensor, session_id
        self._perceiver, self._now_ns, self._pause = perceiver, now_ns, pause
        self._watch = Watch()
        self._newest_ns = self._shift_ns = 0
        self._reported: tuple[str, int] | None = None

    def frames(self) -> Iterator[list[Message]]:
        """Yield images and their skeletons; empty frames while there are none, so that the source can be stopped."""
        with self._open_estimator() as estimator:
            perceiver = self._perceiver(estimator, self._optics, self._sensor, self._session_id, self.counters)
            for seen in self._seen():
                yield from self._messages(seen, perceiver)

    def _seen(self) -> Iterator[Seen]:
        back_off = BackOff()
        while True:
            capture = self._open_capture()
            try:
                for seen in self._watched(capture):
                    if isinstance(seen, Picture):
                        back_off.worked()
                    yield seen
            except CaptureEndedError:
                return
            except CameraLostError as error:
                yield str(error)
            finally:
                capture.close()
            yield from self._waiting(back_off.failed())

    def _watched(self, capture: Capture) -> Iterator[Seen]:
        """Yield what a capture gives, until it is lost, frozen or stays black; a file's pictures may be both."""
        self._watch.opened()
        while True:
            picture = capture.next(PATIENCE_S)
            complaint = self._watch.complaint(picture) if picture is not None and capture.live else None
            if complaint is not None and self._watch.lost:
                raise CameraLostError(complaint)
            yield picture if complaint is None else complaint

    def _waiting(self, wait_ns: int) -> Iterator[None]:
        due_ns = self._now_ns() + wait_ns
        while (left_ns := due_ns - self._now_ns()) > 0:
            yield None
            self._pause(min(left_ns / SECOND_NS, PATIENCE_S))

    def _messages(self, seen: Seen, perceiver: Perceiver) -> Iterator[list[Message]]:
        if seen is None and self._reported is not None:
            seen = self._reported[0]
        if seen is None:
            yield []
        elif isinstance(seen, str):
            yield self._lost(seen, perceiver)
        else:
            if self._reported is not None:
                self._reported = None
                self.counters.state = "running"
            stamp_ns = self._rising(seen.stamp_ns)
            for message in perceiver.messages(replace(seen, stamp_ns=stamp_ns)):
                yield [message]

    def _lost(self, reason: str, perceiver: Perceiver) -> list[Message]:
        """Report a new reason at once, the same one again every second."""
        now_ns = self._now_ns()
        if self._reported is None or self._reported[0] != reason:
            self.counters.reject("camera_lost", reason)
            self.counters.state = f"camera lost: {reason}"
        elif now_ns - self._reported[1] < REMINDER_NS:
            return []
        self._reported = reason, now_ns
        return perceiver.lost(self._rising(now_ns), f"camera lost: {reason}")

    def _rising(self, stamp_ns: int) -> int:
        """Shift stamps by a constant from where the host's clock was set back, so that they rise and intervals stay."""
        self._shift_ns = max(self._shift_ns, self._newest_ns + 1 - stamp_ns)
        self._newest_ns = stamp_ns + self._shift_ns
        return self._newest_ns
