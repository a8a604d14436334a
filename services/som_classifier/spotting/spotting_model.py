"""What a model has learned beside its answers so that it finds actions without marks."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from actum.arrays import Array, Floats, Indices
from actum.limits import MAX_SEGMENT_NS, MAX_SKEW_NS
from actum.node import SECOND_NS
from actum.som.blas import row_matmul
from som_classifier.kinematics import GAP_NS
from som_classifier.spotting.decoding import Candidate, Decoder, Spans
from som_classifier.spotting.spotted import Finite, SpottingMetadata

Stamps = NDArray[np.int64]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Duration = Annotated[float, Field(gt=0, le=MAX_SEGMENT_NS / SECOND_NS)]

SHORTEST_S = 0.1
"""Shorter windows count as this long (s): the logarithm of 0 is infinite."""
LARGEST_Z2 = 9.0
"""Squared standard score of a duration from which on it costs no more: a slow action is rare, not impossible."""


NONE_BELOW_IOU = 0.25
"""Overlap (intersection over union) up to which a window counts as none of an action: chance overlaps reach it."""
WHOLE_FROM_IOU = 0.85
"""Overlap from which a window counts as the whole action: nobody marks bounds more exactly."""


def completeness_of_iou(iou: Floats) -> Floats:
    """Return the completeness that a head is to answer for overlaps (…), same shape, within [0, 1]."""
    share = (iou - NONE_BELOW_IOU) / (WHOLE_FROM_IOU - NONE_BELOW_IOU)
    completeness: Floats = np.clip(share, 0.0, 1.0)
    return completeness


def iou_of_completeness(completeness: float) -> float:
    """Return the overlap (0 to 1) that a head's answer stands for: of a beginning, how much of the action is done."""
    return min(max(NONE_BELOW_IOU + completeness * (WHOLE_FROM_IOU - NONE_BELOW_IOU), 0.0), 1.0)


@dataclass(frozen=True, eq=False)
class CompletenessHeads:
    """One linear head for each action.

    Attributes:
        axes: (inputs, actions), float32.
        offsets: (actions,), float32.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]

    def completeness(self, vectors: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return each head's answer to each of some pyramid vectors (n, inputs): about 0 to 1, shape (n, actions)."""
        completeness = np.empty((len(vectors), len(self.offsets)), np.float32)
        for answers, vector in zip(completeness, vectors, strict=True):
            answers[:] = row_matmul(vector, self._axes_in_turn)
        completeness += self.offsets
        return completeness

    @cached_property
    def _axes_in_turn(self) -> NDArray[np.float32]:
        """The axes, one after the other in memory: products with one vector are several times as fast."""
        return np.asfortranarray(self.axes)


class PyramidSpottingMetadata(SpottingMetadata):
    """What a model file of the default recogniser says of the search beside the weights.

    Attributes:
        interval_s: time between two decisions; each looks at all windows that end then.
        lag_s: how long after its end an action is decided.
        overlap: the share by which an action may reach into the one before it.
        duration_weight: by how much completeness counts less per unit of log-likelihood of the duration.
        window_durations_s: durations of the windows, rising.
        log_duration_means: for each action, the mean of the logarithm of its durations (s).
        log_duration_sds: for each action, the standard deviation of that logarithm.
        recalls: the cross-validated share of actions that are found, by threshold.
        precisions: the cross-validated share of the segments found in which any action is done, by threshold.
        probability: slope and intercept of the logistic regression that turns a head's answer into a probability.
    """

    interval_s: Positive
    lag_s: Annotated[float, Field(ge=0, le=MAX_SKEW_NS / SECOND_NS)]
    overlap: Annotated[float, Field(ge=0, lt=1)]
    duration_weight: Annotated[float, Field(ge=0, allow_inf_nan=False)]
    window_durations_s: Annotated[list[Duration], Field(min_length=1)]
    log_duration_means: list[Finite]
    log_duration_sds: list[Positive]
    recalls: list[Finite]
    precisions: list[Annotated[float, Field(ge=0, le=1)]]
    probability: Annotated[list[Finite], Field(min_length=2, max_length=2)]

    def problem(self, actions: int) -> str | None:
        """Return the first inconsistency with itself or with the number of actions, None where there is none."""
        if {len(self.log_duration_means), len(self.log_duration_sds)} != {actions}:
            return "the durations of its search are not those of its actions"
        if any(list(rising) != sorted(rising) for rising in (self.window_durations_s, self.thresholds)):
            return "the windows or thresholds of its search do not rise"
        if len(self.false_alarms_per_min) not in (0, len(self.thresholds)):
            return "the false alarms of its search are not those of its thresholds"
        if len(self.precisions) != len(self.thresholds):
            return "the precisions of its search are not those of its thresholds"
        return None

    def precision_for(self, false_alarms_per_min: float | None) -> float:
        """Return the share of what is found with the threshold for this rate in which any action is done.

        It is interpolated between thresholds.
        """
        return float(np.interp(self.threshold_for(false_alarms_per_min), self.thresholds, self.precisions))


