"""The source that the settings name."""

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from actum.calibration import Calibration
from actum.messages import Message
from actum.node import SECOND_NS, Source, Tally
from sensor_gateway.amended import AmendedSource, played_anew, tilted, without_image
from sensor_gateway.calibrated import CalibratedSource
from sensor_gateway.camera.beside import markers_camera_of
from sensor_gateway.camera.source import CameraSource, camera_of
from sensor_gateway.depth.source import openni2_of, realsense_of
from sensor_gateway.described import description
from sensor_gateway.msr_action3d import MsrAction3dSource
from sensor_gateway.recording_source import RecordingSource
from sensor_gateway.settings import Settings
from sensor_gateway.simulator import Simulator, balanced_programme
from sensor_gateway.takes import LoopedSource
from sensor_gateway.utkinect import UtKinectSource

ROUND = 4
"""Repetitions of each action before an endless scene is drawn anew."""

FROM_FILES: Mapping[str, Callable[[Path, str], Source]] = {
    "recording": RecordingSource,
    "msr-action3d": MsrAction3dSource,
    "utkinect": UtKinectSource,
}

CAMERAS: Mapping[str, Callable[[Settings, int], CameraSource]] = {
    "camera": camera_of,
    "marker-camera": markers_camera_of,
    "realsense": realsense_of,
    "openni2": openni2_of,
}


class SourceError(ValueError):
    """The settings name no usable source."""


def source_of(settings: Settings, start_ns: int) -> Source:
    """Build the source; a simulated scene's stamps begin at `start_ns`.

    Raises:
        SourceError: a source from files has no path.
        CalibrationError: the calibration file is missing or no calibration.
        PoseModelError: a camera's pose model is missing.
        DepthSourceError, RealSenseError, OpenNiError: a depth camera's library or recording is missing.
    """
    source = _calibrated(_named(settings, start_ns), settings.calibration)
    source.tally.details["source"] = description(settings)
    if not settings.images:
        source = AmendedSource(source, without_image)
    return source if settings.up_in_camera is None else AmendedSource(source, tilted(settings.up_in_camera))


def _calibrated(source: Source, calibration: Path | None) -> Source:
    if calibration is None or isinstance(source, CameraSource):
        return source
    return CalibratedSource(source, Calibration.load(calibration))


def _named(settings: Settings, start_ns: int) -> Source:
    if settings.source == "simulator":
        return EndlessSimulator(settings, start_ns) if settings.repetitions == 0 else _scene(settings, start_ns)
    if settings.source in CAMERAS:
        return CAMERAS[settings.source](settings, start_ns)
    if settings.path is None:
        raise SourceError(f"source {settings.source} needs --path (ACTUM_PATH): the file or folder to play")
    played = AmendedSource(FROM_FILES[settings.source](settings.path, settings.sensor), played_anew(f"{start_ns:x}"))
    return LoopedSource(played) if settings.loop else played


class EndlessSimulator:
    """One simulated scene after another, as one stream."""

    name = "sensor_gateway"
    paced = True

    def __init__(self, settings: Settings, start_ns: int) -> None:
        self.tally = Tally()
        self._settings = settings
        self._start_ns = start_ns

    def frames(self) -> Iterator[list[Message]]:
        """Yield frames for ever."""
        start_ns, seed = self._start_ns, self._settings.seed
        while True:
            scene = self._settings.model_copy(update={"repetitions": ROUND, "seed": seed})
            for messages in _scene(scene, start_ns, session_id=f"simulator-{self._start_ns}").frames():
                yield messages
                newest_ns = messages[0].stamp_ns
            start_ns, seed = newest_ns + SECOND_NS, seed + 1


def _scene(settings: Settings, start_ns: int, session_id: str | None = None) -> Simulator:
    return Simulator(
        balanced_programme(settings.repetitions, settings.seed, settings.actor),
        actor_seed=settings.actor,
        seed=settings.seed,
        sensor=settings.sensor,
        image_hz=settings.image_hz,
        start_ns=start_ns,
        session_id=session_id,
    )
