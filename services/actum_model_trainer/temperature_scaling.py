"""Temperature scaling (Guo et al., "On calibration of modern neural networks", 2017), matched to a known accuracy.

A softmax turns inverse temperature × cosines into probabilities: the larger the inverse temperature, the surer.
"""

import numpy as np

from actum.arrays import Floats

SMALLEST_INVERSE_TEMPERATURE = 0.5  # per unit of cosine: even the largest lead, 2, makes odds of no more than e to 1
LARGEST_INVERSE_TEMPERATURE = 200.0  # per unit of cosine: a lead of 0.02 already makes a confidence of 0.98
_BISECTIONS = 40  # leave 6 / 2⁴⁰ of the range of the logarithm, less than single precision distinguishes


def matched_inverse_temperature(cosines: Floats, accuracy: float) -> float:
    """Return the inverse temperature at which the mean confidence equals the accuracy.

    The mean confidence rises with the inverse temperature, so bisection of its logarithm finds it. Where no value
    within the bounds fits, the nearer bound is returned.

    Args:
        cosines: (n, actions).
        accuracy: share of right answers, 0 to 1.
    """
    low, high = np.log(SMALLEST_INVERSE_TEMPERATURE), np.log(LARGEST_INVERSE_TEMPERATURE)
    for _ in range(_BISECTIONS):
        middle = (low + high) / 2
        if confidences(cosines, float(np.exp(middle))).mean() < accuracy:
            low = middle
        else:
            high = middle
    return float(np.exp((low + high) / 2))


def confidences(cosines: Floats, inverse_temperature: float) -> Floats:
    """Return the largest probability of softmax(inverse temperature × cosines) of each row (n, actions), shape (n,)."""
    largest: Floats = 1 / np.exp(inverse_temperature * (cosines - cosines.max(axis=1, keepdims=True))).sum(axis=1)
    return largest
