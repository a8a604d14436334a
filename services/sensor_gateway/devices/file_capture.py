"""A file of pictures, played at its own pace."""

import time
from collections.abc import Callable, Generator
from pathlib import Path

from actum import steady_clock
from actum.joining import PAUSE_NS
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError, CaptureEndedError
from sensor_gateway.devices.video import VideoError, pictures_of


class FileCapture:
    """Plays a file of pictures once or for ever, each when its stamp is due; late pictures are not dropped.

    `read` yields the file's pictures; the stamp of the first is its second argument (ns).
    """

    live = False
    rate_hz: float | None = None

    def __init__(
        self,
        path: Path,
        now_ns: Callable[[], int] = steady_clock.now_ns,
        read: Callable[[Path, int], Generator[Picture, None, None]] = pictures_of,
        pause: Callable[[float], None] = time.sleep,
        loop: bool = False,
    ) -> None:
        self._path, self._read, self._loop = path, read, loop
        self._now_ns, self._pause = now_ns, pause
        self._pictures = read(path, now_ns())
        self._pending: Picture | None = None

    def next(self, patience_s: float) -> Picture | None:
        """Return the next picture once it is due.

        Raises:
            CameraLostError: the file is no video.
            CaptureEndedError: the file has been played to its end.
        """
        try:
            self._pending = self._pending or self._read_next()
        except VideoError as error:
            raise CameraLostError(str(error)) from None
        ahead_s = (self._pending.stamp_ns - self._now_ns()) / 1e9
        if ahead_s > 0:
            self._pause(min(ahead_s, patience_s))
            if ahead_s > patience_s:
                return None
        picture, self._pending = self._pending, None
        return picture

    def _read_next(self) -> Picture:
        picture = next(self._pictures, None)
        if picture is None and self._loop:
            self._pictures = self._read(self._path, self._now_ns() + PAUSE_NS)
            picture = next(self._pictures, None)
        if picture is None:
            raise CaptureEndedError(str(self._path))
        return picture

    def close(self) -> None:
        """Close the file."""
        self._pictures.close()
