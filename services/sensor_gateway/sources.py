"""The source that the settings name."""

from collections.abc import Callable, Mapping
from pathlib import Path

from actum.calibration import Calibration
from actum.node import Source
from sensor_gateway.amended import AmendedSource, played_anew, tilted, without_image
from sensor_gateway.calibrated import CalibratedSource
from sensor_gateway.camera.beside import markers_camera_of
from sensor_gateway.camera.source import CameraSource, camera_of
from sensor_gateway.depth.source import openni2_of, realsense_of
from sensor_gateway.described import description
from sensor_gateway.recording_source import LoopedSource, RecordingSource
from sensor_gateway.settings import Settings

CAMERAS: Mapping[str, Callable[[Settings, int], CameraSource]] = {
    "camera": camera_of,
    "marker-camera": markers_camera_of,
    "realsense": realsense_of,
    "openni2": openni2_of,
}


class SourceError(ValueError):
    """The settings name no usable source."""


def source_of(settings: Settings, start_ns: int) -> Source:
    """Build the source; `start_ns` names its session.

    Raises:
        SourceError: no source is named, or a recording has no path.
        CalibrationError: the calibration file is missing or no calibration.
        PoseModelError: a camera's pose model is missing.
        DepthSourceError, RealSenseError, OpenNiError: a depth camera's library or recording is missing.
    """
    source = _calibrated(_named(settings, start_ns), settings.calibration)
    source.counters.details["source"] = description(settings)
    if not settings.images:
        source = AmendedSource(source, without_image)
    return source if settings.up_in_camera is None else AmendedSource(source, tilted(settings.up_in_camera))


def _calibrated(source: Source, calibration: Path | None) -> Source:
    if calibration is None or isinstance(source, CameraSource):
        return source
    return CalibratedSource(source, Calibration.load(calibration))


def _named(settings: Settings, start_ns: int) -> Source:
    if settings.source is None:
        raise SourceError("name a --source (ACTUM_SOURCE); the simulated scene is another service, scene_simulator")
    if settings.source != "recording":
        return CAMERAS[settings.source](settings, start_ns)
    if settings.path is None:
        raise SourceError("source recording needs --path (ACTUM_PATH): the file or folder to play")
    played = AmendedSource(RecordingSource(settings.path, settings.sensor), played_anew(f"{start_ns:x}"))
    return LoopedSource(played) if settings.loop else played
