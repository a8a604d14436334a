"""How probable each action is that a partial action may turn out to be."""

import heapq
import math
import sys
from collections.abc import Mapping, Sequence

MOST_SHARES = 8
"""So many actions, the most active ones, count beside the named one."""
NEWTON_STEPS = 16
"""More than the temperature needs."""
PRECISE = 1e-6
"""Relative error of the sum of the others' shares at which it is precise enough."""


def shares_of(action: str, confidence: float, activations: Mapping[str, float]) -> dict[str, float]:
    """Return the probabilities of the likeliest actions, the named one first, with exactly its confidence.

    They are a softmax of the activations, at the temperature at which the named action has its confidence, and sum to 1
    at most. Without activations, only the named action has a probability.
    """
    active = activations.get(action, -math.inf)
    others = heapq.nlargest(MOST_SHARES, ((each, label) for label, each in activations.items() if label != action))
    gaps = [min(max(active - each, 0.0), sys.float_info.max) for each, _ in others]
    inverse = _inverse_temperature(gaps, confidence)
    shares = [confidence * math.exp(-inverse * gap) for gap in gaps]
    scale = min((1 - confidence) / max(sum(shares), 1e-9), 1.0)
    return {action: confidence} | {label: scale * share for (_, label), share in zip(others, shares, strict=True)}


def _inverse_temperature(gaps: Sequence[float], confidence: float) -> float:
    """Solve sum(exp(-b * gaps)) = 1 / confidence - 1 for b by Newton's method from b = 0, which rises to the root."""
    inverse, wanted = 0.0, 1 / max(confidence, 1e-9) - 1
    for _ in range(NEWTON_STEPS):
        terms = [math.exp(-inverse * gap) for gap in gaps]
        beyond = sum(terms) - wanted
        if beyond <= PRECISE * wanted:
            break
        inverse += beyond / max(sum(gap * term for gap, term in zip(gaps, terms, strict=True)), 1e-9)
    return inverse
