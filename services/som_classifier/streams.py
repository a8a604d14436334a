"""Each agent's frames in order, kept for as long as the longest segment reaches back."""

from collections import deque
from collections.abc import Callable, Iterator
from itertools import chain
from typing import Any

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS, MOST_FRAMES, MOST_STREAMS
from actum.messages import Posture
from actum.node import Counters
from actum.stamps import LostFrames, Order, StampGuard
from som_classifier.frames import Frame, frame_of
from som_classifier.kinematics import KinematicsFilter
from som_classifier.segments import ClosedSegment, OpenSegment, why_no_recognition
from som_classifier.spotting.search import NO_SEARCH, Search, SearchPlan

Encode = Callable[[Frame], Any]
"""Returns what a model needs of a valid frame; called with one agent's frames in order."""

MEMORY_NS = MAX_SEGMENT_NS + MAX_SKEW_NS
"""Frames are kept for this long (ns), so that a segment of any length is whole when its late end mark comes."""


FAR_FUTURE_NS = 2**62
"""Stands for the end of what has none: later than any stamp."""


class Stream:
    """One agent's postures, stamps rising.

    Attributes:
        search: finds the actions in it that nobody marked; None where a stream is only to be cut by marks.
    """

    def __init__(self, encode: Encode | None = None, search: Search | None = None) -> None:
        self.search = search
        self._frames: deque[Frame] = deque()
        self._order = StampGuard()
        self._lost = LostFrames()
        self._smoothing = KinematicsFilter()
        self._encode = encode

    def use(self, encode: Encode) -> None:
        """Encode all frames, those kept and those to come, by this encoder."""
        self._encode = encode
        for frame in self._frames:
            self._encode_valid(frame)

    @property
    def newest_ns(self) -> int:
        """The newest stamp, -1 before the first."""
        return self._frames[-1].stamp_ns if self._frames else -1

    def add(self, posture: Posture) -> tuple[Order, Frame | None]:
        """Keep the next posture as a frame; None for a stale one, which is not kept. A restart forgets the others."""
        order = self._order.judge(posture.stamp_ns)
        if order is Order.STALE:
            return order, None
        if order is Order.RESTART:
            self._frames.clear()
            if self.search is not None:
                self.search.restart()
        frame = frame_of(posture, self._lost.before(posture.seq, order), self._smoothing)
        self._encode_valid(frame)
        self._frames.append(frame)
        while self._frames[0].stamp_ns < frame.stamp_ns - MEMORY_NS:
            self._frames.popleft()
        return order, frame

    def __len__(self) -> int:
        return len(self._frames)

    def let_go(self) -> None:
        """Forget the oldest frame."""
        self._frames.popleft()

    def _encode_valid(self, frame: Frame) -> None:
        if self._encode is not None and frame.valid:
            frame.activity = self._encode(frame)

    def between(self, start_ns: int, end_ns: int) -> list[Frame]:
        """List the frames with start <= stamp <= end, in order."""
        newest_first = []
        for frame in reversed(self._frames):
            if frame.stamp_ns < start_ns:
                break
            if frame.stamp_ns <= end_ns:
                newest_first.append(frame)
        return newest_first[::-1]

    def missed_after(self, end_ns: int) -> int:
        """Return how many frames were lost between the last frame before `end_ns` and the next one; 0 where unknown."""
        following = None
        for frame in reversed(self._frames):
            if frame.stamp_ns == end_ns:
                return 0
            if frame.stamp_ns < end_ns:
                break
            following = frame
        return following.missed if following is not None else 0

    def __iter__(self) -> Iterator[Frame]:
        return iter(self._frames)

    def cut(self, segment: OpenSegment) -> ClosedSegment:
        """Close a segment that has an end, with those of its frames that have come."""
        assert segment.end_ns is not None
        frames = self.between(segment.start_ns or 0, segment.end_ns)
        missed = sum(frame.missed for frame in frames) + self.missed_after(segment.end_ns)
        return segment.closed(frames, missed, why_no_recognition(frames))


