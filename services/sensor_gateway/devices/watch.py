"""Detects frozen and black pictures of a live camera, and times its reopening: pure steps over stamps."""

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from actum.pictures import is_black
from sensor_gateway.captured_picture import Picture

FROZEN_NS = SECOND_NS
"""Time for which identical pictures mean that the driver repeats one: a sensor's noise changes every picture."""

BLACK_NS = SECOND_NS // 2
"""Least time of black pictures that is reported: shorter ones occur while a camera adjusts its exposure."""

BLACK_LOST_NS = 5 * SECOND_NS
"""Time of black pictures since opening after which a camera is opened again: that helps if its driver has failed."""

STEP_PX = 8
"""Every eighth pixel of every eighth row is compared: noise appears in all of them."""


class Watch:
    """Detects pictures that are frozen or stay black; keeps its state when the camera is opened again.

    Attributes:
        lost: whether opening the camera again may remedy the last complaint.
    """

    def __init__(self) -> None:
        self.lost = False
        self._last_sample: NDArray[np.uint8] | None = None
        self._changed_ns = 0
        self._lit_ns: int | None = None
        self._lit_or_opened_ns: int | None = None

    def opened(self) -> None:
        """Restart the time after which a black camera is opened again; pictures remain black until one is lit."""
        self._lit_or_opened_ns = None

    def complaint(self, picture: Picture) -> str | None:
        """Judge the next picture; return why it cannot be used, or None. Stamps rise."""
        sample = np.ascontiguousarray(picture.image_bgr[::STEP_PX, ::STEP_PX])
        if self._last_sample is None or not np.array_equal(sample, self._last_sample):
            self._last_sample, self._changed_ns = sample, picture.stamp_ns
        lit = not is_black(picture.image_bgr)
        self._lit_ns = picture.stamp_ns if lit or self._lit_ns is None else self._lit_ns
        self._lit_or_opened_ns = picture.stamp_ns if lit or self._lit_or_opened_ns is None else self._lit_or_opened_ns
        if picture.stamp_ns - self._lit_ns >= BLACK_NS:
            self.lost = picture.stamp_ns - self._lit_or_opened_ns >= BLACK_LOST_NS
            return "black: nothing can be seen; is the lens covered?"
        self.lost = picture.stamp_ns - self._changed_ns >= FROZEN_NS
        return f"frozen: the picture has not changed for {FROZEN_NS / SECOND_NS:g} s" if self.lost else None


class BackOff:
    """Exponential back-off: waits twice as long after each failure, up to a limit."""

    FIRST_NS = SECOND_NS // 2
    """First wait: short, for a plug that was loose for a moment."""
    LONGEST_NS = 8 * SECOND_NS
    """Longest wait for a camera that has been plugged in again."""

    def __init__(self) -> None:
        self._wait_ns = self.FIRST_NS

    def failed(self) -> int:
        """Return how long to wait now (ns)."""
        wait_ns, self._wait_ns = self._wait_ns, min(2 * self._wait_ns, self.LONGEST_NS)
        return wait_ns

    def worked(self) -> None:
        """Restart with the shortest wait: the camera gave a picture."""
        self._wait_ns = self.FIRST_NS
