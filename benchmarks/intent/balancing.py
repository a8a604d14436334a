"""How sure a network of contacts may be: surer of those who act all the time than of those who do other things.

A person acts as often among many objects as among few.
"""

from typing import NamedTuple

import numpy as np

from actum.arrays import Array

POSSIBLE = 0.03
"""A contact of this probability is thought possible; instants without one are left out."""
NEWTON_STEPS = 8
"""More than enough for four numbers."""


class Balance(NamedTuple):
    """Changes a score to `scale` times the score, plus `offset`.

    To that comes `lively` times log(1 + how many have begun), and `among` times the logarithm of how many objects there
    are.
    """

    scale: float
    offset: float
    lively: float
    among: float


def balance(scores: Array, touched: Array, weights: Array, begun: Array) -> Balance:
    """Fit the balance of N instants by Newton's method, on the cross entropy of which object is touched, if any.

    Args:
        scores: (N, objects), minus infinity where there is no object.
        touched: (N, objects), which object is touched next.
        weights: (N,), of the instants.
        begun: (N,), how many objects have begun to move lately.
    """
    kept = softmax(scores).sum(axis=1) > POSSIBLE
    scores, touched, weights, begun = scores[kept], touched[kept], weights[kept], begun[kept]
    there = np.isfinite(scores)
    known = np.where(there, scores, 0.0)
    of_all = (np.ones(len(scores)), np.log1p(begun), np.log(there.sum(axis=1)))
    inputs = np.stack([known, *(np.broadcast_to(each[:, None], known.shape) for each in of_all)])
    fitted = np.array([1.0, 0.0, 0.0, 0.0])
    for _ in range(NEWTON_STEPS):
        likely = softmax(np.where(there, np.einsum("p,pno->no", fitted, inputs), -np.inf))
        slope = np.einsum("pno,no,n->p", inputs, likely - touched, weights, optimize=True)
        mean = np.einsum("pno,no->pn", inputs, likely)
        curve = np.einsum("pno,qno,no,n->pq", inputs, inputs, likely, weights, optimize=True)
        fitted = fitted - np.linalg.solve(curve - np.einsum("pn,qn,n->pq", mean, mean, weights, optimize=True), slope)
    return Balance(*fitted.tolist())


def softmax(scores: Array) -> Array:
    """Return the probabilities of scores (N, objects), beside a score of 0 for none."""
    most = np.maximum(scores.max(axis=1, keepdims=True), 0.0)
    likely = np.exp(scores - most)
    probability: Array = likely / (likely.sum(axis=1, keepdims=True) + np.exp(-most))
    return probability
