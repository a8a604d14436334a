"""A webcam, a stream or a video file as a sensor."""

import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path

from actum.calibration import Calibration, CalibrationError
from actum.messages import Message
from actum.node import SECOND_NS, Counters
from sensor_gateway.camera.bodies import Estimator
from sensor_gateway.camera.capture import CameraLostError, Capture, CaptureEndedError, capture_of
from sensor_gateway.camera.perceiving import SAME_CAMERA, Optics, Perceiver
from sensor_gateway.camera.pose import PoseEstimator
from sensor_gateway.camera.video import Picture
from sensor_gateway.camera.watch import BackOff, Watch
from sensor_gateway.settings import Settings

PATIENCE_S = 0.1
"""How long one look for a picture may take, and so a stop."""

REMINDER_NS = SECOND_NS
"""How often it is said again that the camera is lost."""

Seen = Picture | str | None
"""A usable picture, why there is none, or that it only takes longer."""


def optics_of(settings: Settings) -> Optics:
    """Say what the settings tell of the camera.

    Raises:
        CalibrationError: the calibration file is missing, no calibration, or that of a camera beside this one.
    """
    calibration = None if settings.calibration is None else _own_calibration(settings.calibration)
    return Optics(settings.field_of_view_deg, calibration, settings.person_height_m, settings.mirrored)


def _own_calibration(path: Path) -> Calibration:
    calibration = Calibration.load(path)
    if calibration.skeleton_from_image not in (None, SAME_CAMERA):
        raise CalibrationError(
            f"{path}: it has a skeleton_from_image, so it is for a camera beside the one that sees people, and this "
            "camera sees the people itself: use its own file of 'actum calibrate intrinsics'; the other is --source "
            "marker-camera"
        )
    return calibration


def estimator_of(settings: Settings) -> PoseEstimator:
    """Open the pose model.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
    """
    return PoseEstimator(settings.pose_model, settings.people)


def camera_of(settings: Settings, start_ns: int) -> "CameraSource":
    """Build the source that the settings describe.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
        CalibrationError: the calibration file is missing, no calibration, or that of a camera beside this one.
    """
    with estimator_of(settings):
        pass  # what is wrong with the model is said before anything is served
    source = CameraSource(
        lambda: estimator_of(settings),
        optics_of(settings),
        open_capture=lambda: capture_of(settings.camera, size_of(settings), settings.loop),
        sensor=settings.sensor,
        session_id=f"camera-{start_ns}",
    )
    source.counters.details["model"] = settings.pose_model.name
    return source


def size_of(settings: Settings) -> tuple[int, int] | None:
    """Return the width and the height to ask a device for, where they are set."""
    if settings.camera_size is None:
        return None
    width, _, height = settings.camera_size.partition("x")
    return int(width), int(height)


class CameraSource:
    """Images and skeletons of a camera; while it is lost, skeletons that say so, and attempts to get it back.

    A device, a stream or a file that cannot be read is opened again and again, later and later; one whose pictures
    have frozen or stay black too. A file that is over ends the source.
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
        self._said: tuple[str, int] | None = None

    def frames(self) -> Iterator[list[Message]]:
        """Yield an image, then the skeletons seen in it; nothing now and then, so that the source can be stopped."""
        with self._open_estimator() as estimator:
            perceiver = self._perceiver(estimator, self._optics, self._sensor, self._session_id, self.counters)
            for seen in self._all_seen():
                yield from self._of(seen, perceiver)

    def _all_seen(self) -> Iterator[Seen]:
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

    def _of(self, seen: Seen, perceiver: Perceiver) -> Iterator[list[Message]]:
        if seen is None and self._said is not None:
            seen = self._said[0]
        if seen is None:
            yield []
        elif isinstance(seen, str):
            yield self._without(seen, perceiver)
        else:
            self._found()
            stamp_ns = self._rising(seen.stamp_ns)
            for message in perceiver.messages(replace(seen, stamp_ns=stamp_ns)):
                yield [message]

    def _without(self, reason: str, perceiver: Perceiver) -> list[Message]:
        """Say at once that there is nothing to see, and again every second."""
        now_ns = self._now_ns()
        if self._said is None or self._said[0] != reason:
            self.counters.reject("camera_lost", reason)
            self.counters.state = f"camera lost: {reason}"
        elif now_ns - self._said[1] < REMINDER_NS:
            return []
        self._said = reason, now_ns
        return perceiver.lost(self._rising(now_ns), f"camera lost: {reason}")

    def _found(self) -> None:
        if self._said is not None:
            self._said = None
            self.counters.state = "running"

    def _rising(self, stamp_ns: int) -> int:
        """Keep stamps rising where the clock is set back, and the time between them right after that."""
        self._shift_ns = max(self._shift_ns, self._newest_ns + 1 - stamp_ns)
        self._newest_ns = stamp_ns + self._shift_ns
        return self._newest_ns
