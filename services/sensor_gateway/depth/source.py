"""The depth cameras that the settings can name, as sources."""

from collections.abc import Callable, Generator
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any

from sensor_gateway.camera.bodies import Nobody
from sensor_gateway.camera.capture import Capture, FileCapture
from sensor_gateway.camera.source import CameraSource, estimator_of, optics_of, size_of
from sensor_gateway.camera.video import Picture
from sensor_gateway.depth import nite, openni2, openni2_library, realsense
from sensor_gateway.depth.picture import DepthOptics
from sensor_gateway.settings import Settings


class DepthSourceError(ValueError):
    """The settings name no usable depth camera: what is wrong and what to do."""


def realsense_of(settings: Settings, start_ns: int) -> CameraSource:
    """Build the source of a RealSense camera, or of the recording that `path` names.

    Raises:
        RealSenseError: pyrealsense2 is not installed.
        DepthSourceError: there is no such recording.
        PoseModelError: MediaPipe is not installed, or the pose model is missing or none.
        CalibrationError: the calibration file is missing, no calibration, or that of a camera beside this one.
    """
    realsense.library()
    live = partial(realsense.RealSenseCapture, size_of(settings))
    return _source(settings, f"realsense-{start_ns}", live, realsense.recorded_pictures)


def openni2_of(settings: Settings, start_ns: int) -> CameraSource:
    """Build the source of a camera that OpenNI 2 has a driver for, or of the recording that `path` names.

    Where NiTE 2 is installed, a camera's people are those that it tracks.

    Raises:
        OpenNiError: OpenNI 2 or its bindings are not installed.
        DepthSourceError: there is no such recording.
        PoseModelError: MediaPipe is not installed, or the pose model is missing or none.
        CalibrationError: the calibration file is missing, no calibration, or that of a camera beside this one.
    """
    openni2_library.library()
    nite2 = nite.nite() if settings.path is None else None
    if nite2 is not None:
        return _nite_source(settings, f"openni2-{start_ns}", nite2)
    live = partial(openni2.OpenNi2Capture, size_of(settings), settings.field_of_view_deg)
    recorded = partial(openni2.recorded_pictures, field_of_view_deg=settings.field_of_view_deg)
    return _source(settings, f"openni2-{start_ns}", live, recorded)


def _nite_source(settings: Settings, session_id: str, nite2: Any) -> CameraSource:
    told = optics_of(settings)
    return CameraSource(
        lambda: nullcontext(Nobody()),
        DepthOptics(told.field_of_view_deg, told.calibration, told.person_height_m),
        open_capture=lambda: nite.NiteCapture(nite2, size_of(settings), settings.field_of_view_deg),
        sensor=settings.sensor,
        session_id=session_id,
        perceiver=nite.UsersPerceiver,
    )


def _source(
    settings: Settings,
    session_id: str,
    live: Callable[[], Capture],
    recorded: Callable[[Path, int], Generator[Picture, None, None]],
) -> CameraSource:
    with estimator_of(settings):
        pass  # what is wrong with the model is said before anything is served
    told = optics_of(settings)
    return CameraSource(
        lambda: estimator_of(settings),
        DepthOptics(told.field_of_view_deg, told.calibration, told.person_height_m),
        open_capture=_opener(settings, live, recorded),
        sensor=settings.sensor,
        session_id=session_id,
    )


def _opener(
    settings: Settings, live: Callable[[], Capture], recorded: Callable[[Path, int], Generator[Picture, None, None]]
) -> Callable[[], Capture]:
    path = settings.path
    if path is None:
        return live
    if not path.is_file():
        raise DepthSourceError(f"{path}: no such recording; leave --path (ACTUM_PATH) out to use a camera")
    return lambda: FileCapture(path, read=recorded, loop=settings.loop)
