"""The timeout after which a device without pictures counts as lost."""

import time
from collections.abc import Callable

from sensor_gateway.devices.capture import CameraLostError

SILENT_S = 2.0
"""Timeout after a picture: many frame intervals, so that one lost frame does not count as a lost camera."""
OPENING_S = 10.0
"""Timeout before the first picture: opening a stream or starting a depth camera takes longer."""


class Silence:
    """A timeout that each picture restarts; the first picture may take longer."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._heard_s, self._allowed_s = now_s(), OPENING_S

    def heard(self) -> None:
        """Restart the timeout after a picture."""
        self._heard_s, self._allowed_s = self._now_s(), SILENT_S

    def check(self) -> None:
        """Check the timeout.

        Raises:
            CameraLostError: the last picture is too long ago.
        """
        if self._now_s() - self._heard_s > self._allowed_s:
            raise CameraLostError(
                f"the camera sent no picture for {self._allowed_s:g} s: if this repeats, unplug the camera and plug "
                "it in again"
            )
