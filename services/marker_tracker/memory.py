"""Objects that a hand has just covered are still there: they stay listed for a while."""

from actum.messages import TrackedObject


class Memory:
    """Keeps each object's last sighting for `memory_ns`, measured by stamps."""

    def __init__(self, memory_ns: int) -> None:
        self._memory_ns = memory_ns
        self._sightings: dict[int, tuple[int, TrackedObject]] = {}

    def update(self, stamp_ns: int, seen: list[TrackedObject]) -> list[TrackedObject]:
        """Take the objects seen at an instant; return these and the remembered ones, by id."""
        self._sightings.update({found.id: (stamp_ns, found) for found in seen})
        self._sightings = {
            number: (last_ns, found)
            for number, (last_ns, found) in self._sightings.items()
            if stamp_ns - last_ns <= self._memory_ns
        }
        return [self._recalled(stamp_ns, *self._sightings[number]) for number in sorted(self._sightings)]

    def clear(self) -> None:
        """Forget everything: the source has started anew."""
        self._sightings.clear()

    def _recalled(self, stamp_ns: int, last_ns: int, found: TrackedObject) -> TrackedObject:
        """Leave an object as it was seen just now; let confidence fall to 0 over the memory's length."""
        if last_ns == stamp_ns:
            return found
        fading = 1.0 - (stamp_ns - last_ns) / self._memory_ns
        return found.model_copy(update={"seen": False, "confidence": found.confidence * fading})
