"""How long a device may give nothing."""

import time
from collections.abc import Callable

from sensor_gateway.camera.capture import OPENING_S, SILENT_S, CameraLostError


class Silence:
    """Counts from the last sign of life; the first may take longer."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        self._now_s = now_s
        self._heard_s, self._allowed_s = now_s(), OPENING_S

    def passed(self, heard: bool) -> None:
        """Begin anew where there was a picture, and else let a silence pass that is not too long.

        Raises:
            CameraLostError: it is.
        """
        if heard:
            self._heard_s, self._allowed_s = self._now_s(), SILENT_S
        elif self._now_s() - self._heard_s > self._allowed_s:
            raise CameraLostError(f"no picture for {self._allowed_s:g} s")
