"""The search for actions in one person's stream, by the default recogniser."""

from bisect import bisect_left
from collections.abc import Callable, Sequence

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


Pool = Callable[[Sequence[Frame], Sequence[int]], NDArray[np.float32]]
"""Returns the pyramid vectors (windows, inputs) of windows of valid frames, each with the activity that the model's
encoder gave: the windows begin at the frames of these indices and end with the last one."""


FEWEST_FRAMES = 4
"""Frames that a window needs: with fewer the pyramid's finest cells hold less than one each."""
COVERED_SHARE = 0.8
"""Share of a duration over which there must be frames: after a gap longer windows come back one after the other."""


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
        stamps_ns, newest_ns, firsts = self._stamps_ns, self.newest_ns, []
        oldest = bisect_left(stamps_ns, newest_ns - self._durations_ns[-1])
        for duration_ns in self._durations_ns:
            first = bisect_left(stamps_ns, newest_ns - duration_ns, oldest)
            long_enough = newest_ns - stamps_ns[first] >= COVERED_SHARE * duration_ns
            if len(stamps_ns) - first >= FEWEST_FRAMES and long_enough:
                firsts.append(first - oldest)
        return self._samples[oldest:], firsts


class PoolingOnce:
    """Pools the windows of a frame once, however many searches of one stream look at them."""

    def __init__(self, pool: Pool) -> None:
        self._pool = pool
        self._newest: Frame | None = None
        self._starts_ns: list[int] = []
        self._vectors = np.empty((0, 0), np.float32)

    def __call__(self, frames: Sequence[Frame], firsts: Sequence[int]) -> NDArray[np.float32]:
        """Return the pyramid vectors of windows that end with the last of these frames, (windows, inputs)."""
        starts_ns = [frames[first].stamp_ns for first in firsts]
        if self._newest is not frames[-1] or self._starts_ns != starts_ns:
            self._newest, self._starts_ns, self._vectors = frames[-1], starts_ns, self._pool(frames, firsts)
        return self._vectors


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
        self.use(options)
        self._interval_ns = round(metadata.interval_s * SECOND_NS)
        longest_ns = round(metadata.window_durations_s[-1] * SECOND_NS)
        self._decoder = learned.decoder()
        self.memory_ns = self._decoder.memory_ns + longest_ns
        self._recent = RecentFrames(metadata.window_durations_s, self.memory_ns)
        self._next_decision_ns = 0
        self._ongoing: Ongoing | None = None

    def use(self, options: SpottingOptions) -> None:
        """Go on with the threshold of other options, and all that was seen so far."""
        metadata, asked = self._learned.metadata, options.false_alarms_per_min
        self._threshold, self._precision = metadata.threshold_for(asked), metadata.precision_for(asked)

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
        starts_ns = [frames[first].stamp_ns for first in firsts]
        completeness = self._learned.heads.completeness(self._pool(frames, firsts)).tolist()
        candidates = self._learned.candidates(starts_ns, now_ns, completeness, self._threshold)
        decided = self._decoder.step(now_ns, candidates)
        self._ongoing = self._likeliest(starts_ns, now_ns, completeness)
        segments = []
        for each in decided:
            first = self._recent.between(each.start_ns, each.end_ns)[0]
            segments.append(SpottedSegment(first.stamp_ns, each.end_ns, self._labels[each.action], self._precision))
        return Spotted(tuple(segments), self._ongoing)

    def _likeliest(self, starts_ns: Sequence[int], now_ns: int, completeness: list[list[float]]) -> Ongoing | None:
        """Return the action to which a window that ends now belongs most surely, None where none belongs to any."""
        free = [n for n, start_ns in enumerate(starts_ns) if self._decoder.is_free(start_ns, now_ns)]
        if not free:
            return None
        window = max(free, key=[max(answers) for answers in completeness].__getitem__)
        answer = max(completeness[window])
        probability = self._learned.probability(answer)
        if probability < LEAST_PROBABILITY:
            return None
        action = self._labels[completeness[window].index(answer)]
        return Ongoing(starts_ns[window], action, probability, iou_of_completeness(answer))
