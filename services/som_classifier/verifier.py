"""The verifier: how like an action a complete segment is, beside other actions and movement that nobody taught."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

LOG_ERROR_COST = 0.03
"""By how much likeness falls where the posture map's squared quantization error is e times the usual one; four times as
much where it is e² times."""
LARGEST_LOGIT = 30.0
"""Beyond it a probability is 0 or 1 in every digit that counts, and exponentials would overflow."""


@dataclass(frozen=True, eq=False)
class Verifier:
    """One linear discriminant for each action against all other movement: other actions and background.

    Attributes:
        pooled_axes: (inputs, actions), for the pyramid's vector.
        convolution_axes: (features, actions), for the convolutions' features.
        offsets: (actions,).
        usual_log_errors: (actions,), the mean log(d²) of an action's postures from the posture map, d in metres, to
            expect of a person not trained on.
        slope: of the logistic regression of whether a segment is a true instance of its action on its likeness.
        intercept: of the same.
        least_likeness: with less a segment is `unknown`: most true instances have more.
        least_found_likeness: with less a segment that nobody marked is not published. Marks are put where an action is
            done; what a search finds is any movement.
    """

    pooled_axes: NDArray[np.float32]
    convolution_axes: NDArray[np.float32]
    offsets: NDArray[np.float32]
    usual_log_errors: Sequence[float]
    slope: float
    intercept: float
    least_likeness: float
    least_found_likeness: float

    def likeness(
        self, action: int, pooled: NDArray[np.float32], features: NDArray[np.float32], log_error: float
    ) -> float:
        """Return how like an action a segment is: about 1 for who was trained on, 0 for other movement.

        Args:
            action: its index.
            pooled: (inputs,), the pyramid's vector.
            features: (features,), of the convolutions.
            log_error: the mean logarithm of the posture map's squared quantization error (m²).
        """
        score = pooled @ self._pooled_axes_in_turn[action] + features @ self._convolution_axes_in_turn[action]
        unlike = max(log_error - self.usual_log_errors[action], 0.0)
        return float(score + self.offsets[action]) - LOG_ERROR_COST * unlike**2

    @cached_property
    def _pooled_axes_in_turn(self) -> NDArray[np.float32]:
        """The axes, one after the other in memory, (actions, inputs): each is read alone."""
        return np.ascontiguousarray(self.pooled_axes.T)

    @cached_property
    def _convolution_axes_in_turn(self) -> NDArray[np.float32]:
        """The same of the convolutions', (actions, features)."""
        return np.ascontiguousarray(self.convolution_axes.T)

    def probability(self, likeness: float) -> float:
        """Return the probability that a segment of this likeness is a true instance of its action."""
        logit = self.slope * likeness + self.intercept
        return 1.0 / (1.0 + math.exp(-min(max(logit, -LARGEST_LOGIT), LARGEST_LOGIT)))
