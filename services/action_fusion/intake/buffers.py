"""The recent past of the streams, long enough for the longest segment and the latest action."""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from action_fusion.intake.columns import Columns
from action_fusion.intake.stream_samples import HANDS, ObjectsSample, PostureSample, Sample
from actum.arrays import Array, Indices, Mask
from actum.limits import MAX_SEGMENT_NS, MOST_FRAMES, MOST_STREAMS
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


UNKNOWN_HANDS = np.full((len(HANDS), 3), np.nan)
"""The hands of an invalid posture."""

S = TypeVar("S", bound=Sample)


class Hands(NamedTuple):
    """Where a person's hands were: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 2, 3) of right and left
    hand in the camera frame, NaN where unknown."""

    stamps_ns: Array
    positions_m: Array


class Sightings(NamedTuple):
    """Where an object was: `stamps_ns` (n,) from the segment's start, `positions_m` (n, 3) in the camera frame; `seen`
    (n,) tells sightings from positions that were tracked in the image."""

    stamps_ns: Array
    positions_m: Array
    seen: Mask


class Buffer(StreamBuffer[S]):
    """Samples of one stream with rising stamps, the last `KEPT_NS` of them."""

    def __init__(self) -> None:
        super().__init__(KEPT_NS)
        self._guard = StampGuard()
        self._stamps, self._sessions = Columns(np.int64), Columns(np.int64)

    def append(self, sample: S) -> None:
        """Add the next sample, and forget the samples that are too old."""
        super().append(sample)
        self._stamps.append(sample.stamp_ns, len(self))
        self._sessions.append(hash(sample.session_id), len(self))

    def judge(self, sample: S) -> Order:
        """Judge a sample's order in the stream; a new session counts as a restart only if the stamp went back."""
        order = self._guard.judge(sample.stamp_ns, sample.session_id)
        return Order.NEXT if sample.stamp_ns > self.newest_ns else order

    def stamps_since(self, start_ns: int) -> NDArray[np.int64]:
        """Return the stamps from `MEMORY_NS` before a segment's start on."""
        stamps_ns: NDArray[np.int64] = self._stamps.newest(len(self))
        return stamps_ns[stamps_ns.searchsorted(start_ns - MEMORY_NS) :]

    def of_segment(self, start_ns: int, end_ns: int) -> list[S]:
        """List the samples of a segment and of `MEMORY_NS` before it, in the session of the last sample.

        Samples before a gap of `LOOK_BACK_NS` or more that precedes the segment are left out.
        """
        rows, _ = self._rows_of_segment(start_ns, end_ns)
        return self._samples[rows[0] : rows[-1] + 1] if _in_a_row(rows) else [self._samples[row] for row in rows]

    def _rows_of_segment(self, start_ns: int, end_ns: int) -> tuple[Indices, NDArray[np.int64]]:
        """Return the rows of these samples among the newest ones, (n,), and their stamps (n,)."""
        all_ns, sessions = self._stamps.newest(len(self)), self._sessions.newest(len(self))
        first, beyond = all_ns.searchsorted((start_ns - MEMORY_NS, end_ns + 1)).tolist()
        rows = first + (sessions[first:beyond] == sessions[beyond - 1 : beyond]).nonzero()[0]
        stamps_ns = all_ns[rows]
        if len(rows) and start_ns - stamps_ns[-1] >= LOOK_BACK_NS:
            return rows[:0], stamps_ns[:0]
        gaps = (np.minimum(stamps_ns[1:], start_ns) - stamps_ns[:-1] >= LOOK_BACK_NS).nonzero()[0]
        unbroken = gaps[-1] + 1 if len(gaps) else 0
        return rows[unbroken:], stamps_ns[unbroken:]


def _in_a_row(rows: Indices) -> bool:
    """Tell whether rows (n,), rising, are one or more without a gap between them."""
    return len(rows) > 0 and int(rows[-1] - rows[0]) + 1 == len(rows)


