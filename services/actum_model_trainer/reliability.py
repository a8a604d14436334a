"""Whether answers are right as often as their confidence says."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

FEWEST = 30
"""Answers with a label: fewer say nothing."""
BINS = 10


@dataclass(frozen=True)
class Bin:
    """The answers whose confidence lies between two tenths."""

    low: float
    high: float
    n: int
    correct: int
    confidence: float

    @property
    def accuracy(self) -> float:
        """The share of right ones."""
        return self.correct / self.n


def binned(confidences: Sequence[float], correct: Sequence[bool]) -> list[Bin]:
    """Sort answers by confidence; bins without an answer are left out."""
    sure, right = np.array(confidences, dtype=np.float64), np.array(correct, dtype=bool)
    which = np.minimum((sure * BINS).astype(int), BINS - 1)
    return [_bin(k, sure[which == k], right[which == k]) for k in np.unique(which).tolist()]


def calibration_error(found: Sequence[Bin]) -> float:
    """Return the mean over all answers of |accuracy − confidence| of their bin."""
    n = sum(each.n for each in found)
    return sum(each.n * abs(each.accuracy - each.confidence) for each in found) / n


def _bin(k: int, confidences: NDArray[np.float64], correct: NDArray[np.bool_]) -> Bin:
    return Bin(k / BINS, (k + 1) / BINS, len(correct), int(correct.sum()), float(confidences.mean()))
