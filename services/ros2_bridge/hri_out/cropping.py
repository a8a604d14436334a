"""Cuts people out of the camera's image. Needs OpenCV and imagesize, which the extra `marker-tracker` brings."""

from typing import Any

import numpy as np

from actum.images import UnusableImageError, colour
from actum.messages import Image
from actum.node import SECOND_NS, Counters
from ros2_bridge.hri.types import IMAGE
from ros2_bridge.message_types import made

FURTHEST_NS = SECOND_NS // 20
"""Most time (ns) between an image and the skeletons that are cut out of it, as of two cameras."""


class Cropper:
    """Keeps the newest image, and cuts each person out of it once; it is decoded when somebody is."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._image: Image | None = None
        self._pixels: Any = None
        self._of_ns = -1

    def take(self, image: Image) -> None:
        """Keep an image in the place of the one before."""
        self._image, self._pixels, self._of_ns = image, None, -1

    def cut(self, of: Any, stamp_ns: int, region: Any | None) -> Any | None:
        """Return the region of a skeleton's body as a sensor_msgs/Image; None where no new image is of that time."""
        if region is None or not self._decoded(stamp_ns):
            return None
        height, width = self._pixels.shape[:2]
        left, right = int(region.xmin * width), int(np.ceil(region.xmax * width))
        top, bottom = int(region.ymin * height), int(np.ceil(region.ymax * height))
        part = self._pixels[top:bottom, left:right]
        rows, columns = part.shape[:2]
        data = np.ascontiguousarray(part).reshape(-1)
        return made(IMAGE, header=of, height=rows, width=columns, encoding="bgr8", step=3 * columns, data=data)

    def _decoded(self, stamp_ns: int) -> bool:
        """Tell whether there are pixels for the skeletons of a stamp, of which an image serves the first alone."""
        if self._image is None or abs(stamp_ns - self._image.stamp_ns) > FURTHEST_NS:
            return False
        if self._of_ns < 0:
            self._of_ns = stamp_ns
            try:
                self._pixels = colour(self._image)
            except UnusableImageError as error:
                self._counters.reject("unusable_image", str(error))
        return self._of_ns == stamp_ns and self._pixels is not None
