"""The streams of all agents, and which of their frames are lost."""

from collections.abc import Callable
from itertools import pairwise

from actum.limits import MAX_SKEW_NS, MOST_FRAMES, MOST_STREAMS
from actum.losses import longest_loss_s
from actum.messages import Posture
from actum.node import SECOND_NS, Counters
from actum.stamps import Order
from som_classifier.frames import Frame
from som_classifier.open_segments import FAR_FUTURE_NS
from som_classifier.spotting.search import NO_SEARCH, Search, SearchPlan
from som_classifier.stream import MEMORY_NS, Encode, Stream

BEFORE_NS = SECOND_NS
"""How long before a segment frames are looked at (ns): the one before it tells whether the next one follows it."""


class Streams:
    """The streams of the agents heard last, and the newest stamp among them.

    They hold `MOST_FRAMES` together at the most, and of those that are too many the longest ones' oldest go.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._streams: dict[int, Stream] = {}
        self._encoders: Callable[[], Encode] | None = None
        self._plan = NO_SEARCH
        self._kept = 0
        self.newest_ns: int | None = None
        self._silent_since_ns = FAR_FUTURE_NS  # no agent has been silent for longer

    def use(self, encoders: Callable[[], Encode], plan: SearchPlan = NO_SEARCH) -> None:
        """Encode every agent's frames by an encoder of its own, kept ones when needed; search those to come."""
        self._encoders, self._plan = encoders, plan
        for stream in self._streams.values():
            stream.use(encoders)
            stream.search.use(plan)

    def adjust(self, plan: SearchPlan) -> None:
        """Search every agent's frames by another plan for the same model."""
        self._plan = plan
        for stream in self._streams.values():
            stream.search.adjust(plan)

    @property
    def any_ongoing(self) -> bool:
        """Whether somebody's search sees an action going on."""
        return any(stream.search.is_ongoing for stream in self._streams.values())

    def of(self, agent: int) -> Stream | None:
        """Return an agent's stream, if there is one."""
        return self._streams.get(agent)

    def clear(self) -> None:
        """Forget everything."""
        self._streams.clear()
        self._kept, self.newest_ns, self._silent_since_ns = 0, None, FAR_FUTURE_NS

    def add(self, posture: Posture) -> tuple[Order, Frame | None]:
        """Keep the next posture of its agent, as `Stream.add` does."""
        stream = self._streams.pop(posture.agent, None)
        if stream is None:
            stream = Stream(self._encoders, Search(posture, self._plan))
        self._streams[posture.agent] = stream  # behind those heard before it
        kept = len(stream)
        order, frame = stream.add(posture)
        self._kept += len(stream) - kept
        if frame is not None:
            self._advance(posture.stamp_ns)
            self._make_room()
        return order, frame

    def _make_room(self) -> None:
        """Forget the agent silent for longest where there are too many, and the oldest frame where that is."""
        if len(self._streams) > MOST_STREAMS:
            silent = next(iter(self._streams))
            self._forget(silent)
            self._counters.reject("too_many_people", f"more than {MOST_STREAMS}: agent {silent} is forgotten")
        if self._kept > MOST_FRAMES:
            longest = max(self._streams.values(), key=len)
            longest.let_go()
            self._kept -= 1
            self._counters.reject("too_many_frames", f"more than {MOST_FRAMES} in a minute: the oldest is forgotten")

    def reached(self, agent: int, stamp_ns: int) -> bool:
        """Tell whether an agent's newest frame is at a stamp or after it."""
        return agent in self._streams and self._streams[agent].newest_ns >= stamp_ns

    def first(self, start_ns: int, end_ns: int) -> tuple[int, int] | None:
        """Return stamp and agent of the first valid frame within these bounds, of several the nearest to the camera."""
        valid = (
            (frame.stamp_ns, frame.distance_m, agent)
            for agent, stream in self._streams.items()
            if agent and stream.newest_valid_ns >= start_ns
            for frame in stream.between(start_ns, end_ns)
            if frame.valid
        )
        stamp_ns, _, agent = min(valid, default=(None, None, 0))
        return None if stamp_ns is None else (stamp_ns, agent)

    def nearest(self, start_ns: int, end_ns: int) -> int | None:
        """Return the agent nearest to the camera at the first valid frame within bounds, once that is certain."""
        first = self.first(start_ns, end_ns)
        return first[1] if first is not None and self.complete(start_ns, first[0]) else None

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

    def why_incomplete(self, start_ns: int, end_ns: int, resumed: bool) -> str | None:
        """Return the reason for which frames of a segment are lost; None where enough have come.

        Frames are lost that were captured and have not come, or not to this process.

        Args:
            start_ns: the segment's start.
            end_ns: its end.
            resumed: whether another process was there before this one.
        """
        if any(stream.is_dense(start_ns, end_ns) for stream in self._streams.values()):
            return None
        frames = self._since(start_ns - BEFORE_NS)
        if not frames:
            return "the classifier started late: it has received no frame since its start" if resumed else None
        first, last = frames[0], frames[-1]
        follows_another = first.previous_ns is not None and first.previous_ns >= start_ns
        if follows_another and (late_s := longest_loss_s([(start_ns, first.stamp_ns)], start_ns, end_ns)):
            return f"the classifier started late: its first frame is {late_s:.1f} s after the segment's start"
        if lost_s := longest_loss_s([(last.stamp_ns, end_ns)], start_ns, end_ns):
            return f"frames lost: none came for the last {lost_s:.1f} s of the segment"
        broken = ((b.stamp_ns, min(then.stamp_ns, end_ns)) for b, then in pairwise(frames) if _is_broken(b, then))
        lost_s = longest_loss_s(broken, start_ns, end_ns)
        return None if lost_s is None else f"frames lost: none came for {lost_s:.1f} s of the segment"

    def _since(self, start_ns: int) -> list[Frame]:
        """List everybody's frames from a stamp on, stamps rising; where there is none, the newest one before it."""
        streams = self._streams.values()
        listed = [frame for stream in streams for frame in stream.between(start_ns, FAR_FUTURE_NS)]
        newest = [frame for stream in streams for frame in stream.between(stream.newest_ns, stream.newest_ns)]
        return sorted(listed or newest, key=lambda frame: frame.stamp_ns)

    def _advance(self, stamp_ns: int) -> None:
        """Advance the newest stamp, and forget agents that are silent.

        A stamp that is far from the newest one replaces it, so that an absurd one counts only until the next.
        """
        is_far = self.newest_ns is None or abs(stamp_ns - self.newest_ns) > MEMORY_NS
        self.newest_ns = newest_ns = stamp_ns if is_far else max(stamp_ns, self.newest_ns or 0)
        self._silent_since_ns = min(self._silent_since_ns, stamp_ns)
        if not is_far and newest_ns - self._silent_since_ns <= MEMORY_NS:
            return
        for agent in [agent for agent, each in self._streams.items() if abs(each.newest_ns - newest_ns) > MEMORY_NS]:
            self._forget(agent)
        self._silent_since_ns = min(each.newest_ns for each in self._streams.values())

    def _forget(self, agent: int) -> None:
        self._kept -= len(self._streams.pop(agent))


def _is_broken(before: Frame, then: Frame) -> bool:
    """Tell whether frames were lost between two, or a service before this one began anew."""
    if then.previous_ns is None:
        return before.previous_ns is not None
    return then.missed > 0 or then.previous_ns > before.stamp_ns
