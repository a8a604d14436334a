"""Linear discriminants for each stage of an action: at its start other features tell actions apart than at its end."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from actum.som.blas import row_matmul

NEGLIGIBLE = 0.02
"""Stages that are less probable than this are left out: each costs a matrix product per frame."""
SHORTEST_S = 1e-3
"""Shorter segments count as this long (s): the logarithm of 0 is infinite."""


@dataclass(frozen=True, eq=False)
class StageDiscriminants:
    """Linear scores of the actions, vᵀ axes + offsets of a pyramid vector v; the last stage is the complete action.

    Attributes:
        axes: (stages, inputs, actions), float32, the discriminant axes.
        offsets: (stages, actions), float32.
        fractions: (stages,), the share of an action that has been seen at each stage; the last is 1.
        log_duration_mean: mean of the logarithm of the training segments' durations (s).
        log_duration_sd: standard deviation of that logarithm.
    """

    axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    fractions: tuple[float, ...]
    log_duration_mean: float
    log_duration_sd: float

    @cached_property
    def _axes_in_turn(self) -> list[NDArray[np.float32]]:
        """The axes of each stage, one after the other in memory: products with one vector are then faster."""
        return [np.asfortranarray(axes) for axes in self.axes]

    @cached_property
    def _log_fractions(self) -> list[float]:
        return [math.log(fraction) for fraction in self.fractions]

    def weights(self, elapsed_s: float, complete: bool) -> Sequence[float]:
        """Return the probability of each stage: 1 for the last where the segment is complete, else by elapsed time.

        The fraction seen is elapsed / duration, durations being log-normally distributed as in training:
        p ∝ exp(−z² / 2), z = (log(elapsed / fraction) − mean) / sd, and 0 below `NEGLIGIBLE`.

        Args:
            elapsed_s: since the segment's start.
            complete: whether the segment has ended.
        """
        if complete:
            return [0.0] * (len(self.fractions) - 1) + [1.0]
        log_share = math.log(max(elapsed_s, SHORTEST_S)) - self.log_duration_mean
        z2s = [((log_share - log_fraction) / self.log_duration_sd) ** 2 for log_fraction in self._log_fractions]
        least = min(z2s)
        likely = [math.exp(0.5 * (least - z2)) for z2 in z2s]
        negligible = NEGLIGIBLE * sum(likely)
        kept = [weight if weight >= negligible else 0.0 for weight in likely]
        whole = sum(kept)
        return [weight / whole for weight in kept]

    def scores(self, vector: NDArray[np.float32], weights: Sequence[float]) -> NDArray[np.float32]:
        """Return the weighted mean of the stages' scores: about 1 for the action done, 0 for the others, (actions,).

        Args:
            vector: (inputs,), of the pyramid.
            weights: (stages,), as `weights` returns them.
        """
        total = np.zeros(self.offsets.shape[1], np.float32)
        for axes, offsets, weight in zip(self._axes_in_turn, self.offsets, weights, strict=True):
            if weight:
                total += np.float32(weight) * (row_matmul(vector, axes) + offsets)
        return total
