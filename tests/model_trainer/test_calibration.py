"""The gain is the one that made the answers."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from model_trainer.calibration import LARGEST_GAIN, SMALLEST_GAIN, fitted_gain, surprise

ACTIONS = 6


def heard(gain: float, answers: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Cosines, and actions drawn with the probabilities that the gain makes of them."""
    rng = np.random.default_rng(seed)
    cosines = rng.uniform(-1, 1, (answers, ACTIONS))
    shares = np.exp(gain * cosines)
    shares /= shares.sum(axis=1, keepdims=True)
    return cosines, (shares.cumsum(axis=1) < rng.random((answers, 1))).sum(axis=1)


@pytest.mark.parametrize("gain", [1.0, 4.0, 15.0, 60.0])
def test_a_known_gain_is_found(gain: float) -> None:
    assert fitted_gain(*heard(gain, 20_000)) == pytest.approx(gain, rel=0.06)


@given(st.integers(0, 1000), st.floats(1.0, 50.0))
def test_no_gain_explains_the_answers_better(seed: int, gain: float) -> None:
    cosines, targets = heard(gain, 200, seed)
    best = surprise(cosines, targets, fitted_gain(cosines, targets))
    for other in np.geomspace(SMALLEST_GAIN, LARGEST_GAIN, 30):
        assert best <= surprise(cosines, targets, other) + 1e-9


def test_surprise_by_hand() -> None:
    cosines, targets = np.array([[1.0, 0.0], [0.0, 1.0]]), np.array([0, 0])
    assert surprise(cosines, targets, 2.0) == pytest.approx((np.log1p(np.exp(-2)) + np.log1p(np.exp(2))) / 2)
    assert surprise(np.zeros((3, ACTIONS)), np.arange(3), 9.0) == pytest.approx(np.log(ACTIONS))


def test_what_is_added_to_all_cosines_does_not_matter() -> None:
    cosines, targets = heard(8.0, 500)
    shifted = cosines + np.random.default_rng(1).normal(0, 5, (500, 1))
    assert fitted_gain(shifted, targets) == pytest.approx(fitted_gain(cosines, targets))


def test_the_gain_stays_within_its_bounds() -> None:
    cosines, _ = heard(1.0, 300)
    right, wrong = cosines.argmax(axis=1), cosines.argmin(axis=1)
    assert SMALLEST_GAIN <= fitted_gain(cosines, wrong) <= 1.001 * SMALLEST_GAIN
    assert SMALLEST_GAIN <= fitted_gain(cosines, right) <= LARGEST_GAIN
