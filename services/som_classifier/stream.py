"""One agent's frames in order, kept for as long as the longest segment reaches back; activities of old ones are not.

A frame's activity takes most of the memory, and only marks that come late need old ones, which are then computed anew.
"""

from collections.abc import Callable
from typing import Any

from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.losses import StreamBuffer
from actum.messages import Posture
from actum.node import SECOND_NS
from actum.stamps import LostFrames, Order, StampGuard
from som_classifier.frames import Frame, Stretch, frame_of
from som_classifier.kinematics import KinematicsFilter
from som_classifier.open_segments import FAR_FUTURE_NS
from som_classifier.segments import ClosedSegment, OpenSegment, with_cause
from som_classifier.spotting.search import Search

Encode = Callable[[Frame], Any]
"""Returns what a model needs of a valid frame; called with one agent's frames in order, from any of them on."""

MEMORY_NS = MAX_SEGMENT_NS + MAX_SKEW_NS
"""Frames are kept for this long (ns), so that a segment of any length is whole when its late end mark comes."""
ACTIVITY_NS = 5 * SECOND_NS
"""Activities are kept for this long at least (ns), longer where the search or an open segment needs them: few marks
come later."""
FORGETTING_NS = SECOND_NS
"""How often old activities are forgotten (ns)."""


class Stream(StreamBuffer[Frame]):
    """One agent's frames, stamps rising.

    Attributes:
        search: finds the actions in it that nobody marked.
        newest_valid_ns: stamp of the newest valid frame, -1 where there is none.
    """

    def __init__(self, encoders: Callable[[], Encode] | None, search: Search) -> None:
        super().__init__(MEMORY_NS)
        self.search = search
        self.newest_valid_ns = -1
        self._guard = StampGuard()
        self._lost = LostFrames()
        self._smoothing = KinematicsFilter()
        self._encoders = encoders
        self._encode = encoders() if encoders else None
        self._encoded_ns = -1  # frames from this stamp on have activities, all by the same encoder
        self._needed_ns = FAR_FUTURE_NS  # the oldest activity that was asked for since some were forgotten
        self._next_forgetting_ns = -1
        self._flawed_ns = -1

    def use(self, encoders: Callable[[], Encode]) -> None:
        """Encode frames by another model's encoders: those to come, and those kept once they are needed."""
        self._encoders, self._encode = encoders, encoders()
        self._forget_activities(self.newest_ns + 1)

    def add(self, posture: Posture) -> tuple[Order, Frame | None]:
        """Keep the next posture as a frame; None for a stale one, which is not kept. A restart forgets the others."""
        order = self._guard.judge(posture.stamp_ns)
        if order is Order.STALE:
            return order, None
        if order is Order.RESTART:
            self.clear()
            self.newest_valid_ns = self._flawed_ns = self._encoded_ns = self._next_forgetting_ns = -1
            self.search.restart()
        frame = frame_of(posture, self._lost.before(posture.seq, order), self._smoothing)
        if frame.missing or frame.missed or not frame.valid:
            self._flawed_ns = frame.stamp_ns
        if frame.valid:
            self.newest_valid_ns = frame.stamp_ns
        self._encode_valid(frame)
        self.append(frame)
        if frame.stamp_ns >= self._next_forgetting_ns:
            oldest_ns = frame.stamp_ns - max(ACTIVITY_NS, self.search.memory_ns)
            self._forget_activities(min(oldest_ns, self._needed_ns))
            self._next_forgetting_ns, self._needed_ns = frame.stamp_ns + FORGETTING_NS, FAR_FUTURE_NS
        return order, frame

    def _encode_valid(self, frame: Frame) -> None:
        if self._encode is not None and frame.valid:
            frame.activity = self._encode(frame)

    def _forget_activities(self, before_ns: int) -> None:
        for frame in self.between(self._encoded_ns, before_ns - 1):
            frame.activity = None
        self._encoded_ns = max(before_ns, self._encoded_ns)

    def _encoded(self, start_ns: int, end_ns: int) -> list[Frame]:
        """List frames as `between` does, all with their activities, computed anew where these are forgotten."""
        self._needed_ns = min(self._needed_ns, start_ns)
        if start_ns < self._encoded_ns and self._encoders is not None:
            twice_as_old_ns = 2 * self._encoded_ns - self.newest_ns  # marks from the newest to the oldest cost less
            self._encode, self._encoded_ns = self._encoders(), min(start_ns, twice_as_old_ns)
            for frame in self.between(self._encoded_ns, FAR_FUTURE_NS):
                self._encode_valid(frame)
        return self.between(start_ns, end_ns)

    def stretch(self, start_ns: int, end_ns: int) -> Stretch:
        """Sum up the frames with start <= stamp <= end: at once where the newest that lacks anything is before them."""
        frames = self._encoded(start_ns, end_ns)
        return Stretch(frames, 0, []) if self._flawed_ns < start_ns else Stretch.of(frames)

    def cut(self, segment: OpenSegment) -> ClosedSegment:
        """Close a segment that has an end, with those of its frames that have come."""
        assert segment.end_ns is not None
        frames = self._encoded(segment.start_ns or 0, segment.end_ns)
        reason = None
        if not any(frame.valid for frame in frames):
            cause = next((frame.reason for frame in frames if frame.reason is not None), None)
            reason = with_cause("no usable frame", cause) if frames else "no person"
        missed = sum(frame.missed for frame in frames) + self._missed_after(segment.end_ns)
        return segment.closed(frames, missed, reason)

    def _missed_after(self, end_ns: int) -> int:
        """Return how many frames were lost between the last frame before `end_ns` and the next one; 0 where unknown."""
        following = self.between(end_ns, FAR_FUTURE_NS)
        return following[0].missed if following and following[0].stamp_ns > end_ns else 0