class Streams:
    """The streams of the agents heard last, and the newest stamp among them.

    They hold `MOST_FRAMES` together at the most, and of those that are too many the longest ones' oldest go.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._streams: dict[int, Stream] = {}
        self._encoders: Callable[[], Encode] | None = None
        self._plan = NO_SEARCH
        self.newest_ns: int | None = None

    def use(self, encoders: Callable[[], Encode], plan: SearchPlan = NO_SEARCH) -> None:
        """Encode every agent's frames by an encoder of its own, kept ones and those to come; search the latter."""
        self._encoders, self._plan = encoders, plan
        for stream in self._streams.values():
            stream.use(encoders())
            if stream.search is not None:
                stream.search.use(plan)

    def adjust(self, plan: SearchPlan) -> None:
        """Search every agent's frames by another plan for the same model."""
        self._plan = plan
        for stream in self._streams.values():
            if stream.search is not None:
                stream.search.adjust(plan)

    def __iter__(self) -> Iterator[Frame]:
        return chain.from_iterable(self._streams.values())

    def of(self, agent: int) -> Stream | None:
        """Return an agent's stream, if there is one."""
        return self._streams.get(agent)

    def clear(self) -> None:
        """Forget everything."""
        self._streams.clear()
        self.newest_ns = None

    def add(self, posture: Posture) -> tuple[Order, Frame | None]:
        """Keep the next posture of its agent, as `Stream.add` does."""
        stream = self._streams.pop(posture.agent) if posture.agent in self._streams else self._begun(posture)
        self._streams[posture.agent] = stream  # behind those heard before it
        order, frame = stream.add(posture)
        if frame is not None:
            self._advance(posture.stamp_ns)
            self._make_room()
        return order, frame

    def _begun(self, posture: Posture) -> Stream:
        return Stream(self._encoders() if self._encoders else None, Search(posture, self._plan))

    def _make_room(self) -> None:
        """Forget the agent silent for longest where there are too many, and the oldest frame where that is."""
        if len(self._streams) > MOST_STREAMS:
            silent = next(iter(self._streams))
            del self._streams[silent]
            self._counters.reject("too_many_people", f"more than {MOST_STREAMS}: agent {silent} is forgotten")
        if sum(map(len, self._streams.values())) > MOST_FRAMES:
            longest = max(self._streams.values(), key=len)
            longest.let_go()
            self._counters.reject("too_many_frames", f"more than {MOST_FRAMES} in a minute: the oldest is forgotten")

    def reached(self, agent: int, stamp_ns: int) -> bool:
        """Tell whether an agent's newest frame is at a stamp or after it."""
        return agent in self._streams and self._streams[agent].newest_ns >= stamp_ns

    def first(self, start_ns: int, end_ns: int) -> tuple[int, int] | None:
        """Return stamp and agent of the first valid frame within these bounds, of several the nearest to the camera."""
        valid = (
            (frame.stamp_ns, frame.distance_m, agent)
            for agent, stream in self._streams.items()
            for frame in stream.between(start_ns, end_ns)
            if agent and frame.valid
        )
        stamp_ns, _, agent = min(valid, default=(None, None, 0))
        return None if stamp_ns is None else (stamp_ns, agent)

    def nearest(self, start_ns: int, end_ns: int) -> int | None:
        """Return the agent nearest to the camera at the first valid frame within bounds, once that is certain."""
        first = self.first(start_ns, end_ns)
        return first[1] if first is not None and self.complete(start_ns, first[0]) else None

    def since(self, start_ns: int) -> list[Frame]:
        """List everybody's frames from a stamp on, stamps rising; where there is none, the newest one before it."""
        listed = chain.from_iterable(stream.between(start_ns, FAR_FUTURE_NS) for stream in self._streams.values())
        newest = (stream.between(stream.newest_ns, stream.newest_ns) for stream in self._streams.values())
        frames = list(listed) or list(chain.from_iterable(newest))
        return sorted(frames, key=lambda frame: frame.stamp_ns)

    def first_reason(self, start_ns: int, end_ns: int) -> str | None:
        """Return the reason of the first frame that the preprocessor could not use; None where there is none."""
        reasons = (
            (frame.stamp_ns, agent, frame.reason)
            for agent, stream in self._streams.items()
            for frame in stream.between(start_ns, end_ns)
            if agent and frame.reason is not None
        )
        return min(reasons, default=(0, 0, None))[2]

    def complete(self, start_ns: int, end_ns: int) -> bool:
        """Tell whether every captured frame from the start to the end has come, for every agent in it.

        Once the newest stamp is more than the longest delay past the end, frames that have not come count as lost.
        """
        if self.newest_ns is not None and self.newest_ns > end_ns + MAX_SKEW_NS:
            return True
        frames = [frame for stream in self._streams.values() for frame in stream.between(start_ns, end_ns)]
        arrived_ns = {frame.stamp_ns for frame in frames}
        agents = {agent for frame in frames for agent in frame.agents}
        linked = all(f.previous_ns is None or f.previous_ns < start_ns or f.previous_ns in arrived_ns for f in frames)
        return linked and all(self.reached(agent, end_ns) for agent in agents)

    def _advance(self, stamp_ns: int) -> None:
        """Advance the newest stamp, and forget agents that are silent.

        A stamp that is far from the newest one replaces it, so that an absurd one counts only until the next.
        """
        if self.newest_ns is None or abs(stamp_ns - self.newest_ns) > MEMORY_NS:
            self.newest_ns = stamp_ns
        self.newest_ns = max(stamp_ns, self.newest_ns)
        for agent, stream in list(self._streams.items()):
            if abs(stream.newest_ns - self.newest_ns) > MEMORY_NS:
                del self._streams[agent]
