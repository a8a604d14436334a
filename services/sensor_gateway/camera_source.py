"""The source of a camera: a webcam, a stream, a depth camera or a file of pictures, with reconnection."""

import math
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace

from actum import steady_clock
from actum.messages import Message
from actum.node import SECOND_NS, Counters
from actum.states import State
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError, Capture, CaptureEndedError
from sensor_gateway.devices.watch import BackOff, Watch
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Estimator
from sensor_gateway.perceiver import Perceiver

PATIENCE_S = 0.1
"""Longest single wait for a picture, and so the longest delay of a stop."""

REMINDER_NS = SECOND_NS
"""Interval at which a lost camera is reported again."""

Captured = Picture | str | None
"""A usable picture, or the reason why the camera gives none, or None while waiting."""


class CameraSource:
    """Yields images and skeletons of a camera; while it is lost, invalid skeletons with the reason.

    A device, a stream or a file that cannot be read, or whose pictures are frozen or stay black, is opened again after
    increasing waits. The end of a file ends the source.
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
        now_ns: Callable[[], int] = steady_clock.now_ns,
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
        """Yield images and their skeletons; without a picture, empty frames, so that the source can be stopped."""
        with self._open_estimator() as estimator:
            perceiver = self._perceiver(estimator, self._optics, self._sensor, self._session_id, self.counters)
            for captured in self._captured():
                yield from self._messages(captured, perceiver)

    def _captured(self) -> Iterator[Captured]:
        """Yield the pictures of a camera that is opened again whenever it is lost."""
        back_off = BackOff()
        while True:
            capture = self._open_capture()
            try:
                for captured in self._watched(capture):
                    if isinstance(captured, Picture):
                        back_off.worked()
                        if capture.rate_hz is not None and math.isfinite(capture.rate_hz):
                            self.counters.details["rate_hz"] = f"{capture.rate_hz:g}"
                    yield captured
            except CaptureEndedError:
                return
            except CameraLostError as error:
                yield str(error)
            finally:
                capture.close()
            due_ns = self._now_ns() + back_off.failed()
            while (left_ns := due_ns - self._now_ns()) > 0:
                yield None
                self._pause(min(left_ns / SECOND_NS, PATIENCE_S))

    def _watched(self, capture: Capture) -> Iterator[Captured]:
        """Yield a capture's pictures until it is lost; frozen or black pictures count as lost unless from a file."""
        self._watch.opened()
        while True:
            picture = capture.next(PATIENCE_S)
            complaint = self._watch.complaint(picture) if picture is not None and capture.live else None
            if complaint is not None and self._watch.lost:
                raise CameraLostError(complaint)
            yield picture if complaint is None else complaint

    def _messages(self, captured: Captured, perceiver: Perceiver) -> Iterator[list[Message]]:
        if captured is None and self._reported is not None:
            captured = self._reported[0]
        if captured is None:
            yield []
        elif isinstance(captured, str):
            yield self._lost(captured, perceiver)
        else:
            if self._reported is not None:
                self._reported = None
                self.counters.state = State.RUNNING
            stamp_ns = self._rising(captured.stamp_ns)
            for message in perceiver.messages(replace(captured, stamp_ns=stamp_ns)):
                yield [message]

    def _lost(self, reason: str, perceiver: Perceiver) -> list[Message]:
        """Report that the camera is lost: a new reason at once, the same one every second."""
        now_ns = self._now_ns()
        if self._reported is None or self._reported[0] != reason:
            self.counters.reject("camera_lost", reason)
            self.counters.state = State.CAMERA_LOST.because(reason)
        elif now_ns - self._reported[1] < REMINDER_NS:
            return []
        self._reported = reason, now_ns
        return perceiver.lost(self._rising(now_ns), f"camera lost: {reason}")

    def _rising(self, stamp_ns: int) -> int:
        """Make a stamp rise: once the host's clock is set back, all later stamps are shifted by one constant."""
        self._shift_ns = max(self._shift_ns, self._newest_ns + 1 - stamp_ns)
        self._newest_ns = stamp_ns + self._shift_ns
        return self._newest_ns
