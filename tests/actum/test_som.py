"""The self-organising map against hand-computed cases and its invariances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from actum.som import Schedule, Som

CONSTANT = Schedule(alpha=(0.5, 0.5), radius=(1.0, 1.0))
FALLING = Schedule(alpha=(0.5, 0.02), radius=(5.0, 0.7))


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def line_map() -> Som:
    """Three neurons in a row at 0, 1 and 10 on the number line."""
    return Som(1, 3, np.array([[0.0], [1.0], [10.0]]))


def test_random_weights_are_drawn_from_zero_to_one() -> None:
    som = Som.random(30, 30, 9, rng())
    assert som.weights.shape == (900, 9)
    assert som.weights.min() >= 0 and som.weights.max() <= 1
    assert som.weights.mean() == pytest.approx(0.5, abs=0.02)


def test_neurons_are_numbered_row_by_row() -> None:
    assert Som.random(2, 3, 1, rng()).coordinates.tolist() == [[0, 0], [0, 1], [0, 2], [1, 0], [1, 1], [1, 2]]


def test_weights_cannot_be_written_and_are_the_maps_own() -> None:
    given_weights = np.zeros((3, 1))
    som = Som(1, 3, given_weights)
    given_weights[:] = 7
    assert som.weights.max() == 0
    with pytest.raises(ValueError, match="read-only"):
        som.weights[0] = 1


@pytest.mark.parametrize("weights", [np.zeros((4, 1)), np.zeros(3), np.full((3, 1), np.nan)])
def test_weights_that_do_not_fit_the_grid_are_refused(weights: np.ndarray) -> None:
    with pytest.raises(ValueError, match="1×3"):
        Som(1, 3, weights)


def test_distances_and_winner_by_hand() -> None:
    som = line_map()
    assert som.distances2(np.array([3.0])).tolist() == [9, 4, 49]
    assert som.excess2(np.array([3.0])).tolist() == [5, 0, 45]
    assert som.bmu(np.array([3.0])) == 1


def test_the_first_of_equal_units_wins() -> None:
    assert Som(1, 3, np.array([[0.0], [2.0], [2.0]])).bmu(np.array([1.0])) == 0
    assert Som(1, 3, np.array([[0.0], [2.0], [2.0]])).bmu(np.array([2.0])) == 1


@given(arrays(np.float64, (7, 9), elements=st.floats(-3, 3)))
def test_the_winner_is_the_nearest_neuron(vectors: np.ndarray) -> None:
    som = Som.random(6, 5, 9, rng())
    for x, winner in zip(vectors, som.bmus(vectors), strict=True):
        distances2 = ((som.weights - x) ** 2).sum(axis=1)
        np.testing.assert_allclose(som.distances2(x), distances2)
        np.testing.assert_allclose(som.excess2(x), distances2 - distances2.min(), atol=1e-12)
        assert distances2[som.bmu(x)] == pytest.approx(distances2.min(), abs=1e-12)
        assert distances2[winner] == pytest.approx(distances2.min(), abs=1e-12)


def test_the_winner_is_found_where_the_activity_is_too_flat_to_tell() -> None:
    """With the paper's sigma of a million, neurons at 0.30 and 0.31 m are equally active in single precision."""
    som = Som(1, 2, np.array([[0.31], [0.30]]))
    activity = np.exp(-np.sqrt(som.distances2(np.zeros(1))) / 1e6).astype(np.float32)
    assert activity[0] == activity[1]
    assert som.bmu(np.zeros(1)) == 1


def test_many_vectors_are_answered_like_few() -> None:
    som = Som.random(10, 10, 4, rng())
    vectors = rng(1).random((1000, 4))
    assert som.bmus(vectors).tolist() == [som.bmu(x) for x in vectors]


