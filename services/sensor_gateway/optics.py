"""What is known of a camera, and by it where the people in its pictures are."""

from dataclasses import dataclass

import numpy as np

from actum.calibration import Calibration
from sensor_gateway.captured_picture import DepthPicture, Picture, unmirrored
from sensor_gateway.lens import Lens
from sensor_gateway.people.depth_lifting import lifted
from sensor_gateway.people.landmarks import Landmarks
from sensor_gateway.people.placing import Placed, placed

SAME_CAMERA = np.eye(4).ravel().tolist()
"""`skeleton_from_image` of images in which the people are found themselves."""


@dataclass(frozen=True)
class Optics:
    """A colour camera: its calibration, or else its field of view; and the stature of the people it sees.

    `mirrored` tells that the camera gives mirror images, as some do for people who watch themselves.
    """

    field_of_view_deg: float = 60.0
    calibration: Calibration | None = None
    person_height_m: float | None = None
    mirrored: bool = False

    def lens(self, width: int, height: int) -> Lens | None:
        """Return the lens for images of a size; None where another size was calibrated."""
        if self.calibration is None:
            return Lens.of_field_of_view(width, height, self.field_of_view_deg)
        return Lens.of_calibration(self.calibration) if (width, height) == self.calibration.image_size else None

    @property
    def skeleton_from_image(self) -> list[float]:
        """The rigid transform (4, 4), row by row, to the frame of the camera that sees the people."""
        known = None if self.calibration is None else self.calibration.skeleton_from_image
        return SAME_CAMERA if known is None else known

    def seen(self, picture: Picture) -> Picture:
        """Return a picture as it would be without a mirror."""
        return unmirrored(picture) if self.mirrored else picture

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        height, width = picture.image_bgr.shape[:2]
        return self.lens(width, height)

    def placed(self, landmarks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Put one person's landmarks into the camera frame, at the distance that a body's size tells.

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
    """A depth camera: it tells its intrinsics, unless a calibration does, and measures how far away people are."""

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        if isinstance(picture, DepthPicture) and self.calibration is None:
            return picture.lens
        return super().lens_of(picture)

    def placed(self, landmarks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Put one person's landmarks into the camera frame by the measured depth.

        Raises:
            PlacingError: the landmarks fit no place in front of the camera.
        """
        if isinstance(picture, DepthPicture):
            return lifted(landmarks, lens, picture.depth_m, self.person_height_m)
        return super().placed(landmarks, lens, picture)

    def __str__(self) -> str:
        """Say which intrinsics are used."""
        return "the device's own" if self.calibration is None else self.calibration.id
