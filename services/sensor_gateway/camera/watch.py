"""Whether a camera's pictures still show anything, and when to try again: pure steps over stamps."""

import numpy as np
from numpy.typing import NDArray

from actum.darkness import is_black
from actum.node import SECOND_NS
from sensor_gateway.camera.video import Picture

FROZEN_NS = SECOND_NS
"""How long the same picture, bit for bit, may stay: a sensor's noise never repeats."""

BLACK_NS = SECOND_NS // 2
BLACK_LOST_NS = 5 * SECOND_NS
"""How long a camera that was opened may show nothing: a lens may be covered, but the driver may have failed, too."""

STEP_PX = 8


class Watch:
    """Tells what is wrong with a live stream of pictures, also where its camera is opened again meanwhile.

    Attributes:
        lost: whether what was complained of last may be mended by opening the camera again.
    """

    def __init__(self) -> None:
        self.lost = False
        self._sample: NDArray[np.uint8] | None = None
        self._changed_ns = 0
        self._lit_ns: int | None = None
        self._hopeful_ns: int | None = None

    def opened(self) -> None:
        """Note that the camera was opened: it has time again to show something, but what was black stays so."""
        self._hopeful_ns = None

    def complaint(self, picture: Picture) -> str | None:
        """Take the next picture; return why it cannot be used, or None. Stamps rise."""
        sample = np.ascontiguousarray(picture.image_bgr[::STEP_PX, ::STEP_PX])
        if self._sample is None or not np.array_equal(sample, self._sample):
            self._sample, self._changed_ns = sample, picture.stamp_ns
        lit = not is_black(picture.image_bgr)
        self._lit_ns = picture.stamp_ns if lit or self._lit_ns is None else self._lit_ns
        self._hopeful_ns = picture.stamp_ns if lit or self._hopeful_ns is None else self._hopeful_ns
        return self._judged(picture.stamp_ns, self._lit_ns, self._hopeful_ns)

    def _judged(self, stamp_ns: int, lit_ns: int, hopeful_ns: int) -> str | None:
        if stamp_ns - lit_ns >= BLACK_NS:
            self.lost = stamp_ns - hopeful_ns >= BLACK_LOST_NS
            return "black: nothing can be seen; is the lens covered?"
        self.lost = stamp_ns - self._changed_ns >= FROZEN_NS
        return f"frozen: the picture has not changed for {FROZEN_NS / SECOND_NS:g} s" if self.lost else None


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
