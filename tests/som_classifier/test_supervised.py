"""The third layer against hand-computed cases; the delta rule has the sign that learns."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from som_classifier.supervised import SupervisedLayer, adapt


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def blobs(seed: int, per_class: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Non-negative inputs of three classes, each around its own axis."""
    targets = np.repeat(np.arange(3), per_class)
    inputs = 0.3 * rng(seed).random((len(targets), 6))
    inputs[np.arange(len(targets)), targets] += 1.0
    return inputs, targets


def test_cosines_by_hand() -> None:
    layer = SupervisedLayer(np.array([[1.0, 0.0], [0.6, 0.8]]))
    np.testing.assert_allclose(layer.cosines(np.array([3.0, 4.0])), [0.6, 1.0])


@given(st.floats(1e-3, 1e3))
def test_cosines_do_not_depend_on_the_inputs_length(factor: float) -> None:
    layer = SupervisedLayer.random(4, 5, rng())
    x = rng(1).random(5)
    np.testing.assert_allclose(layer.cosines(factor * x), layer.cosines(x))


def test_random_weights_are_positive_and_of_unit_length() -> None:
    weights = SupervisedLayer.random(5, 1225, rng()).weights
    assert weights.min() >= 0
    np.testing.assert_allclose(np.linalg.norm(weights, axis=1), 1.0)


@pytest.mark.parametrize("weights", [np.ones(3), np.ones((2, 3)), np.zeros((2, 3)), np.full((2, 3), np.nan)])
def test_weights_that_are_no_unit_vectors_are_refused(weights: np.ndarray) -> None:
    with pytest.raises(ValueError, match="not a matrix of unit vectors"):
        SupervisedLayer(weights)


def test_delta_rule_by_hand() -> None:
    """y = 0.6 where 1 is desired: w + 0.5 · 0.4 · x, made unit length; y = 0 where 0 is desired: unchanged."""
    weights = np.array([[0.6, 0.8], [0.0, 1.0]])
    adapt(weights, np.array([1.0, 0.0]), np.array([1.0, 0.0]), 0.5)
    np.testing.assert_allclose(weights[0], np.array([0.8, 0.8]) / np.hypot(0.8, 0.8))
    np.testing.assert_allclose(weights[1], [0.0, 1.0])


@given(st.integers(0, 1000), st.floats(0.01, 0.9), st.integers(0, 2))
def test_the_delta_rule_moves_every_answer_towards_what_is_desired(seed: int, beta: float, target: int) -> None:
    weights = SupervisedLayer.random(3, 5, rng(seed)).weights.copy()
    x = rng(seed + 1).random(5)
    x /= np.linalg.norm(x)
    desired = np.eye(3)[target]
    before = weights @ x
    adapt(weights, x, desired, beta)
    assert (np.abs(desired - weights @ x) < np.abs(desired - before)).all()
    np.testing.assert_allclose(np.linalg.norm(weights, axis=1), 1.0)


def test_training_learns_to_answer() -> None:
    inputs, targets = blobs(seed=1)
    trained = SupervisedLayer.random(3, 6, rng()).train(inputs, targets, 0.35, 20, rng())
    unseen, expected = blobs(seed=2)
    assert [int(np.argmax(trained.cosines(x))) for x in unseen] == expected.tolist()


def test_training_shows_each_input_once_per_epoch_and_reports_it() -> None:
    inputs, targets = blobs(seed=1)
    untrained = SupervisedLayer.random(3, 6, rng())
    reported: list[tuple[int, int]] = []
    trained = untrained.train(inputs, targets, 0.35, 1, rng(5), lambda done, total: reported.append((done, total)))
    by_hand = untrained.weights.copy()
    for index in rng(5).permutation(len(inputs)):
        adapt(by_hand, inputs[index] / np.linalg.norm(inputs[index]), np.eye(3)[targets[index]], 0.35)
    np.testing.assert_allclose(trained.weights, by_hand)
    assert reported == [(1, 1)]
    assert (untrained.weights == SupervisedLayer.random(3, 6, rng()).weights).all()
