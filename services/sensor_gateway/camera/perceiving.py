"""The camera's pure step: one picture in, the messages of its instant out."""

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from actum.calibration import Calibration
from actum.messages import Image, Message, Skeleton
from actum.node import Counters
from sensor_gateway.camera.bodies import Bodies, Estimator
from sensor_gateway.camera.landmarks import Landmarks
from sensor_gateway.camera.lens import Lens
from sensor_gateway.camera.placing import Placed, placed
from sensor_gateway.camera.video import Picture, unmirrored

JPEG_QUALITY = 90
OTHER_SIZE = "image_size_mismatch"
SAME_CAMERA = np.eye(4).ravel().tolist()


@dataclass(frozen=True)
class Optics:
    """What is known of a camera: its calibration, or else its field of view; and the stature of who is before it.

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
        """Where the camera that sees the people sees this one; itself where nothing else is known."""
        told = None if self.calibration is None else self.calibration.skeleton_from_image
        return SAME_CAMERA if told is None else told

    def seen(self, picture: Picture) -> Picture:
        """Return a picture as it would be seen without a mirror."""
        return unmirrored(picture) if self.mirrored else picture

    def lens_of(self, picture: Picture) -> Lens | None:
        """Return the lens a picture was taken with; None where another size was calibrated."""
        height, width = picture.image_bgr.shape[:2]
        return self.lens(width, height)

    def placed(self, marks: Landmarks, lens: Lens, picture: Picture) -> Placed:
        """Put one person's landmarks into the camera frame.

        Raises:
            PlacingError: the landmarks fit no place in front of the camera.
        """
        return placed(marks, lens, self.person_height_m)

    def __str__(self) -> str:
        """Say it in a word or two."""
        if self.calibration is not None:
            return self.calibration.id
        return f"assumed: {self.field_of_view_deg:g} degrees along the longer side, not calibrated"


class Perceiver:
    """Makes an image and a skeleton of each picture; the image comes first, so that markers are sought meanwhile."""

    def __init__(self, estimator: Estimator, optics: Optics, sensor: str, session_id: str, counters: Counters) -> None:
        self._bodies = Bodies(estimator)
        self._optics = optics
        self._sensor = sensor
        self._session_id = session_id
        self._counters = counters

    def messages(self, picture: Picture) -> Iterator[Message]:
        """Yield a picture's image, then its skeletons; stamps rise."""
        picture, lens = self._optics.seen(picture), self._optics.lens_of(picture)
        if lens is not None:
            yield self._image(picture, lens)
        yield self._skeleton(picture, lens)

    def skeleton(self, picture: Picture) -> Skeleton:
        """Return everybody in a picture; stamps rise."""
        return self._skeleton(self._optics.seen(picture), self._optics.lens_of(picture))

    def lost(self, stamp_ns: int, reason: str) -> list[Message]:
        """Say that the camera is lost."""
        return [self.nobody(stamp_ns, reason)]

    def nobody(self, stamp_ns: int, reason: str) -> Skeleton:
        """Return a frame in which nothing can be seen, and why."""
        return Skeleton(
            stamp_ns=stamp_ns,
            sensor=self._sensor,
            valid=False,
            reason=reason,
            agents=[],
            session_id=self._session_id,
        )

    def _skeleton(self, picture: Picture, lens: Lens | None) -> Skeleton:
        if lens is None:
            return self._of_another_size(picture)
        agents = self._bodies.agents(
            picture.image_bgr, picture.stamp_ns, lambda marks: self._optics.placed(marks, lens, picture)
        )
        return Skeleton(stamp_ns=picture.stamp_ns, sensor=self._sensor, agents=agents, session_id=self._session_id)

    def _of_another_size(self, picture: Picture) -> Skeleton:
        assert self._optics.calibration is not None
        height, width = picture.image_bgr.shape[:2]
        calibrated = "x".join(map(str, self._optics.calibration.image_size))
        reason = f"image_size_mismatch: {width}x{height}, calibrated for {calibrated}"
        self._counters.reject(OTHER_SIZE, reason)
        return self.nobody(picture.stamp_ns, reason)

    def _image(self, picture: Picture, lens: Lens) -> Image:
        height, width = picture.image_bgr.shape[:2]
        _, data = cv2.imencode(".jpg", picture.image_bgr, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
        return Image(
            stamp_ns=picture.stamp_ns,
            sensor=self._sensor,
            format="jpeg",
            width=width,
            height=height,
            data=data.tobytes(),
            K=lens.matrix.ravel().tolist(),
            distortion=lens.distortion.tolist(),
            skeleton_from_image=self._optics.skeleton_from_image,
            intrinsics_assumed=lens.assumed,
            session_id=self._session_id,
        )
