"""A colour image with the depth measured at each of its pixels, and what a depth camera knows of itself."""

from dataclasses import dataclass

from sensor_gateway.camera.landmarks import Landmarks
from sensor_gateway.camera.lens import Lens
from sensor_gateway.camera.perceiving import Optics
from sensor_gateway.camera.placing import Placed
from sensor_gateway.camera.video import Picture
from sensor_gateway.depth.lifting import DepthImage, lifted


@dataclass(frozen=True, eq=False)
class DepthPicture(Picture):
    """A picture, its depth (height, width; m, 0 where there is none) pixel by pixel, and the device's own lens."""

    depth_m: DepthImage
    lens: Lens


@dataclass(frozen=True)
class DepthOptics(Optics):
    """A depth camera: the device tells its lens, unless a calibration does, and measures how far away people are."""

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        if isinstance(picture, DepthPicture) and self.calibration is None:
            return picture.lens
        return super().lens_of(picture)

    def placed(self, marks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Put one person's landmarks into the camera frame by the measured depth.

        Raises:
            PlacingError: the landmarks fit no place in front of the camera.
        """
        if isinstance(picture, DepthPicture):
            return lifted(marks, lens, picture.depth_m, self.person_height_m)
        return super().placed(marks, lens, picture)

    def __str__(self) -> str:
        """Say it in a word or two."""
        return "the device's own" if self.calibration is None else self.calibration.id
