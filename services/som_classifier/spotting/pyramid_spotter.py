"""The search for actions in one person's stream, by the default recogniser."""

from bisect import bisect_left
from collections.abc import Callable, Sequence
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from actum.losses import StreamBuffer
from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.kinematics import GAP_NS
from som_classifier.spotting.spotted import NOTHING, Ongoing, Spotted, SpottedSegment, Spotter, SpottingOptions
from som_classifier.spotting.spotting_model import SpottingModel, iou_of_completeness

LEAST_PROBABILITY = 0.5
"""Probability from which an action is said to be going on: that it is must be likelier than that it is not."""


Pool = Callable[[Sequence[Frame], Sequence[int]], Sequence[NDArray[np.float32]]]
"""Returns the pyramid vectors (inputs,) of windows of valid frames, each with the activity that the model's encoder
gave: the windows begin at the frames of these indices and end with the last one."""


FEWEST_FRAMES = 4
"""Frames that a window needs: with fewer the pyramid's finest cells hold less than one each."""
COVERED_SHARE = 0.8
"""Share of a duration over which there must be frames: after a gap longer windows come back one after the other."""


_stamp_ns = attrgetter("stamp_ns")


class RecentFrames(StreamBuffer[Frame]):
    """A person's newest valid frames, without a gap.

    Args:
        durations_s: of the windows, rising.
        memory_ns: how long frames are kept, at least as long as the longest window.
    """

    def __init__(self, durations_s: Sequence[float], memory_ns: int) -> None:
        super().__init__(memory_ns)
        self._durations_ns = [round(duration_s * SECOND_NS) for duration_s in durations_s]

    def add(self, frame: Frame) -> bool:
        """Keep the next valid frame; return whether it follows the one before it without a gap."""
        follows = len(self) > 0 and 0 < frame.stamp_ns - self.newest_ns <= GAP_NS
        if not follows:
            self.clear()
        self.append(frame)
        return follows

    def windows(self) -> tuple[list[Frame], list[int]]:
        """Return the frames of the longest window that ends with the newest, and where in it each window begins.

        The shortest window comes first.
        """
        frames = self.between(self.newest_ns - self._durations_ns[-1], self.newest_ns)
        newest_ns, firsts = self.newest_ns, []
        for duration_ns in self._durations_ns:
            first = bisect_left(frames, newest_ns - duration_ns, key=_stamp_ns)
            long_enough = newest_ns - frames[first].stamp_ns >= COVERED_SHARE * duration_ns
            if len(frames) - first >= FEWEST_FRAMES and long_enough:
                firsts.append(first)
        return frames, firsts


class PoolingOnce:
    """Pools each window of a frame once, however many searches of one stream look at it."""

    def __init__(self, pool: Pool) -> None:
        self._pool = pool
        self._newest: Frame | None = None
        self._vectors: dict[int, NDArray[np.float32]] = {}

    def __call__(self, frames: Sequence[Frame], firsts: Sequence[int]) -> list[NDArray[np.float32]]:
        """Return the pyramid vectors (inputs,) of windows that end with the last of these frames."""
        if self._newest is not frames[-1]:
            self._newest, self._vectors = frames[-1], {}
        starts_ns = [frames[first].stamp_ns for first in firsts]
        new = {
            start_ns: first for start_ns, first in zip(starts_ns, firsts, strict=True) if start_ns not in self._vectors
        }
        self._vectors |= zip(new, self._pool(frames, list(new.values())), strict=True)
        return [self._vectors[start_ns] for start_ns in starts_ns]


class PyramidSpotter(Spotter):
    """Looks at all windows that end now, several times a second, and decides which of them were actions.

    Args:
        pool: gives the vectors that the heads are trained on.
        labels: the actions, one for each head.
        learned: its heads and durations.
        options: what is asked of the search.
    """

    def __init__(self, pool: Pool, labels: Sequence[str], learned: SpottingModel, options: SpottingOptions) -> None:
        self._pool, self._labels, self._learned = pool, labels, learned
        metadata = learned.metadata
        self._threshold = metadata.threshold_for(options.false_alarms_per_min)
        self._interval_ns = round(metadata.interval_s * SECOND_NS)
        longest_ns = round(metadata.window_durations_s[-1] * SECOND_NS)
        self._decoder = learned.decoder()
        self._recent = RecentFrames(metadata.window_durations_s, self._decoder.memory_ns + longest_ns)
        self._next_decision_ns = 0
        self._ongoing: Ongoing | None = None

    def use(self, options: SpottingOptions) -> None:
        """Go on with the threshold of other options, and all that was seen so far."""
        self._threshold = self._learned.metadata.threshold_for(options.false_alarms_per_min)

    def step(self, frame: Frame) -> Spotted:
        """Receive the next frame, valid or not; return what it shows."""
        if frame.valid and not self._recent.add(frame):
            self._decoder.forget()
            self._ongoing, self._next_decision_ns = None, frame.stamp_ns
        if not frame.valid:
            return NOTHING
        if frame.stamp_ns < self._next_decision_ns:
            return Spotted(ongoing=self._ongoing)
        self._next_decision_ns = frame.stamp_ns + self._interval_ns
        return self._decision(frame.stamp_ns)

    def _decision(self, now_ns: int) -> Spotted:
        frames, firsts = self._recent.windows()
        if not firsts:
            self._ongoing = None
            return NOTHING
        starts_ns = np.array([frames[first].stamp_ns for first in firsts])
        completeness = np.stack([self._learned.heads.completeness(vector) for vector in self._pool(frames, firsts)])
        ends_ns = np.full(len(firsts), now_ns)
        candidates = self._learned.candidates(starts_ns, ends_ns, completeness, self._threshold)
        decided = self._decoder.step(now_ns, candidates)
        self._ongoing = self._likeliest(starts_ns.tolist(), now_ns, completeness)
        segments = []
        for each in decided:
            first = self._recent.between(each.start_ns, each.end_ns)[0]
            segments.append(SpottedSegment(first.stamp_ns, each.end_ns, self._labels[each.action]))
        return Spotted(tuple(segments), self._ongoing)

    def _likeliest(self, starts_ns: Sequence[int], now_ns: int, completeness: NDArray[np.float32]) -> Ongoing | None:
        """Return the action to which a window that ends now belongs most surely, None where none belongs to any."""
        free = [n for n, start_ns in enumerate(starts_ns) if self._decoder.is_free(start_ns, now_ns)]
        if not free:
            return None
        window = max(free, key=lambda n: float(completeness[n].max()))
        action = int(completeness[window].argmax())
        answer = float(completeness[window, action])
        probability = self._learned.probability(answer)
        if probability < LEAST_PROBABILITY:
            return None
        return Ongoing(starts_ns[window], self._labels[action], probability, iou_of_completeness(answer))
