"""Cameras that OpenNI 2 has a driver for (Kinect v1, Xtion, Astra), and OpenNI 2's recordings."""

import os
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

from actum import steady_clock
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.device_clock import DeviceClock
from sensor_gateway.devices.openni2_library import ERRORS, error_text, library
from sensor_gateway.devices.openni2_streams import SIZE, Streams
from sensor_gateway.devices.silence import Silence
from sensor_gateway.devices.video import VideoError

FILE_ERRORS: tuple[type[Exception], ...] = (*ERRORS, CameraLostError)
"""Errors raised when the file to open is no recording or lacks a stream."""
MANUAL = -1.0
"""OpenNI's playback speed at which each frame is read on request."""
END_S = 0.5
"""Seconds without a frame after which a recording counts as ended: OpenNI does not report the end."""


class OpenNi2Capture:
    """The first connected camera; gives the newest pair of colour and registered depth, stamped by the device."""

    live = True
    rate_hz: float | None = None

    def __init__(
        self,
        size: tuple[int, int] | None = None,
        field_of_view_deg: float = 60.0,
        now_ns: Callable[[], int] = steady_clock.now_ns,
    ) -> None:
        self._openni2 = library()
        self._size, self._field_of_view_deg = size or SIZE, field_of_view_deg
        self._clock = DeviceClock(now_ns)
        self._streams: Streams | None = None
        self._silence = Silence()

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last, or None if none comes within `patience_s`.

        Raises:
            CameraLostError: there is no camera, it cannot be used, was unplugged, or has been silent for too long.
        """
        try:
            self._streams = self._streams or self._opened()
            has_frame, picture = self._streams.next(patience_s, self._clock)
            if not has_frame and self._streams.uri not in self._openni2.Device.enumerate_uris():
                raise CameraLostError(f"{self._streams.uri.decode(errors='replace')} was unplugged")
        except ERRORS as error:
            raise CameraLostError(f"OpenNI says: {error_text(error)}") from None
        if picture is None:
            self._silence.check()
        else:
            self._silence.heard()
        return picture

    def close(self) -> None:
        """Release the camera."""
        streams, self._streams = self._streams, None
        if streams is not None:
            streams.close()

    def _opened(self) -> Streams:
        if not self._openni2.Device.enumerate_uris():
            raise CameraLostError("no camera that OpenNI 2 supports is connected: plug one in")
        device = self._openni2.Device(None)
        return Streams(self._openni2, device, self._size, self._field_of_view_deg)


def recorded_pictures(path: Path, start_ns: int, field_of_view_deg: float = 60.0) -> Generator[Picture, None, None]:
    """Yield a recording's pictures; the first is stamped `start_ns`, later ones keep the device's intervals.

    Raises:
        VideoError: the file is no recording of colour and depth.
    """
    openni2 = library()
    clock = DeviceClock(lambda: start_ns)
    try:
        streams = Streams(openni2, _opened_file(openni2, path), SIZE, field_of_view_deg)
    except FILE_ERRORS as error:
        raise VideoError(
            f"{path} is not a recording of colour and depth that OpenNI can play ({error_text(error)}): give "
            "another --path"
        ) from None
    try:
        has_frame, has_picture = True, False
        while has_frame:
            has_frame, picture = streams.next(END_S, clock)
            if picture is not None:
                has_picture = True
                yield picture
        if not has_picture:
            raise VideoError(f"{path} contains no colour image and depth image of the same time: record both streams")
    finally:
        streams.close()


def _opened_file(openni2: Any, path: Path) -> Any:
    """Open a recording to be read once, each frame on request."""
    device = openni2.Device(os.fsencode(path.absolute()))
    if device.playback is None:
        device.close()
        raise CameraLostError(
            "OpenNI cannot play the file, because another driver in OpenNI's driver folder treats the file as a "
            "camera: remove that driver from the folder"
        )
    device.playback.set_repeat_enabled(False)
    device.playback.set_speed(MANUAL)
    return device
