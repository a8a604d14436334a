"""What turns cosines into probabilities, fitted on answers for people who were left out of training."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[Any]

SMALLEST_GAIN, LARGEST_GAIN = 0.5, 200.0
_STEPS = 60
_GOLDEN = (np.sqrt(5.0) - 1) / 2


def fitted_gain(cosines: Floats, targets: NDArray[np.intp]) -> float:
    """Return the gain for which softmax(gain × cosines) explains the targets best (temperature scaling).

    Minimises the mean negative log-likelihood, which is convex in the gain, by golden-section search on its logarithm.

    Args:
        cosines: (n, actions).
        targets: (n,), which action was done.
    """
    low, high = np.log(SMALLEST_GAIN), np.log(LARGEST_GAIN)
    for _ in range(_STEPS):
        left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        if surprise(cosines, targets, np.exp(left)) < surprise(cosines, targets, np.exp(right)):
            high = right
        else:
            low = left
    return float(np.exp((low + high) / 2))


def surprise(cosines: Floats, targets: NDArray[np.intp], gain: float) -> float:
    """Return the mean negative log-likelihood of the targets under softmax(gain × cosines).

    As after Platt (1999) a target counts as certain only to (n + 1) / (n + 2), the rest being spread over all actions:
    that all n answers were right does not make the next one sure.
    """
    logits = gain * (cosines - cosines.max(axis=1, keepdims=True))
    done = np.take_along_axis(logits, targets[:, None], axis=1)[:, 0]
    doubt = 1 / (len(targets) + 2)
    expected = (1 - doubt) * done + doubt * logits.mean(axis=1)
    return float((np.log(np.exp(logits).sum(axis=1)) - expected).mean())