class PostureBuffer(Buffer[PostureSample]):
    """One person's postures, and the hands' positions apart from them."""

    def __init__(self) -> None:
        super().__init__()
        self._hands = Columns(np.float64, *UNKNOWN_HANDS.shape)
        self._people = Columns(np.int64)

    def append(self, sample: PostureSample) -> None:
        """Add the next posture."""
        super().append(sample)
        self._hands.append(UNKNOWN_HANDS if sample.body is None else sample.body.hands_m, len(self))
        self._people.append(hash(sample.agents), len(self))

    def hands_of_segment(self, start_ns: int, end_ns: int) -> Hands:
        """Return the hands of the postures that `of_segment` lists."""
        rows, stamps_ns = self._rows_of_segment(start_ns, end_ns)
        return Hands((stamps_ns - start_ns).astype(np.float64), self._hands.newest(len(self))[rows])

    def people_of_segment(self, start_ns: int, end_ns: int) -> dict[int, int]:
        """Return the people in the images of these postures, and the stamp at which each was in one last (ns)."""
        rows, stamps_ns = self._rows_of_segment(start_ns, end_ns)
        people = self._people.newest(len(self))[rows]
        last_ns: dict[int, int] = {}
        for row in [*(people[1:] != people[:-1]).nonzero()[0].tolist(), *range(len(rows))[-1:]]:
            last_ns |= dict.fromkeys(self._samples[rows[row]].agents, int(stamps_ns[row]))
        return last_ns


class PostureBuffers(dict[int, PostureBuffer]):
    """The streams of all people by their numbers, `MOST_STREAMS` at the most, the one used last at the end."""

    def __init__(self, counters: Counters) -> None:
        super().__init__()
        self._counters = counters

    @property
    def newest_ns(self) -> int:
        """Stamp of the newest posture of anybody, -1 where there is none."""
        return max((buffer.newest_ns for buffer in self.values()), default=-1)

    def of(self, agent: int) -> PostureBuffer:
        """Return a person's stream; where there are too many, an empty one or the one used least recently goes."""
        buffer = self.pop(agent) if agent in self else PostureBuffer()
        if len(self) == MOST_STREAMS:
            gone = next((each for each, kept in self.items() if not kept), next(iter(self)))
            if self.pop(gone):
                self._counters.reject("too_many_people", f"more than {MOST_STREAMS}: agent {gone} is forgotten")
        self[agent] = buffer
        return buffer

    def others(self, agent: int, start_ns: int, end_ns: int) -> list[tuple[PostureBuffer | None, int]]:
        """List the streams of the other people in the images of a segment, and when each was in one last (ns)."""
        last_ns = self.of(agent).people_of_segment(start_ns, end_ns)
        return [(self.get(other), last) for other, last in sorted(last_ns.items()) if other != agent]

    def make_room(self) -> None:
        """Forget the oldest posture of whom most are kept of, where there are too many."""
        if sum(map(len, self.values())) > MOST_FRAMES:
            max(self.values(), key=len).let_go()
            self._counters.reject("too_many_frames", f"more than {MOST_FRAMES} postures in a minute")


class ObjectsBuffer(Buffer[ObjectsSample]):
    """The messages of objects, and the positions of each object apart from them."""

    def __init__(self) -> None:
        super().__init__()
        self._positions: dict[int, tuple[Columns, Columns]] = {}

    def append(self, sample: ObjectsSample) -> None:
        """Add the next message, and forget the objects that were in none that is kept."""
        super().append(sample)
        for number, position_m in sample.positions_m.items():
            if number not in self._positions:
                self._positions[number] = Columns(np.int64), Columns(np.float64, 4)
            stamps, rows = self._positions[number]
            stamps.append(sample.stamp_ns, len(self))
            rows.append((*position_m, number not in sample.image_tracked), len(self))
        if len(self._positions) > len(sample.positions_m):
            oldest_ns = next(iter(self)).stamp_ns
            kept = {number: each for number, each in self._positions.items() if each[0].newest(1)[0] >= oldest_ns}
            self._positions = kept

    def clear(self) -> None:
        """Forget everything, after a restart of the stream."""
        super().clear()
        self._positions.clear()

    def sightings_of_segment(self, start_ns: int, end_ns: int) -> dict[int, Sightings]:
        """Return where each object was, by its number, in the messages that `of_segment` lists."""
        listed, listed_ns = self._rows_of_segment(start_ns, end_ns)
        found, bounds_ns = {}, listed_ns[[0, -1]] + [0, 1] if len(listed) else listed_ns
        for number, (stamps, rows) in sorted(self._positions.items() if len(listed) else ()):
            all_ns = stamps.newest(min(len(stamps), len(self)))
            first, beyond = all_ns.searchsorted(bounds_ns).tolist()
            own_ns, own = all_ns[first:beyond], rows.newest(len(all_ns))[first:beyond]
            if not _in_a_row(listed):
                is_listed = np.isin(own_ns, listed_ns)
                own_ns, own = own_ns[is_listed], own[is_listed]
            if len(own):
                stamps_ns = (own_ns - start_ns).astype(np.float64)
                found[number] = Sightings(stamps_ns, np.ascontiguousarray(own[:, :3]), own[:, 3] > 0)
        return found


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
