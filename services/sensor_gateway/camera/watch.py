"""Whether a camera's pictures still show anything, and when to try again: pure steps over stamps."""

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from sensor_gateway.camera.video import Picture

FROZEN_NS = SECOND_NS
"""How long the same picture, bit for bit, may stay: a sensor's noise never repeats."""

BLACK_NS = SECOND_NS // 2
BLACK_LEVEL = 10
"""The 99th percentile of a picture in which nothing can be seen, of 255."""

STEP_PX = 8
FROZEN, BLACK = "frozen", "black"


class Watch:
    """Tells what is wrong with a live stream of pictures."""

    def __init__(self) -> None:
        self._sample: NDArray[np.uint8] | None = None
        self._changed_ns = 0
        self._lit_ns: int | None = None

    def complaint(self, picture: Picture) -> str | None:
        """Take the next picture; return why it cannot be used, or None. Stamps rise."""
        sample = np.ascontiguousarray(picture.image_bgr[::STEP_PX, ::STEP_PX])
        if self._sample is None or not np.array_equal(sample, self._sample):
            self._sample, self._changed_ns = sample, picture.stamp_ns
        if self._lit_ns is None or np.percentile(sample, 99) > BLACK_LEVEL:
            self._lit_ns = picture.stamp_ns
        if picture.stamp_ns - self._lit_ns >= BLACK_NS:
            return f"{BLACK}: nothing can be seen; is the lens covered?"
        if picture.stamp_ns - self._changed_ns >= FROZEN_NS:
            return f"{FROZEN}: the picture has not changed for {FROZEN_NS / SECOND_NS:g} s"
        return None


class BackOff:
    """When to try again: twice as long after each failure, up to a limit."""

    FIRST_NS = SECOND_NS // 2
    LONGEST_NS = 8 * SECOND_NS

    def __init__(self) -> None:
        self._wait_ns = self.FIRST_NS

    def failed(self) -> int:
        """Return how long to wait now (ns)."""
        wait_ns, self._wait_ns = self._wait_ns, min(2 * self._wait_ns, self.LONGEST_NS)
        return wait_ns

    def worked(self) -> None:
        """Begin anew."""
        self._wait_ns = self.FIRST_NS
