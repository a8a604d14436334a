"""The expected calibration error (ECE): whether answers are right as often as their confidence says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

MIN_ANSWERS = 30  # labelled answers: with fewer, the accuracy in a bin is chance
BINS = 10  # equally wide, as is usual


@dataclass(frozen=True)
class ConfidenceBin:
    """The answers whose confidence lies within one bin.

    Attributes:
        low: the bin's lower bound.
        high: its upper bound.
        n: number of answers.
        correct: number of right ones.
        confidence: their mean confidence.
    """

    low: float
    high: float
    n: int
    correct: int
    confidence: float

    @property
    def accuracy(self) -> float:
        """The share of right answers."""
        return self.correct / self.n


def confidence_bins(confidences: ArrayLike, correct: ArrayLike) -> list[ConfidenceBin]:
    """Sort answers into bins by confidence (n,), given whether each is correct (n,); empty bins are left out."""
    confidence, is_correct = np.array(confidences, dtype=np.float64), np.array(correct, dtype=bool)
    bin_indices = np.minimum((confidence * BINS).astype(int), BINS - 1)
    bins = []
    for k in np.unique(bin_indices).tolist():
        inside = bin_indices == k
        counts = int(inside.sum()), int(is_correct[inside].sum())
        bins.append(ConfidenceBin(k / BINS, (k + 1) / BINS, *counts, float(confidence[inside].mean())))
    return bins


def calibration_error(bins: Sequence[ConfidenceBin]) -> float:
    """Return the ECE: the mean over all answers of |accuracy − confidence| of their bin."""
    n = sum(each.n for each in bins)
    return sum(each.n * abs(each.accuracy - each.confidence) for each in bins) / n
