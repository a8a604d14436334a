"""Discriminant axes, one set for each stage of an action: early on other things tell actions apart than at the end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from actum.som.blas import row_product

Floats = NDArray[Any]

NEGLIGIBLE = 0.02
SHORTEST_S = 1e-3
LOG_ERROR_COST = 0.2
"""What postures whose d² from the map of postures is e times as large as usual take off the familiarity."""


@dataclass(frozen=True, eq=False)
class StageDiscriminants:
    """Linear scores of the actions from a pyramid vector; the last stage is the complete action.

    Attributes:
        axes: (stages, inputs, actions), float32.
        offsets: (stages, actions), float32.
        fractions: (stages,), the share of an action that each stage has seen; the last is 1.
        log_duration_mean: mean of the logarithm of the training segments' durations (s).
        log_duration_sd: their standard deviation.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    fractions: tuple[float, ...]
    log_duration_mean: float
    log_duration_sd: float

    def weights(self, elapsed_s: float, complete: bool) -> Sequence[float]:
        """Say how likely each stage is: the last where the segment is complete, else by the time since its start.

        The fraction seen is elapsed / duration, and durations are log-normal as in training.
        """
        if complete:
            return [0.0] * (len(self.fractions) - 1) + [1.0]
        seen = math.log(max(elapsed_s, SHORTEST_S)) - self.log_duration_mean
        z2s = [((seen - math.log(fraction)) / self.log_duration_sd) ** 2 for fraction in self.fractions]
        likely = [math.exp(0.5 * (min(z2s) - z2)) for z2 in z2s]
        kept = [weight if weight >= NEGLIGIBLE * sum(likely) else 0.0 for weight in likely]
        return [weight / sum(kept) for weight in kept]

    def scores(self, vector: NDArray[np.float32], weights: Sequence[float]) -> NDArray[np.float32]:
        """Return the actions' scores, about 1 for the one done and 0 for the others, shape (actions,)."""
        total = np.zeros(self.offsets.shape[1], np.float32)
        for axes, offsets, weight in zip(self.axes, self.offsets, weights, strict=True):
            if weight:
                total += np.float32(weight) * (row_product(vector, axes) + offsets)
        return total


def familiarity_of(scores: Floats, log_error: float, usual_log_errors: Sequence[float]) -> float:
    """Return how much a segment is like a trained action: its largest score, less how strange its postures are for it.

    Args:
        scores: (actions,).
        log_error: the mean logarithm of the posture map's squared quantization error (m²).
        usual_log_errors: (actions,), what a stranger who does that action may well come to.
    """
    likeliest = int(scores.argmax())
    return float(scores[likeliest]) - LOG_ERROR_COST * max(log_error - usual_log_errors[likeliest], 0.0)
