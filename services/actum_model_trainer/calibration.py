"""What turns cosines into probabilities: as sure on average as held-out answers are right."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

SMALLEST_GAIN, LARGEST_GAIN = 0.5, 200.0
_STEPS = 40


def matched_gain(cosines: Floats, accuracy: float) -> float:
    """Return the gain at which the largest share of softmax(gain × cosines) is the accuracy on average.

    That average grows with the gain, so halving the interval of its logarithm finds it; where no gain within the
    bounds does, the nearer bound.

    Args:
        cosines: (n, actions).
        accuracy: within [0, 1].
    """
    low, high = np.log(SMALLEST_GAIN), np.log(LARGEST_GAIN)
    for _ in range(_STEPS):
        middle = (low + high) / 2
        if confidences(cosines, float(np.exp(middle))).mean() < accuracy:
            low = middle
        else:
            high = middle
    return float(np.exp((low + high) / 2))


def confidences(cosines: Floats, gain: float) -> Floats:
    """Return the largest share of softmax(gain × cosines) of each row (n, actions), shape (n,)."""
    shares: Floats = 1 / np.exp(gain * (cosines - cosines.max(axis=1, keepdims=True))).sum(axis=1)
    return shares
