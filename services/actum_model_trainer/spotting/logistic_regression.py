"""Logistic regression of outcomes on one number."""

import numpy as np
from numpy.typing import NDArray

from actum.arrays import Array

MOST_STEPS = 50
"""Most steps of Newton's method: where it converges, it takes far fewer."""
SMALLEST_STEP = 1e-6
"""Change of slope and intercept below which they are found."""
RIDGE = 1e-3
"""Weight of the squared slope and intercept in what is minimised: the curvature stays invertible."""
LARGEST_LOGIT = 30.0
"""Beyond it a probability is 0 or 1 in every digit that counts, and exponentials would overflow."""


def logistic_fit(answers: Array, is_right: NDArray[np.bool_], counts: Array | None = None) -> tuple[float, float]:
    """Return slope and intercept of the logistic regression of outcomes (n,) on answers (n,), weighted by counts (n,).

    By Newton's method, with one more sample of either outcome at the mean answer so that it stays finite.
    """
    often = np.append(np.ones(len(answers)) if counts is None else counts, [1.0, 1.0])
    x = np.append(answers, [answers.mean()] * 2)
    y = np.append(is_right.astype(float), [0.0, 1.0])
    inputs = np.stack([x, np.ones_like(x)], axis=1)
    weights = np.zeros(2)
    for _ in range(MOST_STEPS):
        p = 1 / (1 + np.exp(-np.clip(inputs @ weights, -LARGEST_LOGIT, LARGEST_LOGIT)))
        curvature = inputs.T @ (inputs * (often * p * (1 - p))[:, None]) + RIDGE * np.eye(2)
        step = np.linalg.solve(curvature, inputs.T @ (often * (y - p)) - RIDGE * weights)
        weights = weights + step
        if np.abs(step).max() < SMALLEST_STEP:
            break
    return float(weights[0]), float(weights[1])
