"""The windows of a stream that may be an action which ends now: one for each of some usual durations."""

from collections import deque
from collections.abc import Sequence

from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.kinematics import GAP_NS

FEWEST_FRAMES = 4
"""Frames that a window needs: with fewer the pyramid's finest cells hold less than one each."""
COVERED_SHARE = 0.8
"""Share of a duration over which there must be frames: after a gap longer windows come back one after the other."""


class RecentFrames:
    """A person's newest valid frames, without a gap.

    Args:
        durations_s: of the windows, rising.
        memory_ns: how long frames are kept, at least as long as the longest window.
    """

    def __init__(self, durations_s: Sequence[float], memory_ns: int) -> None:
        self._durations_ns = [round(duration_s * SECOND_NS) for duration_s in durations_s]
        self._memory_ns = memory_ns
        self._frames: deque[Frame] = deque()

    def between(self, start_ns: int, end_ns: int) -> list[Frame]:
        """List the frames with start <= stamp <= end, in order."""
        return [frame for frame in self._frames if start_ns <= frame.stamp_ns <= end_ns]

    def add(self, frame: Frame) -> bool:
        """Keep the next valid frame; return whether it follows the one before it without a gap."""
        follows = bool(self._frames) and 0 < frame.stamp_ns - self._frames[-1].stamp_ns <= GAP_NS
        if not follows:
            self._frames.clear()
        self._frames.append(frame)
        while self._frames[0].stamp_ns < frame.stamp_ns - self._memory_ns:
            self._frames.popleft()
        return follows

    def windows(self) -> list[list[Frame]]:
        """List the windows that end with the newest frame, the shortest first."""
        frames = list(self._frames)
        newest_ns, first, found = frames[-1].stamp_ns, len(frames) - 1, []
        for duration_ns in self._durations_ns:
            while first > 0 and frames[first - 1].stamp_ns >= newest_ns - duration_ns:
                first -= 1
            long_enough = newest_ns - frames[first].stamp_ns >= COVERED_SHARE * duration_ns
            if len(frames) - first >= FEWEST_FRAMES and long_enough:
                found.append(frames[first:])
        return found
