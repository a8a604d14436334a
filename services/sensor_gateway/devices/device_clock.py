"""A device's own clock, converted to the host's time."""

from collections.abc import Callable


class DeviceClock:
    """Shifts a device's stamps (ns) by one constant, so that the first stamp becomes the host's present time.

    Intervals between stamps are preserved. If the device's stamps fall, its clock has restarted, and the constant is
    determined anew.
    """

    def __init__(self, now_ns: Callable[[], int]) -> None:
        self._now_ns = now_ns
        self._shift_ns = 0
        self._newest_ns: int | None = None

    def stamp_ns(self, device_ns: int) -> int:
        """Return the host's time (ns) of a device's stamp (ns)."""
        if self._newest_ns is None or device_ns < self._newest_ns:
            self._shift_ns = self._now_ns() - device_ns
        self._newest_ns = device_ns
        return device_ns + self._shift_ns
