"""The search for actions in one person's stream, by the default recogniser."""

from collections.abc import Sequence
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from actum.node import SECOND_NS
from som_classifier.frames import Frame
from som_classifier.recognition import Recognition
from som_classifier.spotting.completeness import iou_of_completeness
from som_classifier.spotting.decoding import Candidate, Decoder
from som_classifier.spotting.spotted import Ongoing, Spotted, SpottedSegment, SpottingOptions
from som_classifier.spotting.spotting_model import SpottingModel
from som_classifier.spotting.windows import RecentFrames, Window

ONGOING_FROM = 0.25
"""Completeness from which an action counts as going on: that of a window that overlaps it by 40 %."""


class Recogniser(Protocol):
    """What the search asks of its model."""

    min_frames: ClassVar[int]

    @property
    def labels(self) -> list[str]:
        """The actions it tells apart."""
        ...

    def pooled(self, frames: Sequence[Frame]) -> NDArray[np.float32]:
        """Return the pyramid vector of valid frames, (inputs,)."""
        ...

    def recognise(self, frames: Sequence[Frame], complete: bool) -> Recognition:
        """Recognise the action of a segment."""
        ...


class PyramidSpotter:
    """Looks at all windows that end now, several times a second, and decides which of them were actions.

    An action is told only where the model, asked about the frames that were found, does not call them unknown: the heads
    know no more than the background that was shown to them.

    Args:
        model: the recogniser.
        learned: its heads and durations.
        options: what is asked of the search.
    """

    def __init__(self, model: Recogniser, learned: SpottingModel, options: SpottingOptions) -> None:
        self._model, self._learned = model, learned
        metadata = learned.metadata
        self._threshold = metadata.threshold_for(options.false_alarms_per_min)
        self._interval_ns = round(metadata.interval_s * SECOND_NS)
        memory_ns = round((metadata.window_durations_s[-1] + metadata.lag_s) * SECOND_NS)
        self._recent = RecentFrames(metadata.window_durations_s, memory_ns)
        self._decoder = Decoder(round(metadata.lag_s * SECOND_NS), memory_ns, metadata.overlap)
        self._next_decision_ns = 0
        self._ongoing: Ongoing | None = None

    def step(self, frame: Frame) -> Spotted:
        """Take the next frame, valid or not; return what it shows."""
        if frame.valid and not self._recent.add(frame):
            self._decoder.forget()
            self._ongoing, self._next_decision_ns = None, frame.stamp_ns
        if not frame.valid or frame.stamp_ns < self._next_decision_ns:
            return Spotted(ongoing=self._ongoing)
        self._next_decision_ns = frame.stamp_ns + self._interval_ns
        return self._decision(frame.stamp_ns)

    def _decision(self, now_ns: int) -> Spotted:
        windows = self._recent.windows()
        answers = [self._learned.heads.completeness(self._model.pooled(window.frames)) for window in windows]
        scored = list(zip(windows, answers, strict=True))
        candidates = (self._learned.candidate(window, answer, self._threshold) for window, answer in scored)
        decided = self._decoder.step(now_ns, [each for each in candidates if each is not None])
        self._ongoing = self._likeliest(scored)
        return Spotted(tuple(self._segment(each) for each in decided if self._is_familiar(each)), self._ongoing)

    def _segment(self, candidate: Candidate) -> SpottedSegment:
        frames = self._recent.between(candidate.start_ns, candidate.end_ns)
        return SpottedSegment(frames[0].stamp_ns, candidate.end_ns, self._model.labels[candidate.action])

    def _is_familiar(self, candidate: Candidate) -> bool:
        frames = self._recent.between(candidate.start_ns, candidate.end_ns)
        return len(frames) >= self._model.min_frames and not self._model.recognise(frames, complete=True).unknown

    def _likeliest(self, scored: Sequence[tuple[Window, NDArray[np.float32]]]) -> Ongoing | None:
        """Return the action to which the windows that end now belong most surely, None where it is none."""
        free = [each for each in scored if self._decoder.is_free(each[0].start_ns, each[0].end_ns)]
        if not free:
            return None
        window, answer = max(free, key=lambda each: float(each[1].max()))
        action = int(answer.argmax())
        completeness = float(answer[action])
        if completeness < ONGOING_FROM:
            return None
        return Ongoing(
            window.start_ns,
            self._model.labels[action],
            self._learned.probability(completeness),
            iou_of_completeness(completeness),
        )
