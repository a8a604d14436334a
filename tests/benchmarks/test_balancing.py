"""The balance of scores is found again where it is known."""

import numpy as np
import pytest
from benchmarks.intent.balancing import balance, softmax

INSTANTS, OBJECTS = 40_000, 3


def test_the_balance_by_which_contacts_come_true_is_found() -> None:
    rng = np.random.default_rng(4)
    scores, begun = rng.normal(0, 2, (INSTANTS, OBJECTS)), rng.uniform(0, 6, INSTANTS)
    scores[: INSTANTS // 2, 2] = -np.inf
    there = np.isfinite(scores).sum(axis=1)
    true = softmax(0.8 * scores + (-1.5 + 0.7 * np.log1p(begun) - 0.6 * np.log(there))[:, None])
    drawn = (rng.uniform(size=(INSTANTS, 1)) > np.cumsum(true, axis=1)).sum(axis=1)
    touched = (np.arange(OBJECTS) == drawn[:, None]).astype(float)
    found = balance(scores, touched, np.ones(INSTANTS), begun)
    assert found == pytest.approx((0.8, -1.5, 0.7, -0.6), abs=0.08)
