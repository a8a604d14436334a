"""A camera or a network stream that OpenCV reads; only the newest picture is kept."""

import sys
import threading
from pathlib import Path

import cv2
import numpy as np

from actum import steady_clock
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.silence import OPENING_S, Silence

CLOSING_S = 0.5
"""Longest wait of `close` for the reading thread: a driver that hangs must not block the service."""
COMPRESSED = cv2.VideoWriter.fourcc(*"MJPG")
"""Pixel format that is requested with a size: few devices give large uncompressed images at more than some Hz."""
LISTED = Path("/sys/class/video4linux")
"""Linux's folder with a folder for each video device: its name, and its index among those of one camera."""


class LiveCapture:
    """A device or a stream: a thread reads every picture and keeps only the newest, stamped as it is read."""

    live = True

    def __init__(self, device: int | str, size: tuple[int, int] | None = None) -> None:
        self._device, self._size = device, size
        self._changed = threading.Condition()
        self._newest: Picture | None = None
        self._lost: str | None = None
        self._closed = False
        self._silence = Silence()
        self.rate_hz: float | None = None
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last, or None if none comes within `patience_s`.

        Raises:
            CameraLostError: the device cannot be opened, has stopped, or has been silent for too long.
        """
        with self._changed:
            self._changed.wait_for(lambda: self._newest is not None or self._lost is not None, patience_s)
            picture, self._newest = self._newest, None
            if picture is None and self._lost is not None:
                raise CameraLostError(self._lost)
            if picture is None:
                self._silence.check()
            return picture

    @property
    def over(self) -> bool:
        """Whether no further picture will come."""
        return self._lost is not None

    def close(self) -> None:
        """Stop the reading thread; if the driver blocks it, it ends as soon as the driver returns.

        At the interpreter's end the thread must not be inside OpenCV, where it would crash the process.
        """
        self._closed = True
        self._thread.join(CLOSING_S)

    def _read(self) -> None:
        try:
            capture = self._opened()
            try:
                reason = self._read_all(capture)
            finally:
                capture.release()
        except cv2.error as error:
            reason = f"OpenCV says: {error}"
        with self._changed:
            self._lost = reason
            self._changed.notify_all()

    def _read_all(self, capture: cv2.VideoCapture) -> str:
        """Keep the newest picture until no more come, and return the reason."""
        if not capture.isOpened():
            there = present_cameras() if isinstance(self._device, int) or self._device.startswith("/dev/") else None
            return "it cannot be opened" if there is None else f"it cannot be opened: {there}"
        while not self._closed:
            done, image = capture.read()
            if not done:
                return "it gives no more pictures"
            picture = Picture(image.astype(np.uint8, copy=False), steady_clock.now_ns())
            with self._changed:
                self._newest = picture
                self._silence.heard()
                self._changed.notify_all()
        return "it was closed"

    def _opened(self) -> cv2.VideoCapture:
        cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)  # what fails is said in status, once
        capture = cv2.VideoCapture(self._device, cv2.CAP_ANY, timeouts_of(self._device))
        if self._size is not None:
            capture.set(cv2.CAP_PROP_FOURCC, COMPRESSED)
            capture.set(cv2.CAP_PROP_FRAME_WIDTH, self._size[0])
            capture.set(cv2.CAP_PROP_FRAME_HEIGHT, self._size[1])
        capture.set(cv2.CAP_PROP_BUFFERSIZE, 1)
        self.rate_hz = capture.get(cv2.CAP_PROP_FPS) or None
        return capture


def timeouts_of(device: int | str) -> list[int]:
    """Return OpenCV's parameters (name, ms, …) that give a silent stream the timeouts of `Silence`.

    Without them a stream that hangs while opening would block all others. Devices take no such parameters.
    """
    if isinstance(device, int) or "://" not in device:
        return []
    limit_ms = round(1000 * OPENING_S)
    return [cv2.CAP_PROP_OPEN_TIMEOUT_MSEC, limit_ms, cv2.CAP_PROP_READ_TIMEOUT_MSEC, limit_ms]


def present_cameras(listed: Path = LISTED) -> str | None:
    """Return this machine's cameras in words, by the numbers that `--camera` takes; None where none can be listed."""
    if not sys.platform.startswith("linux"):
        return None
    numbered = {int(path.name.removeprefix("video")): path for path in listed.glob("video[0-9]*")}
    cameras = [
        f"{number} ({_text(path / 'name')})"
        for number, path in sorted(numbered.items())
        if _text(path / "index") == "0"  # the others give no pictures, but what belongs to them
    ]
    return f"the cameras here are {', '.join(cameras)}" if cameras else "this machine has no camera"


def _text(file: Path) -> str:
    try:
        return file.read_text(errors="replace").strip()
    except OSError:
        return ""
