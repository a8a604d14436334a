"""The colour and depth streams of an OpenNI 2 device, paired into pictures by their stamps."""

import logging
import time
from collections import deque
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.devices.capture import CameraLostError
from sensor_gateway.devices.device_clock import DeviceClock
from sensor_gateway.devices.openni2_library import ERRORS
from sensor_gateway.lens import Lens

log = logging.getLogger("actum")

SIZE = 640, 480
"""Default width and height (px) of both images: Kinect v1, Xtion and Astra offer it."""
RATE_HZ = 30
"""Frame rate of both streams at that size."""
MICROSECOND_NS = 1000
TOGETHER_US = 17_000
"""Largest difference between the stamps of depth and colour of one picture, in microseconds: half a frame."""
WAITING = 4
"""Most frames of one stream that are kept to be paired with the other's."""
REST_S = 0.05
"""Delay between stopping and destroying a stream: the driver's thread may still use it for a frame's time."""

Frame = tuple[int, NDArray[Any]]
"""A frame's stamp (µs) and its pixels."""


def together(depths: deque[Frame], colors: deque[Frame]) -> tuple[NDArray[Any], Frame] | None:
    """Take the newest pair of a depth frame's pixels (height, width) and a colour frame with pixels (height, width, 3).

    The pair and all older frames are removed. None if no two frames have nearly the same stamp.
    """
    for color in reversed(colors):
        if depths and abs((depth := min(depths, key=lambda d: abs(d[0] - color[0])))[0] - color[0]) <= TOGETHER_US:
            _drop(depths, depth[0])
            _drop(colors, color[0])
            return depth[1], color
    return None


def _drop(frames: deque[Frame], until_us: int) -> None:
    while frames and frames[0][0] <= until_us:
        frames.popleft()


class Streams:
    """A device's colour and depth streams, started.

    Raises:
        CameraLostError: the device lacks a stream, or gives colour in an unsupported format.
    """

    def __init__(self, openni2: Any, device: Any, size: tuple[int, int], field_of_view_deg: float) -> None:
        self._openni2, self.device = openni2, device
        if not (device.has_sensor(openni2.SENSOR_DEPTH) and device.has_sensor(openni2.SENSOR_COLOR)):
            device.close()
            raise CameraLostError("the camera does not send both colour and depth images: use a camera that sends both")
        self._depth, self._color = device.create_depth_stream(), device.create_color_stream()
        self.uri: bytes = device.uri
        self._depths: deque[Frame] = deque(maxlen=WAITING)
        self._colors: deque[Frame] = deque(maxlen=WAITING)
        if not device.is_file():
            self._configure(size)
        self._mirrored = [stream for stream in (self._depth, self._color) if _is_mirrored(stream)]
        self._units_m = 1e-4 if self._is(self._depth, openni2.PIXEL_FORMAT_DEPTH_100_UM) else 1e-3
        self.lens = lens_of(self._color, field_of_view_deg)
        for stream in (self._depth, self._color):
            stream.start()

    def next(self, patience_s: float, clock: DeviceClock) -> tuple[bool, Picture | None]:
        """Return whether a frame came within `patience_s`, and the picture that it completed, or None."""
        stream = self._openni2.wait_for_any_stream([self._depth, self._color], patience_s)
        if stream is None:
            return False, None
        frame = stream.read_frame()
        frames = self._depths if stream is self._depth else self._colors
        rows = np.frombuffer(frame.get_buffer_as_uint8(), np.uint8).reshape(frame.height, frame.stride)
        pixels: NDArray[Any]
        if stream is self._depth:
            pixels = rows[:, : 2 * frame.width].view(np.uint16)
        elif self._is(stream, self._openni2.PIXEL_FORMAT_RGB888):
            pixels = rows[:, : 3 * frame.width].reshape(frame.height, frame.width, 3)
        else:
            raise CameraLostError(
                f"the camera sends colour images in the format {stream.video_mode.pixelFormat!r}, but actum reads only "
                "RGB888: use another driver"
            )
        frames.append((frame.timestamp, (pixels[:, ::-1] if stream in self._mirrored else pixels).copy()))
        frame.close()
        return True, self._together(clock)

    def close(self) -> None:
        """Release the device after a delay, as the driver's own thread reads the streams without a lock."""
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
        """Ask a camera for one image size, no mirroring, depth registered to colour and synchronised with it."""
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
            log.warning(
                "the camera driver does not align depth images with colour images, so joints of thin limbs may appear "
                "as far away as the background: use a driver with depth-to-colour registration"
            )

    def _is(self, stream: Any, pixel_format: Any) -> bool:
        return bool(stream.video_mode.pixelFormat == pixel_format)


def lens_of(color: Any, field_of_view_deg: float) -> Lens:
    """Compute the intrinsics from the fields of view that the driver reports, or else from the assumed one.

    Drivers report the same values for all devices of a model, so both count as assumed.
    """
    width, height = color.video_mode.resolutionX, color.video_mode.resolutionY
    try:
        across, down = color.get_horizontal_fov(), color.get_vertical_fov()
    except ERRORS:
        return Lens.of_field_of_view(width, height, field_of_view_deg)
    focal_px = width / 2 / np.tan(across / 2), height / 2 / np.tan(down / 2)
    matrix = np.array([[focal_px[0], 0, (width - 1) / 2], [0, focal_px[1], (height - 1) / 2], [0, 0, 1]])
    return Lens(matrix, np.zeros(5), assumed=True)


def _is_mirrored(stream: Any) -> bool:
    """Whether a stream's images have left and right exchanged."""
    try:
        return bool(stream.get_mirroring_enabled())
    except ERRORS:
        return False


def _choose_mode(stream: Any, size: tuple[int, int], pixel_format: Any) -> None:
    """Set the wanted mode if the sensor has it; otherwise the driver's default stays."""
    wanted = (*size, RATE_HZ, int(pixel_format))
    for mode in stream.get_sensor_info().videoModes:
        if (mode.resolutionX, mode.resolutionY, mode.fps, int(mode.pixelFormat)) == wanted:
            stream.set_video_mode(mode)
            return
