"""Where pictures come from: a device or a stream, newest first, or a video file at its own pace."""

import threading
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Protocol

import cv2
import numpy as np

from actum.joining import PAUSE_NS
from sensor_gateway.camera.video import Picture, VideoError, pictures_of

SILENT_S = 2.0
"""How long a device may take for a picture before it counts as lost …"""

OPENING_S = 10.0
"""… and for its first one."""


CLOSING_S = 0.5

COMPRESSED = cv2.VideoWriter.fourcc(*"MJPG")
"""Asked for with a size: uncompressed, few devices give a large one at more than some frames/s."""


class CameraLostError(Exception):
    """There are no more pictures: why."""


class CaptureEndedError(Exception):
    """A video file has been played to its end."""


class Capture(Protocol):
    """Something that gives pictures; one that is not live gives those of a file."""

    @property
    def live(self) -> bool:
        """Whether a sensor's noise is to be expected in them."""
        ...

    def next(self, patience_s: float) -> Picture | None:
        """Return the next picture, or None where there is none within so long.

        Raises:
            CameraLostError: there will be none.
            CaptureEndedError: the file is over.
        """
        ...

    def close(self) -> None:
        """Let go of the camera."""
        ...


class LiveCapture:
    """A device or a stream: a thread reads all it gives and keeps the newest picture only, stamped as it is read."""

    live = True

    def __init__(self, device: int | str, size: tuple[int, int] | None = None) -> None:
        self._device, self._size = device, size
        self._changed = threading.Condition()
        self._newest: Picture | None = None
        self._lost: str | None = None
        self._closed = False
        self._heard_s = time.monotonic()
        self._allowed_s = OPENING_S
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last, or None.

        Raises:
            CameraLostError: the device cannot be opened, has stopped, or has been silent for too long.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None or self._lost is not None, patience_s)
            picture, self._newest = self._newest, None
            if picture is not None:
                return picture
            if self._lost is not None:
                raise CameraLostError(self._lost)
            if time.monotonic() - self._heard_s > self._allowed_s:
                raise CameraLostError(f"no picture for {self._allowed_s:g} s")
            return None

    @property
    def over(self) -> bool:
        """Whether no further picture will come."""
        return self._lost is not None

    def close(self) -> None:
        """Have the thread end; one that the driver holds up ends when that lets go.

        At the interpreter's end it must not be within OpenCV: it would take the process with it.
        """
        self._closed = True
        self._thread.join(CLOSING_S)

    def _read(self) -> None:
        capture = self._opened()
        try:
            reason = self._read_all(capture)
        except cv2.error as error:
            reason = f"OpenCV says: {error}"
        finally:
            capture.release()
        self._lose(reason)

    def _read_all(self, capture: cv2.VideoCapture) -> str:
        """Keep the newest picture until there are no more, and return why."""
        if not capture.isOpened():
            return "it cannot be opened"
        while not self._closed:
            done, image = capture.read()
            if not done:
                return "it gives no more pictures"
            self._keep(Picture(image.astype(np.uint8, copy=False), time.time_ns()))
        return "it was closed"

    def _opened(self) -> cv2.VideoCapture:
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # what fails is said in status, once
        capture = cv2.VideoCapture(self._device, cv2.CAP_ANY, patience_with(self._device))
        if self._size is not None:
            capture.set(cv2.CAP_PROP_FOURCC, COMPRESSED)
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, self._size[0])
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self._size[1])
        capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        return capture

    def _keep(self, picture: Picture) -> None:
        with self._changed:
            self._newest = picture
            self._heard_s, self._allowed_s = time.monotonic(), SILENT_S
            self._changed.notify_all()

    def _lose(self, reason: str) -> None:
        with self._changed:
            self._lost = reason
            self._changed.notify_all()


def patience_with(device: int | str) -> list[int]:
    """Return what OpenCV is told of time: to give a silent stream up as we do, for one that opens holds up all others.

    Other than streams take no such parameters.
    """
    if isinstance(device, int) or "://" not in device:
        return []
    limit_ms = round(1000 * OPENING_S)
    return [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, limit_ms, cv2.CAP_PROP_READ_TIMEOUT_MSEC, limit_ms]


class FileCapture:
    """A file of pictures played once or for ever, each when it is due; none is left out, however late.

    `read` yields the file's pictures, the first with the stamp that it is given.
    """

    live = False

    def __init__(
        self,
        path: Path,
        now_ns: Callable[[], int] = time.time_ns,
        read: Callable[[Path, int], Generator[Picture, None, None]] = pictures_of,
        pause: Callable[[float], None] = time.sleep,
        loop: bool = False,
    ) -> None:
        self._path, self._read, self._loop = path, read, loop
        self._now_ns, self._pause = now_ns, pause
        self._pictures = read(path, now_ns())
        self._waiting: Picture | None = None

    def next(self, patience_s: float) -> Picture | None:
        """Return the next picture once it is due.

        Raises:
            CameraLostError: the file is no video.
            CaptureEndedError: it is over.
        """
        try:
            self._waiting = self._waiting or self._following()
        except VideoError as error:
            raise CameraLostError(str(error)) from None
        ahead_s = (self._waiting.stamp_ns - self._now_ns()) / 1e9
        if ahead_s > 0:
            self._pause(min(ahead_s, patience_s))
            if ahead_s > patience_s:
                return None
        picture, self._waiting = self._waiting, None
        return picture

    def _following(self) -> Picture:
        following = next(self._pictures, None)
        if following is None and self._loop:
            self._pictures = self._read(self._path, self._now_ns() + PAUSE_NS)
            following = next(self._pictures, None)
        if following is None:
            raise CaptureEndedError(str(self._path))
        return following

    def close(self) -> None:
        """Let go of the file."""
        self._pictures.close()


def capture_of(camera: str, size: tuple[int, int] | None, loop: bool = False) -> Capture:
    """Open what a setting names: a file that is there, a device's number or path, or a URL."""
    path = Path(camera)
    if path.is_file():
        return FileCapture(path, loop=loop)
    return LiveCapture(int(camera) if camera.isdecimal() else camera, size)
