"""A person of known geometry before librealsense's own software device: a depth camera beside a colour camera."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rendered_bodies import Person, depth_of
from sensor_gateway.lens import Lens
from sensor_gateway.people.landmarks import Landmarks

WIDTH, HEIGHT = 640, 480
COLOR_LENS = Lens(np.array([[610.0, 0, 322.0], [0, 608.0, 238.0], [0, 0, 1]]), np.zeros(5), assumed=False)
DEPTH_LENS = Lens(np.array([[520.0, 0, 317.0], [0, 520.0, 241.0], [0, 0, 1]]), np.zeros(5), assumed=False)
COLOR_FROM_DEPTH_M = np.array([0.05, 0.002, -0.003])
UNITS_M = 0.001
PERIOD_MS = 1000 / 30


class Known:
    """An estimator that always sees the same people."""

    def __init__(self, *people: Landmarks) -> None:
        self._people = list(people)

    def __enter__(self) -> "Known":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def people(self, _image: NDArray[np.uint8], _stamp_ns: int) -> list[Landmarks]:
        return self._people


def depth_image(body: Person, width: int = WIDTH, height: int = HEIGHT) -> NDArray[np.uint16]:
    """Measure a person (camera frame of colour) from where the depth camera is."""
    there = Person({name: point - COLOR_FROM_DEPTH_M for name, point in body.points.items()}, body.thicker)
    return np.rint(depth_of(there, DEPTH_LENS, width, height) / UNITS_M).astype(np.uint16)


def color_image(number: int, form: str = "bgr8") -> NDArray[np.uint8]:
    """Paint a picture that tells its number: in blue, which is last where red is first."""
    image = np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8)
    image[..., 2 if form == "rgb8" else 0] = number
    return image


def intrinsics(rs: Any, lens: Lens, model: str = "brown_conrady") -> Any:
    told = rs.intrinsics()
    told.width, told.height = WIDTH, HEIGHT
    told.fx, told.fy, told.ppx, told.ppy = lens.matrix[0, 0], lens.matrix[1, 1], lens.matrix[0, 2], lens.matrix[1, 2]
    told.model, told.coeffs = getattr(rs.distortion, model), lens.distortion.tolist()
    return told


class SoftwareCamera:
    """The device: `recorded` writes what it shows to a file, `frame_sets` yields what librealsense makes of it."""

    def __init__(self, rs: Any, color_format: str = "bgr8") -> None:
        self._rs, self._format = rs, color_format
        self.device = rs.software_device()
        self.device.register_info(rs.camera_info.name, "Software camera")
        self.device.register_info(rs.camera_info.serial_number, "42")
        self._depth_sensor = self.device.add_sensor("Stereo Module")
        self._color_sensor = self.device.add_sensor("RGB Camera")
        self._depth = self._depth_sensor.add_video_stream(self._stream("depth", 0, "z16", 2, DEPTH_LENS))
        self._color = self._color_sensor.add_video_stream(self._stream("color", 1, color_format, 3, COLOR_LENS))
        self._depth_sensor.add_read_only_option(rs.option.depth_units, UNITS_M)
        offset = rs.extrinsics()
        offset.rotation, offset.translation = np.eye(3).ravel().tolist(), COLOR_FROM_DEPTH_M.tolist()
        self._depth.register_extrinsics_to(self._color, offset)
        self.device.create_matcher(rs.matchers.default)

    def frame_sets(self, body: Person, count: int) -> Iterator[Any]:
        """Show a person and yield the frames that belong together."""
        yield from self._shown(self.device, body, count)

    def recorded(self, body: Person, count: int, folder: Path) -> Path:
        """Show a person to librealsense's recorder; return the file, of the kind that this version writes."""
        for ending in (".bag", ".db3"):
            path = folder / f"recording{ending}"
            try:
                recorder = self._rs.recorder(str(path), self.device)
            except RuntimeError:
                continue
            list(self._shown(recorder, body, count))
            return path
        raise AssertionError("this librealsense records neither .bag nor .db3")

    def _shown(self, device: Any, body: Person, count: int) -> Iterator[Any]:
        syncer, sensors = self._rs.syncer(2 * count), device.query_sensors()
        for sensor in sensors:
            sensor.open(sensor.get_stream_profiles()[0])
            sensor.start(syncer)
        depth = depth_image(body)
        for number in range(count):
            self._put(self._depth_sensor, self._depth, number, depth)
            self._put(self._color_sensor, self._color, number, color_image(number, self._format))
            yield syncer.wait_for_frames(2000)
        for sensor in sensors:
            sensor.stop()
            sensor.close()

    def _put(self, sensor: Any, profile: Any, number: int, pixels: NDArray[Any]) -> None:
        frame = self._rs.software_video_frame()
        frame.pixels, frame.bpp = pixels, pixels[0, 0].nbytes
        frame.stride = WIDTH * frame.bpp
        frame.timestamp, frame.domain = number * PERIOD_MS, self._rs.timestamp_domain.hardware_clock
        frame.frame_number, frame.profile = number, profile.as_video_stream_profile()
        frame.depth_units = UNITS_M
        sensor.on_video_frame(frame)

    def _stream(self, kind: str, number: int, form: str, bytes_per_pixel: int, lens: Lens) -> Any:
        stream = self._rs.video_stream()
        stream.type, stream.index, stream.uid = getattr(self._rs.stream, kind), 0, number
        stream.width, stream.height, stream.fps, stream.bpp = WIDTH, HEIGHT, 30, bytes_per_pixel
        stream.fmt, stream.intrinsics = getattr(self._rs.format, form), intrinsics(self._rs, lens)
        return stream
