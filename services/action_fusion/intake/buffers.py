"""The recent past of the streams, long enough for the longest segment and the latest action."""

from itertools import pairwise
from typing import TypeVar

from action_fusion.intake.stream_samples import Sample
from actum.limits import MAX_SEGMENT_NS
from actum.losses import StreamBuffer
from actum.messages import MOST_OBJECTS, Objects
from actum.node import SECOND_NS, Counters
from actum.stamps import Order, StampGuard

LOOK_BACK_NS = 9 * SECOND_NS // 10
"""How long before a segment an object may have been seen last; a gap in a stream this long separates two recordings,
which are played a second apart."""

MEMORY_NS = 10 * SECOND_NS
"""How long before a segment samples count: a hand may have grasped an object, or come to rest, that early."""

LATEST_ACTION_NS = 4 * SECOND_NS
"""Longest delay of an action after its segment's end: two seconds of waiting, two of skew between streams."""

KEPT_NS = MAX_SEGMENT_NS + MEMORY_NS + LATEST_ACTION_NS
"""How long samples are kept: for the longest segment, the time before it, and the wait for its action."""


S = TypeVar("S", bound=Sample)


class Buffer(StreamBuffer[S]):
    """Samples of one stream with rising stamps, the last `KEPT_NS` of them."""

    def __init__(self) -> None:
        super().__init__(KEPT_NS)
        self._guard = StampGuard()

    def judge(self, sample: S) -> Order:
        """Judge a sample's order in the stream; a new session counts as a restart only if the stamp went back."""
        order = self._guard.judge(sample.stamp_ns, sample.session_id)
        return Order.NEXT if sample.stamp_ns > self.newest_ns else order

    def stamps_since(self, start_ns: int) -> list[int]:
        """List the stamps from `MEMORY_NS` before a segment's start on."""
        return [sample.stamp_ns for sample in self if sample.stamp_ns >= start_ns - MEMORY_NS]

    def of_segment(self, start_ns: int, end_ns: int) -> list[S]:
        """List the samples of a segment and of `MEMORY_NS` before it, in the session of the last sample.

        Samples before a gap of `LOOK_BACK_NS` or more that precedes the segment are left out.
        """
        window = self.between(start_ns - MEMORY_NS, end_ns)
        listed = [sample for sample in window if sample.session_id == window[-1].session_id]
        stamps_ns = [sample.stamp_ns for sample in listed]
        after_gap = [
            i
            for i, (before_ns, then_ns) in enumerate(pairwise([*stamps_ns, end_ns]), start=1)
            if before_ns < start_ns and min(then_ns, start_ns) - before_ns >= LOOK_BACK_NS
        ]
        return listed[after_gap[-1] if after_gap else 0 :]


class KnownObjects:
    """Leaves further objects out once `MOST_OBJECTS` others count: what an event costs grows with their number."""

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._newest_ns: dict[int, int] = {}

    def known(self, message: Objects) -> Objects:
        """Return the message with the objects that are known already or that there is room for."""
        now_ns = message.stamp_ns
        self._newest_ns = {number: ns for number, ns in self._newest_ns.items() if abs(now_ns - ns) <= KEPT_NS}
        kept = []
        for each in message.objects:
            if each.id in self._newest_ns or len(self._newest_ns) < MOST_OBJECTS:
                self._newest_ns[each.id] = now_ns
                kept.append(each)
        if len(kept) == len(message.objects):
            return message
        self._counters.reject("too_many_objects", f"more than {MOST_OBJECTS} in a minute, at {now_ns}")
        return message.model_copy(update={"objects": kept})
