"""A camera beside the one that sees the people: it sees the markers, and finds nobody."""

from collections.abc import Iterator
from contextlib import nullcontext

from actum.calibration import Calibration, CalibrationError
from actum.messages import Message
from sensor_gateway.camera.bodies import Nobody
from sensor_gateway.camera.capture import capture_of
from sensor_gateway.camera.perceiving import Optics, Perceiver
from sensor_gateway.camera.source import CameraSource, size_of
from sensor_gateway.camera.video import Picture
from sensor_gateway.settings import Settings


class MarkersPerceiver(Perceiver):
    """Makes an image of each picture that says where the people's camera is, and no skeleton."""

    def messages(self, picture: Picture) -> Iterator[Message]:
        """Yield a picture's image; one of another size than was calibrated is counted."""
        picture, lens = self._optics.seen(picture), self._optics.lens_of(picture)
        if lens is None:
            self._of_another_size(picture)
        else:
            yield self._image(picture, lens)

    def lost(self, stamp_ns: int, reason: str) -> list[Message]:
        """Leave the people to the other camera; `status` says that this one is lost."""
        return []


class MarkersCamera(CameraSource):
    """A camera beside the gateway of the same sensor, and so a service of another name."""

    name = "marker_camera"


def markers_camera_of(settings: Settings, start_ns: int) -> MarkersCamera:
    """Build the source of a camera that sees markers only.

    Raises:
        CalibrationError: the calibration file is missing, or does not say where the people's camera is.
    """
    calibration = None if settings.calibration is None else Calibration.load(settings.calibration)
    if calibration is None or calibration.skeleton_from_image is None:
        raise CalibrationError(
            "a camera that sees markers only needs --calibration (ACTUM_CALIBRATION), a file of "
            "'actum calibrate extrinsics': where it is from the camera that sees the people"
        )
    return MarkersCamera(
        lambda: nullcontext(Nobody()),
        Optics(settings.field_of_view_deg, calibration, None, settings.mirrored),
        open_capture=lambda: capture_of(settings.camera, size_of(settings), settings.loop),
        sensor=settings.sensor,
        session_id=f"markers-{start_ns}",
        perceiver=MarkersPerceiver,
    )
