"""The optics of a camera: its intrinsics, and the placing of people in its camera frame."""

from dataclasses import dataclass, replace

import numpy as np

from actum.calibration import Calibration
from sensor_gateway.captured_picture import DepthPicture, Picture
from sensor_gateway.lens import Lens
from sensor_gateway.people.depth_lifting import lifted
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import Placed, placed

SAME_CAMERA = np.eye(4).ravel().tolist()
"""`skeleton_from_image` of a camera that sees both people and markers: the identity, row by row."""


@dataclass(frozen=True)
class Optics:
    """A colour camera: its calibration, or else its field of view; and the stature of the people, if known.

    `mirrored` is true if the camera gives mirror images, as some webcams do.
    """

    field_of_view_deg: float = 60.0
    calibration: Calibration | None = None
    person_height_m: float | None = None
    mirrored: bool = False

    @property
    def skeleton_from_image(self) -> list[float]:
        """The rigid transform (4, 4), row by row, to the frame of the camera that sees the people."""
        calibrated = None if self.calibration is None else self.calibration.skeleton_from_image
        return SAME_CAMERA if calibrated is None else calibrated

    def unmirrored(self, picture: Picture) -> Picture:
        """Return a picture, flipped back if the camera mirrors its images: no marker can be read in a mirror image."""
        if not self.mirrored:
            return picture
        return replace(picture, image_bgr=np.ascontiguousarray(picture.image_bgr[:, ::-1]))

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        height, width = picture.image_bgr.shape[:2]
        if self.calibration is None:
            return Lens.of_field_of_view(width, height, self.field_of_view_deg)
        return Lens.of_calibration(self.calibration) if (width, height) == self.calibration.image_size else None

    def placed(self, landmarks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Place one person's landmarks in the camera frame, at the distance estimated from the body's size.

        Raises:
            PlacingError: the landmarks fit no place in front of the camera.
        """
        return placed(landmarks, lens, self.person_height_m)

    def __str__(self) -> str:
        """Say which intrinsics are used."""
        if self.calibration is not None:
            return self.calibration.id
        return f"assumed: {self.field_of_view_deg:g} degrees along the longer side, not calibrated"


@dataclass(frozen=True)
class DepthOptics(Optics):
    """A depth camera: it reports its intrinsics, which a calibration overrides, and measures the distance of people."""

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        if isinstance(picture, DepthPicture) and self.calibration is None:
            return picture.lens
        return super().lens_of(picture)

    def placed(self, landmarks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Place one person's landmarks in the camera frame by the measured depth.

        Raises:
            PlacingError: the landmarks fit no place in front of the camera.
        """
        if isinstance(picture, DepthPicture):
            return lifted(landmarks, lens, picture.depth_m, self.person_height_m)
        return super().placed(landmarks, lens, picture)

    def __str__(self) -> str:
        """Say which intrinsics are used."""
        return "the device's own" if self.calibration is None else self.calibration.id
