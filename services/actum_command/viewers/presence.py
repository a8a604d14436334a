"""Keeps track of who and what was in the newest message, so that a viewer can take away what has gone."""

from collections.abc import Collection


class Presence:
    """The numbers of the people, or of the objects, that each sensor named last."""

    def __init__(self) -> None:
        self._last: dict[str, set[int]] = {}

    def departed(self, sensor: str, present: Collection[int]) -> list[int]:
        """Note who is present; return, sorted, the numbers that the sensor named before and names no more."""
        before, self._last[sensor] = self._last.get(sensor, set()), {*present}
        return sorted(before - self._last[sensor])
