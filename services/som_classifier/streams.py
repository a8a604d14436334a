"""What the classifier remembers of each agent: frames in order, as long as the longest segment reaches."""

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from actum.messages import Posture
from actum.node import SECOND_NS
from actum.stamps import Order, StampGuard

LONGEST_NS = 60 * SECOND_NS
SKEW_NS = 2 * SECOND_NS
MEMORY_NS = LONGEST_NS + SKEW_NS
FURTHEST_M = 100.0


@dataclass
class Frame:
    """One posture as the recogniser needs it.

    `joints` (15, 3) scaled egocentric and `motion` (5,) are None where the frame is not valid; `previous_ns` is
    the captured frame before it, of whatever agents; `missed` counts the frames lost just before it; `cells` (5,)
    are its best-matching units once a model has seen it.
    """

    stamp_ns: int
    previous_ns: int | None
    agents: tuple[int, ...]
    missed: int
    distance_m: float
    joints: NDArray[np.float64] | None
    motion: NDArray[np.float64] | None
    cells: NDArray[np.intp] | None = None

    @property
    def valid(self) -> bool:
        """Whether the frame holds a posture."""
        return self.joints is not None


def frame_of(posture: Posture, lost: int) -> Frame:
    """Take what is needed from a message; `lost` frames are missing before it on its own key."""
    joints, motion = _measured(posture)
    return Frame(
        posture.stamp_ns,
        posture.previous_ns,
        tuple(posture.agents),
        posture.missed + lost,
        _distance_m(posture),
        joints,
        motion,
    )


def _measured(posture: Posture) -> tuple[NDArray[np.float64], NDArray[np.float64]] | tuple[None, None]:
    """Read joints and motion, both or neither: none where one is missing, not finite or absurd."""
    if not posture.valid or posture.joints is None or posture.motion is None or None in posture.joints:
        return None, None
    joints = np.array(posture.joints, dtype=np.float64)
    motion = np.array(posture.motion, dtype=np.float64)
    if not (np.abs(joints) < FURTHEST_M).all() or not (np.abs(motion) < FURTHEST_M).all():
        return None, None
    return joints, motion


def _distance_m(posture: Posture) -> float:
    """How far the agent's origin is from the camera."""
    if posture.ego_from_camera is None:
        return math.inf
    return math.hypot(*posture.ego_from_camera[3:12:4])


class Stream:
    """One agent's postures, stamps rising."""

    def __init__(self) -> None:
        self._frames: deque[Frame] = deque()
        self._order = StampGuard()
        self._last_seq: int | None = None

    @property
    def newest_ns(self) -> int:
        """The newest stamp, -1 before the first."""
        return self._frames[-1].stamp_ns if self._frames else -1

    def add(self, posture: Posture) -> tuple[Order, Frame | None]:
        """Take the next posture; a stale one is not kept, a restart forgets what was before."""
        order = self._order.judge(posture.stamp_ns)
        if order is Order.STALE:
            return order, None
        if order is Order.RESTART:
            self._frames.clear()
        frame = frame_of(posture, self._lost(posture.seq, order))
        self._frames.append(frame)
        while self._frames[0].stamp_ns < frame.stamp_ns - MEMORY_NS:
            self._frames.popleft()
        return order, frame

    def _lost(self, seq: int | None, order: Order) -> int:
        last, self._last_seq = self._last_seq, seq
        if last is None or seq is None or order is Order.RESTART:
            return 0
        return max(seq - last - 1, 0)

    def between(self, start_ns: int, end_ns: int) -> list[Frame]:
        """List the frames with start <= stamp <= end."""
        newest_first = []
        for frame in reversed(self._frames):
            if frame.stamp_ns < start_ns:
                break
            if frame.stamp_ns <= end_ns:
                newest_first.append(frame)
        return newest_first[::-1]

    def missed_after(self, end_ns: int) -> int:
        """Count the frames lost between `end_ns` and the last frame before it, where that can be told."""
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


class Streams:
    """Every agent's stream, and how far they have come."""

    def __init__(self) -> None:
        self._streams: dict[int, Stream] = {}
        self.newest_ns: int | None = None

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
        """Take the next posture of its agent, as `Stream.add` does."""
        order, frame = self._streams.setdefault(posture.agent, Stream()).add(posture)
        if frame is not None:
            self._advance(posture.stamp_ns)
        return order, frame

    def reached(self, agent: int, stamp_ns: int) -> bool:
        """Tell whether an agent's stream has come as far as this."""
        return agent in self._streams and self._streams[agent].newest_ns >= stamp_ns

    def first(self, start_ns: int, end_ns: int) -> tuple[int, int] | None:
        """Find the first valid frame that has come, the nearest where there are several: its stamp and agent."""
        valid = (
            (frame.stamp_ns, frame.distance_m, agent)
            for agent, stream in self._streams.items()
            for frame in stream.between(start_ns, end_ns)
            if agent and frame.valid
        )
        stamp_ns, _, agent = min(valid, default=(None, None, 0))
        return None if stamp_ns is None else (stamp_ns, agent)

    def complete(self, start_ns: int, end_ns: int) -> bool:
        """Tell whether every captured frame from the start to the end has come, for every agent in it.

        What has not come when one stream is further than any may lag behind another was lost.
        """
        if self.newest_ns is not None and self.newest_ns > end_ns + SKEW_NS:
            return True
        frames = [frame for stream in self._streams.values() for frame in stream.between(start_ns, end_ns)]
        come = {frame.stamp_ns for frame in frames}
        agents = {agent for frame in frames for agent in frame.agents}
        linked = all(f.previous_ns is None or f.previous_ns < start_ns or f.previous_ns in come for f in frames)
        return linked and all(self.reached(agent, end_ns) for agent in agents)

    def _advance(self, stamp_ns: int) -> None:
        """Note how far the streams are; one absurd stamp among them holds only until the next."""
        if self.newest_ns is None or abs(stamp_ns - self.newest_ns) > MEMORY_NS:
            self.newest_ns = stamp_ns
        self.newest_ns = max(stamp_ns, self.newest_ns)
        gone = [agent for agent, stream in self._streams.items() if abs(stream.newest_ns - self.newest_ns) > MEMORY_NS]
        for agent in gone:
            del self._streams[agent]
