"""Builds the source that the settings name."""

from collections.abc import Callable, Mapping
from pathlib import Path
from urllib.parse import urlsplit

from actum.calibration import Calibration
from actum.node import Source
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.cameras import camera_of, marker_camera_of, openni2_of, realsense_of
from sensor_gateway.devices.video import SUFFIXES
from sensor_gateway.mapped_source import MappedSource, with_calibration, with_session_of, with_up, without_image
from sensor_gateway.recording_source import LoopedSource, RecordingSource
from sensor_gateway.settings import Settings

CAMERAS: Mapping[str, Callable[[Settings, int], CameraSource]] = {
    "camera": camera_of,
    "marker-camera": marker_camera_of,
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
    if settings.source is None:
        raise SourceError(
            "no source is set: set --source (ACTUM_SOURCE) or, for a simulated scene, start scene_simulator"
        )
    if settings.source == "recording":
        source = _recording(settings, start_ns)
    else:
        source = CAMERAS[settings.source](settings, start_ns)
    source.counters.details["source"] = description(settings)
    if not settings.images:
        source = MappedSource(source, without_image)
    return source if settings.up_in_camera is None else MappedSource(source, with_up(settings.up_in_camera))


def _recording(settings: Settings, start_ns: int) -> Source:
    """Build the source of recordings; cameras calibrate their images themselves."""
    if settings.path is None:
        raise SourceError(
            "--source recording needs --path (ACTUM_PATH): give the recording to play, or a folder of recordings"
        )
    played = RecordingSource(settings.path, settings.sensor)
    source: Source = MappedSource(played, with_session_of(f"{start_ns:x}"))
    if settings.loop:
        source = LoopedSource(source)
    if settings.calibration is None:
        return source
    calibration = Calibration.load(settings.calibration)
    source.counters.details["calibration"] = calibration.id
    return MappedSource(source, with_calibration(calibration, source.counters))


def description(settings: Settings) -> str:
    """Describe the source for `info`, by which a user notices that the wrong file, folder or camera is read."""
    if settings.source in ("camera", "marker-camera"):
        kind, camera = settings.source.replace("-", " "), settings.camera
        if "://" in camera:
            parts = urlsplit(camera)  # user name, password and query are left out: they may hold secrets
            return f"{kind} {parts.scheme}://{parts.netloc.rpartition('@')[2]}{parts.path}"
        if Path(camera).is_file() or Path(camera).suffix.lower() in SUFFIXES:
            return f"file {camera} ({kind})"
        return f"{kind} {camera}"
    if settings.path is None:
        return f"camera ({settings.source})"
    return f"{'folder' if settings.path.is_dir() else 'file'} {settings.path} ({settings.source})"
