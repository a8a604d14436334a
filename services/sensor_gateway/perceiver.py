"""The camera sources' pure step: one picture in, the messages of its instant out."""

from collections.abc import Iterator

import cv2

from actum.messages import Image, Message, Skeleton
from actum.node import Counters
from sensor_gateway.captured_picture import Picture, UsersPicture
from sensor_gateway.lens import Lens
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Estimator
from sensor_gateway.people.people_tracker import PeopleTracker

JPEG_QUALITY = 90
"""JPEG quality, of 100; much less would blur the corners of markers."""
OTHER_SIZE = "image_size_mismatch"
"""Counter of pictures whose size differs from the calibrated one."""


class Perceiver:
    """Makes an image and a skeleton of each picture; the image first, so that markers are detected meanwhile."""

    def __init__(self, estimator: Estimator, optics: Optics, sensor: str, session_id: str, counters: Counters) -> None:
        self._people = PeopleTracker(estimator)
        self._optics = optics
        self._sensor = sensor
        self._session_id = session_id
        self._counters = counters

    def messages(self, picture: Picture) -> Iterator[Message]:
        """Yield a picture's image, then its skeletons; stamps rise."""
        picture, lens = self._optics.unmirrored(picture), self._optics.lens_of(picture)
        if lens is not None:
            yield self._image(picture, lens)
        yield self._skeleton(picture, lens)

    def skeleton(self, picture: Picture) -> Skeleton:
        """Return the skeletons of all people in a picture; stamps rise."""
        return self._skeleton(self._optics.unmirrored(picture), self._optics.lens_of(picture))

    def lost(self, stamp_ns: int, reason: str) -> list[Message]:
        """Return the messages that report a lost camera."""
        return [self.nobody(stamp_ns, reason)]

    def nobody(self, stamp_ns: int, reason: str) -> Skeleton:
        """Return an invalid skeleton message with the reason why nobody can be detected."""
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
        agents = self._people.agents(
            picture.image_bgr, picture.stamp_ns, lambda landmarks: self._optics.placed(landmarks, lens, picture)
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


class MarkersPerceiver(Perceiver):
    """Makes an image of each picture of a marker camera, and no skeleton."""

    def messages(self, picture: Picture) -> Iterator[Message]:
        """Yield a picture's image; count a picture whose size differs from the calibrated one."""
        picture, lens = self._optics.unmirrored(picture), self._optics.lens_of(picture)
        if lens is None:
            self._of_another_size(picture)
        else:
            yield self._image(picture, lens)

    def lost(self, stamp_ns: int, reason: str) -> list[Message]:
        """Return no message: skeletons come from the other camera, and `status` reports this one as lost."""
        return []


class UsersPerceiver(Perceiver):
    """Makes an image and a skeleton of each picture of a device whose own software tracks people."""

    def _skeleton(self, picture: Picture, lens: Lens | None) -> Skeleton:
        assert isinstance(picture, UsersPicture)
        if lens is None:
            return self._of_another_size(picture)
        agents = list(picture.agents)
        return Skeleton(stamp_ns=picture.stamp_ns, sensor=self._sensor, agents=agents, session_id=self._session_id)
