"""The verifier's probability by hand: a score of one action, less for postures unlike it, and a logistic function."""

from dataclasses import replace

import numpy as np
import pytest

from som_classifier.verifier import LOG_ERROR_COST, Verifier

POOLED, FEATURES = np.array([1.0, 2.0], np.float32), np.array([0.5], np.float32)
VERIFIER = Verifier(
    pooled_axes=np.array([[0.1, 1.0], [0.2, 0.0]], np.float32),
    convolution_axes=np.array([[0.4, -1.0]], np.float32),
    offsets=np.array([0.05, 0.0], np.float32),
    usual_log_errors=(-2.0, -2.0),
    slope=10.0,
    intercept=-3.0,
    least_likeness=0.2,
    least_found_likeness=0.3,
)


@pytest.mark.parametrize(("action", "likeness"), [(0, 0.1 + 0.4 + 0.2 + 0.05), (1, 1.0 - 0.5)])
def test_likeness_is_the_score_of_one_action(action: int, likeness: float) -> None:
    for usual in (-2.0, -9.0):
        assert VERIFIER.likeness(action, POOLED, FEATURES, usual) == pytest.approx(likeness, abs=1e-6)


def test_postures_that_are_unlike_the_action_cost_by_the_square() -> None:
    for unlike in (1.0, 2.0, 3.0):
        lost = VERIFIER.likeness(0, POOLED, FEATURES, -2.0) - VERIFIER.likeness(0, POOLED, FEATURES, -2.0 + unlike)
        assert lost == pytest.approx(LOG_ERROR_COST * unlike**2, abs=1e-6)


def test_a_probability_is_the_logistic_function_of_the_likeness() -> None:
    assert VERIFIER.probability(0.3) == pytest.approx(0.5)
    assert VERIFIER.probability(0.5) == pytest.approx(1 / (1 + np.exp(-2)))


@pytest.mark.parametrize(("intercept", "probability"), [(-1e9, 0.0), (1e9, 1.0)])
def test_a_probability_stays_one_however_sure(intercept: float, probability: float) -> None:
    assert replace(VERIFIER, intercept=intercept).probability(0.3) == pytest.approx(probability, abs=1e-9)
