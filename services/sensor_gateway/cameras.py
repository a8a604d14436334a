"""Builds the sources of the cameras that the settings can name."""

from collections.abc import Callable, Generator
from contextlib import AbstractContextManager, nullcontext
from functools import partial
from pathlib import Path

from actum.calibration import Calibration, CalibrationError
from sensor_gateway.camera_source import CameraSource
from sensor_gateway.captured_picture import Picture
from sensor_gateway.devices import nite, openni2, openni2_library, realsense
from sensor_gateway.devices.capture import Capture
from sensor_gateway.devices.file_capture import FileCapture
from sensor_gateway.devices.webcam import LiveCapture
from sensor_gateway.optics import SAME_CAMERA, DepthOptics, Optics
from sensor_gateway.people.landmarks import Estimator, Nobody
from sensor_gateway.people.pose_estimator import PoseEstimator
from sensor_gateway.perceiver import MarkersPerceiver, UsersPerceiver
from sensor_gateway.settings import Settings

Recorded = Callable[[Path, int], Generator[Picture, None, None]]
"""Reads the pictures of a depth camera's recording, from its path and the stamp of the first picture (ns)."""


class DepthSourceError(ValueError):
    """The settings name no usable depth camera; the message names the problem and the remedy."""


class MarkerCamera(CameraSource):
    """A camera for markers only, run beside the gateway of the same sensor and therefore a service of another name."""

    name = "marker_camera"


def optics_of(settings: Settings) -> Optics:
    """Build the optics of a camera that sees the people, from the settings.

    Raises:
        CalibrationError: the calibration file is missing, no calibration, or that of a marker camera.
    """
    path = settings.calibration
    calibration = None if path is None else Calibration.load(path)
    if calibration is not None and calibration.skeleton_from_image not in (None, SAME_CAMERA):
        raise CalibrationError(
            f"{path} contains skeleton_from_image, so it is the calibration of a marker camera: start that camera "
            "with --source marker-camera. A camera that sees the people needs a file that 'actum calibrate "
            "intrinsics' wrote"
        )
    return Optics(settings.field_of_view_deg, calibration, settings.person_height_m, settings.mirrored)


def estimator_of(settings: Settings) -> AbstractContextManager[Estimator]:
    """Open the pose model.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
    """
    return PoseEstimator(settings.pose_model, settings.people)


def capture_of(camera: str, size: tuple[int, int] | None, loop: bool = False) -> Capture:
    """Open a camera by its setting: an existing file, a device's number or path, or a URL; `size` is in px."""
    path = Path(camera)
    if path.is_file():
        return FileCapture(path, loop=loop)
    return LiveCapture(int(camera) if camera.isdecimal() else camera, size)


def camera_of(settings: Settings, start_ns: int) -> CameraSource:
    """Build the source of a webcam, a stream or a video file.

    Raises:
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
        CalibrationError: the calibration file is missing, no calibration, or that of a marker camera.
    """
    _check_pose_model(settings)
    source = CameraSource(
        lambda: estimator_of(settings),
        optics_of(settings),
        open_capture=lambda: capture_of(settings.camera, _size_of(settings), settings.loop),
        sensor=settings.sensor,
        session_id=f"camera-{start_ns}",
    )
    source.counters.details["model"] = settings.pose_model.name
    return source


def marker_camera_of(settings: Settings, start_ns: int) -> MarkerCamera:
    """Build the source of a camera that sees markers only.

    Raises:
        CalibrationError: the calibration file is missing, or lacks the transform to the camera that sees the people.
    """
    calibration = None if settings.calibration is None else Calibration.load(settings.calibration)
    if calibration is None or calibration.skeleton_from_image is None:
        raise CalibrationError(
            "--source marker-camera needs the transform from this camera to the camera that sees the people: set "
            "--calibration (ACTUM_CALIBRATION) to a file that 'actum calibrate extrinsics' wrote"
        )
    return MarkerCamera(
        lambda: nullcontext(Nobody()),
        Optics(settings.field_of_view_deg, calibration, None, settings.mirrored),
        open_capture=lambda: capture_of(settings.camera, _size_of(settings), settings.loop),
        sensor=settings.sensor,
        session_id=f"markers-{start_ns}",
        perceiver=MarkersPerceiver,
    )


def realsense_of(settings: Settings, start_ns: int) -> CameraSource:
    """Build the source of a RealSense camera, or of the recording that `path` names.

    Raises:
        RealSenseError: pyrealsense2 is not installed.
        DepthSourceError: there is no such recording.
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
        CalibrationError: the calibration file is missing, no calibration, or that of a marker camera.
    """
    realsense.library()
    live = partial(realsense.RealSenseCapture, _size_of(settings))
    return _depth_source(settings, f"realsense-{start_ns}", live, realsense.recorded_pictures)


def openni2_of(settings: Settings, start_ns: int) -> CameraSource:
    """Build the source of a camera that OpenNI 2 has a driver for, or of the recording that `path` names.

    If NiTE 2 is installed, it tracks the people in place of the pose model.

    Raises:
        OpenNiError: OpenNI 2 or its bindings are not installed.
        DepthSourceError: there is no such recording.
        PoseModelError: MediaPipe is not installed, or the file is missing or no pose model.
        CalibrationError: the calibration file is missing, no calibration, or that of a marker camera.
    """
    openni2_library.library()
    nite2 = nite.nite() if settings.path is None else None
    if nite2 is not None:
        return CameraSource(
            lambda: nullcontext(Nobody()),
            _depth_optics(settings),
            open_capture=lambda: nite.NiteCapture(nite2, _size_of(settings), settings.field_of_view_deg),
            sensor=settings.sensor,
            session_id=f"openni2-{start_ns}",
            perceiver=UsersPerceiver,
        )
    live = partial(openni2.OpenNi2Capture, _size_of(settings), settings.field_of_view_deg)
    recorded = partial(openni2.recorded_pictures, field_of_view_deg=settings.field_of_view_deg)
    return _depth_source(settings, f"openni2-{start_ns}", live, recorded)


def _depth_source(settings: Settings, session_id: str, live: Callable[[], Capture], recorded: Recorded) -> CameraSource:
    _check_pose_model(settings)
    path = settings.path
    optics = _depth_optics(settings)
    if path is not None and not path.is_file():
        raise DepthSourceError(
            f"there is no recording {path}: correct --path (ACTUM_PATH), or leave out --path to use a camera"
        )
    return CameraSource(
        lambda: estimator_of(settings),
        optics,
        open_capture=live if path is None else lambda: FileCapture(path, read=recorded, loop=settings.loop),
        sensor=settings.sensor,
        session_id=session_id,
    )


def _depth_optics(settings: Settings) -> DepthOptics:
    """Build the optics of a depth camera, whose images are never mirrored, from the settings."""
    optics = optics_of(settings)
    return DepthOptics(optics.field_of_view_deg, optics.calibration, optics.person_height_m)


def _check_pose_model(settings: Settings) -> None:
    """Open the pose model and close it, so that an unusable one stops the service at its start."""
    with estimator_of(settings):
        pass


def _size_of(settings: Settings) -> tuple[int, int] | None:
    """Return the width and the height (px) to ask a device for, where they are set."""
    if settings.camera_size is None:
        return None
    width, _, height = settings.camera_size.partition("x")
    return int(width), int(height)
