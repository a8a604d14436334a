"""The objects that were seen in the last minute or so, a limited number of them."""

from action_fusion.buffers import KEPT_NS
from actum.messages import MOST_OBJECTS, Objects
from actum.node import Counters


class KnownObjects:
    """Leaves further objects out once `MOST_OBJECTS` others count: what an event costs grows with their number."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._newest_ns: dict[int, int] = {}

    def known(self, message: Objects) -> Objects:
        """Return the message with the objects that are known already or that there is room for."""
        now_ns = message.stamp_ns
        self._newest_ns = {number: ns for number, ns in self._newest_ns.items() if abs(now_ns - ns) <= KEPT_NS}
        kept = [each for each in message.objects if self._has_room_for(each.id, now_ns)]
        if len(kept) == len(message.objects):
            return message
        self._counters.reject("too_many_objects", f"more than {MOST_OBJECTS} in a minute, at {now_ns}")
        return message.model_copy(update={"objects": kept})

    def _has_room_for(self, number: int, now_ns: int) -> bool:
        if number not in self._newest_ns and len(self._newest_ns) >= MOST_OBJECTS:
            return False
        self._newest_ns[number] = now_ns
        return True