def test_schedules_run_from_first_to_last_value_over_the_steps() -> None:
    for steps in (3, 50, 1001):
        alpha, radius = Schedule(alpha=(0.4, 0.1), radius=(16.0, 1.0)).values(steps)
        assert len(alpha) == len(radius) == steps
        assert (alpha[0], alpha[-1], radius[0], radius[-1]) == pytest.approx((0.4, 0.1, 16.0, 1.0))
        assert alpha[steps // 2] == pytest.approx(0.2, rel=2 / steps)
        assert radius[steps // 2] == pytest.approx(4.0, rel=3 / steps)
        np.testing.assert_allclose(alpha[1:] / alpha[:-1], alpha[1] / alpha[0])


def test_one_step_by_hand() -> None:
    """w += α exp(−r²/2σ²) (x − w), with r squared: 1, e^(−1/2), e^(−2) for neurons 0, 1 and 2 away."""
    x = 2.0
    trained = line_map().train([[x]], 1, CONSTANT, rng())
    pull = 0.5 * np.exp([-0.5, 0.0, -0.5])
    expected = np.array([0.0, 1.0, 10.0]) + pull * (x - np.array([0.0, 1.0, 10.0]))
    np.testing.assert_allclose(trained.weights[:, 0], expected)

    far = line_map().train([[-1.0]], 1, CONSTANT, rng()).weights[2, 0]
    assert far == pytest.approx(10 + 0.5 * np.exp(-2.0) * -11)


def test_the_neighbourhood_is_round_on_the_grid() -> None:
    som = Som(5, 7, np.zeros((35, 1)))
    weights = som.train([[1.0]], 1, CONSTANT, rng()).weights[:, 0]
    distances2 = (som.coordinates**2).sum(axis=1)
    np.testing.assert_allclose(weights, 0.5 * np.exp(-distances2 / 2))


def test_training_leaves_the_untrained_map_alone_and_is_repeatable() -> None:
    som = Som.random(6, 6, 3, rng())
    before = som.weights.copy()
    vectors = rng(1).random((40, 3))
    first, second = (som.train(vectors, 300, FALLING, rng(2)) for _ in range(2))
    assert (som.weights == before).all()
    assert (first.weights == second.weights).all()
    assert (first.weights != som.train(vectors, 300, FALLING, rng(3)).weights).any()


def test_training_orders_the_map() -> None:
    vectors = rng(1).random((500, 2))
    untrained = Som.random(8, 8, 2, rng())
    trained = untrained.train(vectors, 4000, FALLING, rng(2))
    assert trained.quantization_error(vectors) < 0.07
    assert untrained.topographic_error(vectors) > 0.5
    assert trained.topographic_error(vectors) < 0.15


def test_training_with_a_wide_radius_goes_to_the_mean() -> None:
    everywhere = Schedule(alpha=(0.2, 0.001), radius=(1e6, 1e6))
    trained = Som.random(3, 3, 1, rng()).train([[2.0], [4.0]], 4000, everywhere, rng())
    np.testing.assert_allclose(trained.weights, 3.0, atol=0.1)


def test_progress_is_reported_to_its_end() -> None:
    reported: list[tuple[int, int]] = []
    line_map().train([[1.0]], 2500, CONSTANT, rng(), lambda done, total: reported.append((done, total)))
    assert reported == [(0, 2500), (1000, 2500), (2000, 2500), (2500, 2500)]


@pytest.mark.parametrize("vectors", [np.zeros((0, 1)), np.zeros((2, 2)), np.zeros(1), [[np.nan]], [[np.inf]]])
def test_inputs_that_do_not_fit_are_refused(vectors: np.ndarray) -> None:
    with pytest.raises(ValueError, match="cannot train"):
        line_map().train(vectors, 1, CONSTANT, rng())


def test_quantization_error_is_the_mean_distance_to_the_winner() -> None:
    assert line_map().quantization_error(np.array([[0.5], [13.0]])) == pytest.approx((0.5 + 3.0) / 2)


def test_topographic_error_is_the_share_whose_best_two_are_apart() -> None:
    """The best two of 0.4, 2.4 and 3.6 stand at columns 0 and 2, 3 and 2, 3 and 1."""
    som = Som(1, 4, np.array([[0.0], [5.0], [1.0], [3.0]]))
    assert som.topographic_error(np.array([[0.4], [2.4], [3.6]])) == pytest.approx(2 / 3)


def test_diagonal_neighbours_are_neighbours() -> None:
    som = Som(2, 2, np.array([[0.0], [9.0], [9.0], [1.0]]))
    assert som.topographic_error(np.array([[0.4]])) == 0
