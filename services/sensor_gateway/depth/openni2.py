"""Cameras that OpenNI 2 has a driver for (Kinect v1, Xtion, Astra), and its recordings, by its Python bindings."""

import logging
import os
import time
from collections import deque
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sensor_gateway.camera.capture import CameraLostError
from sensor_gateway.camera.lens import Lens
from sensor_gateway.camera.video import Picture, VideoError
from sensor_gateway.depth.clock import DeviceClock
from sensor_gateway.depth.openni2_library import errors, library, said
from sensor_gateway.depth.picture import DepthPicture
from sensor_gateway.depth.silence import Silence

log = logging.getLogger("actum")

ERRORS = errors()
FILE_ERRORS: tuple[type[Exception], ...] = (*ERRORS, CameraLostError)
SIZE = 640, 480
RATE_HZ = 30
MICROSECOND_NS = 1000
TOGETHER_US = 17_000
"""How far apart depth and colour may be captured and still be one picture: half a frame."""

WAITING = 4
"""How many frames of one stream wait for those of the other."""

MANUAL = -1.0
END_S = 0.5
"""How long a recording may be silent until it is over."""

REST_S = 0.05
"""How long a stopped stream is left alone before it is destroyed: drivers sleep a frame between looks at it."""


class OpenNi2Capture:
    """The first camera found; the newest pair of colour and registered depth, stamped by the device."""

    live = True

    def __init__(
        self,
        size: tuple[int, int] | None = None,
        field_of_view_deg: float = 60.0,
        now_ns: Callable[[], int] = time.time_ns,
    ) -> None:
        self._openni2 = library()
        self._size, self._field_of_view_deg = size or SIZE, field_of_view_deg
        self._clock = DeviceClock(now_ns)
        self._streams: Streams | None = None
        self._silence = Silence()

    def next(self, patience_s: float) -> Picture | None:
        """Return a picture newer than the last, or None.

        Raises:
            CameraLostError: there is no camera, it cannot be used, was unplugged, or has been silent for too long.
        """
        try:
            self._streams = self._streams or self._opened()
            heard, picture = self._streams.next(patience_s, self._clock)
            if not heard:
                self._check_connected(self._streams.uri)
        except ERRORS as error:
            raise CameraLostError(f"OpenNI says: {said(error)}") from None
        self._silence.passed(picture is not None)
        return picture

    def close(self) -> None:
        """Let go of the camera."""
        streams, self._streams = self._streams, None
        if streams is not None:
            streams.close()

    def _opened(self) -> "Streams":
        if not self._openni2.Device.enumerate_uris():
            raise CameraLostError("no camera is connected that OpenNI 2 has a driver for")
        device = self._openni2.Device(None)
        return Streams(self._openni2, device, self._size, self._field_of_view_deg)

    def _check_connected(self, uri: bytes) -> None:
        if uri not in self._openni2.Device.enumerate_uris():
            raise CameraLostError(f"{uri.decode(errors='replace')} was unplugged")


def recorded_pictures(path: Path, start_ns: int, field_of_view_deg: float = 60.0) -> Generator[Picture, None, None]:
    """Yield a recording's pictures; the first is stamped `start_ns`, the others by the device's times.

    Raises:
        VideoError: it is no recording of colour and depth.
    """
    openni2 = library()
    clock = DeviceClock(lambda: start_ns)
    try:
        streams = Streams(openni2, _opened_file(openni2, path), SIZE, field_of_view_deg)
    except FILE_ERRORS as error:
        raise VideoError(f"{path}: no recording of colour and depth that OpenNI can play ({said(error)})") from None
    try:
        heard, some = True, False
        while heard:
            heard, picture = streams.next(END_S, clock)
            if picture is not None:
                some = True
                yield picture
        if not some:
            raise VideoError(f"{path}: the recording has no colour and depth of the same time; record both streams")
    finally:
        streams.close()


def _opened_file(openni2: Any, path: Path) -> Any:
    """Open a recording that is read once, as fast as it is asked for."""
    device = openni2.Device(os.fsencode(path.absolute()))
    if device.playback is None:
        device.close()
        raise CameraLostError("another driver took it")
    device.playback.set_repeat_enabled(False)
    device.playback.set_speed(MANUAL)
    return device


Frame = tuple[int, NDArray[Any]]
"""When a frame was captured (us), and its pixels."""


def together(depths: deque[Frame], colors: deque[Frame]) -> tuple[NDArray[Any], Frame] | None:
    """Take the newest colour out for which there is depth of its time, with that depth; all older frames go too."""
    for color in reversed(colors):
        if depths and abs((depth := min(depths, key=lambda d: abs(d[0] - color[0])))[0] - color[0]) <= TOGETHER_US:
            _forget(depths, depth[0])
            _forget(colors, color[0])
            return depth[1], color
    return None


def _forget(frames: deque[Frame], until_us: int) -> None:
    while frames and frames[0][0] <= until_us:
        frames.popleft()


