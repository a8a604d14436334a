"""What the classifier remembers of each agent: frames in order, as long as the longest segment reaches."""

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from actum import geometry
from actum.messages import Posture
from actum.node import SECOND_NS
from actum.stamps import Order, StampGuard

MEMORY_NS = 62 * SECOND_NS


@dataclass
class Frame:
    """One posture as the recogniser needs it.

    `joints` (15, 3) scaled egocentric and `motion` (5,) are None where the frame is not valid; `missed` counts
    the frames lost just before it; `cells` (5,) are its best-matching units once a model has seen it.
    """

    stamp_ns: int
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
    missed = posture.missed + lost
    agents = tuple(posture.agents)
    if not posture.valid or posture.joints is None or posture.motion is None or None in posture.joints:
        return Frame(posture.stamp_ns, agents, missed, np.inf, None, None)
    joints = np.array(posture.joints, dtype=np.float64)
    motion = np.array(posture.motion, dtype=np.float64)
    if not np.isfinite(joints).all():
        return Frame(posture.stamp_ns, agents, missed, np.inf, None, None)
    return Frame(posture.stamp_ns, agents, missed, _distance_m(posture), joints, motion)


def _distance_m(posture: Posture) -> float:
    """How far the agent's origin is from the camera."""
    if posture.ego_from_camera is None:
        return float("inf")
    return float(np.linalg.norm(geometry.from_flat(posture.ego_from_camera)[:3, 3]))


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
