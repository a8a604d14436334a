"""The inverse temperature makes answers as sure as they are right."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum_model_trainer.temperature_scaling import (
    LARGEST_INVERSE_TEMPERATURE,
    SMALLEST_INVERSE_TEMPERATURE,
    confidences,
    matched_inverse_temperature,
)

ACTIONS = 6


def drawn(inverse_temperature: float, answers: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Cosines, and actions drawn with the probabilities of the softmax at the inverse temperature."""
    rng = np.random.default_rng(seed)
    cosines = rng.uniform(-1, 1, (answers, ACTIONS))
    shares = np.exp(inverse_temperature * cosines)
    shares /= shares.sum(axis=1, keepdims=True)
    return cosines, (shares.cumsum(axis=1) < rng.random((answers, 1))).sum(axis=1)


@pytest.mark.parametrize("inverse_temperature", [1.0, 4.0, 15.0])
def test_a_known_inverse_temperature_is_found(inverse_temperature: float) -> None:
    cosines, targets = drawn(inverse_temperature, 20_000)
    accuracy = float((cosines.argmax(axis=1) == targets).mean())
    assert matched_inverse_temperature(cosines, accuracy) == pytest.approx(inverse_temperature, rel=0.06)


@given(st.integers(0, 1000), st.floats(0.3, 0.95))
def test_the_mean_confidence_is_the_accuracy(seed: int, accuracy: float) -> None:
    cosines, _ = drawn(1.0, 200, seed)
    assert confidences(cosines, matched_inverse_temperature(cosines, accuracy)).mean() == pytest.approx(
        accuracy, abs=1e-6
    )


def test_confidences_by_hand() -> None:
    cosines = np.array([[1.0, 0.0], [0.5, 0.5]])
    np.testing.assert_allclose(confidences(cosines, 2.0), [1 / (1 + np.exp(-2)), 0.5])


def test_what_is_added_to_all_cosines_does_not_matter() -> None:
    cosines, _ = drawn(8.0, 500)
    shifted = cosines + np.random.default_rng(1).normal(0, 5, (500, 1))
    assert matched_inverse_temperature(shifted, 0.7) == pytest.approx(matched_inverse_temperature(cosines, 0.7))


def test_the_inverse_temperature_stays_within_its_bounds() -> None:
    cosines, _ = drawn(1.0, 300)
    assert matched_inverse_temperature(cosines, 0.0) == pytest.approx(SMALLEST_INVERSE_TEMPERATURE)
    assert matched_inverse_temperature(cosines, 1.0) == pytest.approx(LARGEST_INVERSE_TEMPERATURE)