class Streams:
    """A device's colour and depth.

    Raises:
        CameraLostError: it lacks one, or gives colour of a kind that is not understood.
    """

    def __init__(self, openni2: Any, device: Any, size: tuple[int, int], field_of_view_deg: float) -> None:
        self._openni2, self.device = openni2, device
        if not (device.has_sensor(openni2.SENSOR_DEPTH) and device.has_sensor(openni2.SENSOR_COLOR)):
            device.close()
            raise CameraLostError("the device has no colour and depth")
        self._depth, self._color = device.create_depth_stream(), device.create_color_stream()
        self.uri: bytes = device.uri
        self._depths: deque[Frame] = deque(maxlen=WAITING)
        self._colors: deque[Frame] = deque(maxlen=WAITING)
        if not device.is_file():
            self._configure(size)
        self._mirrored = [stream for stream in (self._depth, self._color) if stream_is_mirrored(stream)]
        self._units_m = 1e-4 if self._is(self._depth, openni2.PIXEL_FORMAT_DEPTH_100_UM) else 1e-3
        self.lens = lens_of(self._color, field_of_view_deg)
        for stream in (self._depth, self._color):
            stream.start()

    def next(self, patience_s: float, clock: DeviceClock) -> tuple[bool, Picture | None]:
        """Return whether a stream was heard within so long, and the picture that this completed."""
        stream = self._openni2.wait_for_any_stream([self._depth, self._color], patience_s)
        if stream is None:
            return False, None
        frame = stream.read_frame()
        frames = self._depths if stream is self._depth else self._colors
        frames.append((frame.timestamp, self._pixels(stream, frame)))
        frame.close()
        return True, self._together(clock)

    def close(self) -> None:
        """Let go of the device, once the driver's own thread rests: it looks at its streams without a lock."""
        for stream in (self._depth, self._color):
            stream.stop()
        time.sleep(REST_S)
        for part in (self._depth, self._color, self.device):
            part.close()

    def _together(self, clock: DeviceClock) -> Picture | None:
        pair = together(self._depths, self._colors)
        if pair is None:
            return None
        depth, (color_us, color) = pair
        if depth.shape != color.shape[:2]:
            depth = cv2.resize(depth, (color.shape[1], color.shape[0]), interpolation=cv2.INTER_NEAREST)
        return DepthPicture(
            image_bgr=np.asarray(cv2.cvtColor(color, cv2.COLOR_RGB2BGR), dtype=np.uint8),
            stamp_ns=clock.stamp_ns(color_us * MICROSECOND_NS),
            depth_m=depth * np.float32(self._units_m),
            lens=self.lens,
        )

    def _configure(self, size: tuple[int, int]) -> None:
        """Ask a camera for one size, unmirrored, depth registered to colour, both at the same times."""
        openni2, registered = self._openni2, self._openni2.IMAGE_REGISTRATION_DEPTH_TO_COLOR
        _choose_mode(self._depth, size, openni2.PIXEL_FORMAT_DEPTH_1_MM)
        _choose_mode(self._color, size, openni2.PIXEL_FORMAT_RGB888)
        for stream in (self._depth, self._color):
            if stream.is_property_supported(openni2.c_api.ONI_STREAM_PROPERTY_MIRRORING):
                stream.set_mirroring_enabled(False)
        if self.device.is_image_registration_mode_supported(registered):
            self.device.set_image_registration_mode(registered)
            self.device.set_depth_color_sync_enabled(True)
        else:
            log.warning("the driver does not register depth to colour: thin limbs may get the depth beside them")

    def _pixels(self, stream: Any, frame: Any) -> NDArray[Any]:
        """Copy a frame's pixels, unmirrored: (height, width) of depth, (height, width, 3) of colour."""
        rows = np.frombuffer(frame.get_buffer_as_uint8(), np.uint8).reshape(frame.height, frame.stride)
        pixels: NDArray[Any]
        if stream is self._depth:
            pixels = rows[:, : 2 * frame.width].view(np.uint16)
        elif self._is(stream, self._openni2.PIXEL_FORMAT_RGB888):
            pixels = rows[:, : 3 * frame.width].reshape(frame.height, frame.width, 3)
        else:
            raise CameraLostError(f"colour comes as {stream.video_mode.pixelFormat!r}, not as RGB888")
        return (pixels[:, ::-1] if stream in self._mirrored else pixels).copy()

    def _is(self, stream: Any, pixel_format: Any) -> bool:
        return bool(stream.video_mode.pixelFormat == pixel_format)


def lens_of(color: Any, field_of_view_deg: float) -> Lens:
    """Return the lens that the driver tells for a stream, the same for all devices of a kind, or else assume one."""
    width, height = color.video_mode.resolutionX, color.video_mode.resolutionY
    try:
        across, down = color.get_horizontal_fov(), color.get_vertical_fov()
    except ERRORS:
        return Lens.of_field_of_view(width, height, field_of_view_deg)
    focal_px = width / 2 / np.tan(across / 2), height / 2 / np.tan(down / 2)
    matrix = np.array([[focal_px[0], 0, (width - 1) / 2], [0, focal_px[1], (height - 1) / 2], [0, 0, 1]])
    return Lens(matrix, np.zeros(5), assumed=True)


def stream_is_mirrored(stream: Any) -> bool:
    """Whether a stream's images have left and right exchanged."""
    try:
        return bool(stream.get_mirroring_enabled())
    except ERRORS:
        return False


def _choose_mode(stream: Any, size: tuple[int, int], pixel_format: Any) -> None:
    """Set the wanted mode where the sensor has it; else it stays as the driver would have it."""
    wanted = (*size, RATE_HZ, int(pixel_format))
    for mode in stream.get_sensor_info().videoModes:
        if (mode.resolutionX, mode.resolutionY, mode.fps, int(mode.pixelFormat)) == wanted:
            stream.set_video_mode(mode)
            return