@dataclass(frozen=True, eq=False)
class JudgedWindows:
    """The likeliest action of each of n windows.

    A window gains (worth - threshold) * duration, where worth = completeness + weight * log-likelihood of its duration,
    and the durations of each action are log-normally distributed.

    Attributes:
        starts_ns: (n,), the first stamps.
        ends_ns: (n,), the last stamps.
        actions: (n,), the likeliest action, by its number.
        worth: (n,), as this action.
        completeness: (n,), the head's answer for it.
        durations: (n,), relative to the mean duration of an action.
    """

    starts_ns: Stamps
    ends_ns: Stamps
    actions: Indices
    worth: Array
    completeness: Floats
    durations: Array

    def gainful(self, threshold: float) -> tuple[Indices, Spans]:
        """Return which windows gain something above a threshold, (m,), and these as candidates."""
        gains = (self.worth - threshold) * self.durations
        gainful = np.flatnonzero(gains > 0)
        return gainful, Spans(self.starts_ns[gainful], self.ends_ns[gainful], gains[gainful])


@dataclass(frozen=True, eq=False)
class SpottingModel:
    """Heads and durations.

    Attributes:
        heads: one for each action.
        metadata: everything else.
    """

    heads: CompletenessHeads
    metadata: PyramidSpottingMetadata

    def decoder(self) -> Decoder:
        """Return the decoder of one person's stream.

        A candidate is decided once its lag is over or, while others that overlap it are worth more, theirs: a longest
        window later at most, and with the first decision after that.
        """
        metadata = self.metadata
        waited_ns = round((metadata.window_durations_s[-1] + metadata.lag_s + metadata.interval_s) * SECOND_NS)
        return Decoder(round(metadata.lag_s * SECOND_NS), waited_ns + GAP_NS, metadata.overlap)

    def candidates(
        self, starts_ns: Sequence[int], now_ns: int, completeness: Sequence[Sequence[float]], threshold: float
    ) -> list[Candidate]:
        """Return for each window that ends now the action that it is most likely to be, where it is one.

        They are those that `judged` finds gainful. There are few: none is worth more than it is complete.

        Args:
            starts_ns: (n,), the windows' first stamps.
            now_ns: their last one.
            completeness: (n, actions), the heads' answers.
            threshold: completeness that must be exceeded.
        """
        likely = [n for n, answers in enumerate(completeness) if max(answers) > threshold]
        durations_s = [(now_ns - starts_ns[n]) / SECOND_NS for n in likely]
        log_durations = np.log([max(duration_s, SHORTEST_S) for duration_s in durations_s]).tolist()
        found = []
        for n, duration_s, log_duration in zip(likely, durations_s, log_durations, strict=True):
            action, worth = self._likeliest(completeness[n], log_duration, threshold)
            gain = (worth - threshold) * (duration_s / self._mean_duration_s)
            if gain > 0:
                found.append(Candidate(starts_ns[n], now_ns, action, completeness[n][action], gain))
        return found

    def _likeliest(self, completeness: Sequence[float], log_duration: float, threshold: float) -> tuple[int, float]:
        """Return the action as which a window is worth most, and what; the threshold where it is worth no more."""
        likeliest, most = 0, threshold
        for action, answer in enumerate(completeness):
            if answer > most:
                z = (log_duration - self.metadata.log_duration_means[action]) / self.metadata.log_duration_sds[action]
                worth = answer + self.metadata.duration_weight * (-0.5 * min(z * z, LARGEST_Z2))
                likeliest, most = (action, worth) if worth > most else (likeliest, most)
        return likeliest, most

    def judged(self, starts_ns: Stamps, ends_ns: Stamps, completeness: Floats) -> "JudgedWindows":
        """Find what windows (n,) are most likely to be, whatever the threshold.

        Args:
            starts_ns: (n,), their first stamps.
            ends_ns: (n,), their last stamps.
            completeness: (n, actions), the heads' answers.
        """
        durations_s = (ends_ns - starts_ns) / SECOND_NS
        means, sds = np.array(self.metadata.log_duration_means), np.array(self.metadata.log_duration_sds)
        z2 = np.square((np.log(np.maximum(durations_s, SHORTEST_S))[:, None] - means) / sds)
        worth = completeness + self.metadata.duration_weight * (-0.5 * np.minimum(z2, LARGEST_Z2))
        actions, rows = worth.argmax(axis=1), np.arange(len(worth))
        best = worth[rows, actions], completeness[rows, actions]
        return JudgedWindows(starts_ns, ends_ns, actions, *best, durations_s / self._mean_duration_s)

    def probability(self, completeness: float) -> float:
        """Return how probable it is that an action is going on for which a head answers this much."""
        slope, intercept = self.metadata.probability
        return float(1.0 / (1.0 + np.exp(-(slope * completeness + intercept))))

    @cached_property
    def _mean_duration_s(self) -> float:
        """The mean duration (s) of an action: of the logarithms' means."""
        return float(np.exp(self.metadata.log_duration_means).mean())
