"""What the classifier remembers of each agent: frames in order, as long as the longest segment reaches."""

import math
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.messages import Joint, Posture
from actum.node import SECOND_NS
from actum.skeletons import INDEX
from actum.stamps import Order, StampGuard
from som_classifier.movement import Movement, MovementFilter

Array = NDArray[np.float64]
Encode = Callable[["Frame"], Any]
"""Makes of a valid frame what a model needs; called with one agent's frames in order."""

LONGEST_NS = 60 * SECOND_NS
SKEW_NS = 2 * SECOND_NS
MEMORY_NS = LONGEST_NS + SKEW_NS
FURTHEST_M = 100.0
TORSO = INDEX["torso"]
NOWHERE = (np.nan, np.nan, np.nan)


@dataclass
class Frame:
    """One posture as the recogniser needs it.

    `joints` (15, 3) scaled egocentric, `motion` (5,) and `movement` are None where the frame is not valid, joints NaN
    where the source lacks them, which `missing` counts out; `previous_ns` is the captured frame before it, of whatever
    agents; `missed` counts the frames lost just before it; `depth_inferred` tells that distances follow from a picture
    and a body's usual size; `code` is what the model in use makes of it; `reason` is why the preprocessor could not use
    it.
    """

    stamp_ns: int
    previous_ns: int | None
    agents: tuple[int, ...]
    missed: int
    distance_m: float
    joints: NDArray[np.float64] | None
    motion: NDArray[np.float64] | None
    movement: Movement | None = None
    missing: tuple[int, ...] = ()
    depth_inferred: bool = False
    code: Any = None
    reason: str | None = None

    @property
    def valid(self) -> bool:
        """Whether the frame holds a posture."""
        return self.joints is not None


def frame_of(posture: Posture, lost: int, movement: MovementFilter) -> Frame:
    """Take what is needed from a message; `lost` frames are missing before it on its own key."""
    measured = _measured(posture)
    frame = Frame(
        posture.stamp_ns,
        posture.previous_ns,
        tuple(posture.agents),
        posture.missed + lost,
        _distance_m(posture),
        None,
        None,
        reason=posture.reason,
    )
    if measured is not None:
        frame.joints, frame.motion, upright = measured
        frame.movement = movement.step(posture.stamp_ns, upright)
        frame.depth_inferred = posture.depth_std_m is not None
        frame.missing = tuple(np.flatnonzero(np.isnan(upright[:, 0])).tolist())
    return frame


def _measured(posture: Posture) -> tuple[Array, Array, Array] | None:
    """Read joints, motion and upright joints: none where one is not finite or absurd, or all are missing."""
    if not posture.valid or posture.joints is None or posture.motion is None:
        return None
    joints, motion = points(posture.joints), np.array(posture.motion, dtype=np.float64)
    upright = joints - joints[TORSO] if posture.upright is None else points(posture.upright)
    sound = _is_sound(posture.joints, joints) and _is_sound(posture.upright or posture.joints, upright)
    return (joints, motion, upright) if sound and (np.abs(motion) < FURTHEST_M).all() else None


def _is_sound(listed: Sequence[Joint], read: Array) -> bool:
    """Tell whether there are joints, each finite and near."""
    missing = listed.count(None)
    return missing < len(listed) and np.count_nonzero(np.abs(read) < FURTHEST_M) == read.size - 3 * missing


def points(joints: Sequence[Joint]) -> Array:
    """Return joints as (15, 3), NaN where one is missing."""
    if None not in joints:
        return np.array(joints, dtype=np.float64)
    return np.array([NOWHERE if joint is None else joint for joint in joints], dtype=np.float64)


def _distance_m(posture: Posture) -> float:
    """How far the agent's origin is from the camera."""
    if posture.ego_from_camera is None:
        return math.inf
    return math.hypot(*posture.ego_from_camera[3:12:4])


class Stream:
    """One agent's postures, stamps rising."""

    def __init__(self, encode: Encode | None = None) -> None:
        self._frames: deque[Frame] = deque()
        self._order = StampGuard()
        self._last_seq: int | None = None
        self._movement = MovementFilter()
        self._encode = encode

    def use(self, encode: Encode) -> None:
        """Encode all frames anew, and those to come."""
        self._encode = encode
        for frame in self._frames:
            self._add_code(frame)

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
        frame = frame_of(posture, self._lost(posture.seq, order), self._movement)
        self._add_code(frame)
        self._frames.append(frame)
        while self._frames[0].stamp_ns < frame.stamp_ns - MEMORY_NS:
            self._frames.popleft()
        return order, frame

    def _add_code(self, frame: Frame) -> None:
        if self._encode is not None and frame.valid:
            frame.code = self._encode(frame)

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
        self._encoders: Callable[[], Encode] | None = None
        self.newest_ns: int | None = None

    def use(self, encoders: Callable[[], Encode]) -> None:
        """Encode every agent's frames by an encoder of its own, those remembered and those to come."""
        self._encoders = encoders
        for stream in self._streams.values():
            stream.use(encoders())

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
        if posture.agent not in self._streams:
            self._streams[posture.agent] = Stream(self._encoders() if self._encoders else None)
        order, frame = self._streams[posture.agent].add(posture)
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

    def why_not(self, start_ns: int, end_ns: int) -> str | None:
        """Return why the first frame of anybody that could not be used could not; None where there is none."""
        reasons = (
            (frame.stamp_ns, agent, frame.reason)
            for agent, stream in self._streams.items()
            for frame in stream.between(start_ns, end_ns)
            if agent and frame.reason is not None
        )
        return min(reasons, default=(0, 0, None))[2]

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
