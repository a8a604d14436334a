"""The map as it is looked up: hand-computed cases and invariances, in both precisions."""

import pickle
from collections.abc import Callable
from copy import copy, deepcopy

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from actum.som import Schedule, Som
from map_cases import line_map, rng


@pytest.mark.parametrize("copied", [copy, deepcopy, lambda som: pickle.loads(pickle.dumps(som))])
def test_copies_are_the_same_map_and_cannot_be_written_either(copied: Callable[[Som], Som]) -> None:
    som = Som.random(3, 4, 2, rng(), np.float32)
    som.bmus([[0.5, 0.5]])
    twin = copied(som)
    assert (twin.rows, twin.cols, twin.dtype) == (3, 4, np.float32)
    assert (twin.weights == som.weights).all()
    assert not twin.weights.flags.writeable


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


@pytest.mark.parametrize("weights", [np.zeros((4, 1)), np.zeros(3), np.full((3, 1), np.nan), np.zeros((3, 0))])
def test_weights_that_do_not_fit_the_grid_are_refused(weights: np.ndarray) -> None:
    with pytest.raises(ValueError, match="1×3"):
        Som(1, 3, weights)


@pytest.mark.parametrize(
    ("given_type", "kept"), [(np.float32, np.float32), (np.float64, np.float64), (np.int64, np.float64)]
)
def test_single_and_double_precision_are_kept_as_given(given_type: type, kept: type) -> None:
    som = Som(1, 3, np.array([[0], [1], [10]], given_type))
    assert som.weights.dtype == kept
    assert som.excess2(np.array([3.0])).dtype == kept
    assert som.excess2s(np.array([[3.0]])).dtype == kept


def test_the_same_weights_are_drawn_in_either_precision() -> None:
    double, single = Som.random(4, 4, 3, rng()), Som.random(4, 4, 3, rng(), np.float32)
    assert (double.weights.astype(np.float32) == single.weights).all()


def test_the_first_of_equal_units_wins() -> None:
    som = Som(1, 3, np.array([[0.0], [2.0], [2.0]]))
    assert [som.bmu(np.array([x])) for x in (1.0, 2.0)] == [0, 1]
    assert som.bmus([[1.0], [2.0]]).tolist() == [0, 1]
    assert som.best_two([[1.0], [2.0]]).tolist() == [[0, 1], [1, 2]]


@given(arrays(np.float64, (7, 9), elements=st.floats(-3, 3)))
def test_the_winner_is_the_nearest_neuron(vectors: np.ndarray) -> None:
    som = Som.random(6, 5, 9, rng())
    lookups = zip(vectors, som.bmus(vectors), som.best_two(vectors), som.excess2s(vectors), strict=True)
    for x, winner, best_two, excess2 in lookups:
        distances2 = ((som.weights - x) ** 2).sum(axis=1)
        np.testing.assert_allclose(som.excess2(x), distances2 - distances2.min(), atol=1e-12)
        np.testing.assert_allclose(excess2, distances2 - distances2.min(), atol=1e-12)
        assert distances2[som.bmu(x)] == pytest.approx(distances2.min(), abs=1e-12)
        assert distances2[winner] == pytest.approx(distances2.min(), abs=1e-12)
        np.testing.assert_allclose(distances2[best_two], np.sort(distances2)[:2], atol=1e-12)


@given(st.floats(-100, 100).map(lambda offset: round(offset * 8) / 8))
def test_where_the_inputs_lie_does_not_matter_even_in_single_precision(offset: float) -> None:
    """Weights and inputs a few hundredths apart: far from zero |w|² − 2 w·x alone would keep none of it."""
    weights = np.round(rng().random((30, 4)) * 64) / 1024
    vectors = np.round(rng(1).random((20, 4)) * 64) / 1024
    here = Som(5, 6, weights.astype(np.float32)).excess2s(vectors.astype(np.float32))
    there = Som(5, 6, (weights + offset).astype(np.float32)).excess2s((vectors + offset).astype(np.float32))
    np.testing.assert_allclose(here, there, atol=1e-8)


@pytest.mark.parametrize("dim", [1, 4, 130, 300])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_many_vectors_are_answered_like_few(dim: int, dtype: type) -> None:
    som = Som.random(10, 10, dim, rng(), dtype)
    vectors = rng(1).random((300, dim)).astype(dtype)
    winners = som.bmus(vectors)
    assert winners.tolist() == [som.bmu(x) for x in vectors]
    assert winners.tolist() == som.best_two(vectors)[:, 0].tolist()
    np.testing.assert_allclose(som.excess2s(vectors)[7], som.excess2(vectors[7]), rtol=1e-4, atol=1e-4)


def test_no_vectors_have_no_winners() -> None:
    som = line_map()
    assert som.bmus(np.zeros((0, 1))).shape == (0,)
    assert som.best_two(np.zeros((0, 1))).shape == (0, 2)
    assert som.excess2s(np.zeros((0, 1))).shape == (0, 3)


def test_a_map_of_one_unit_has_no_second_best() -> None:
    with pytest.raises(ValueError, match="one unit"):
        Som(1, 1, np.zeros((1, 1))).best_two([[1.0]])


def test_vectors_of_another_length_are_refused() -> None:
    som = Som.random(2, 2, 3, rng())
    for x in (np.zeros(2), np.zeros(1), np.zeros((1, 3))):
        with pytest.raises(ValueError, match=r"the map has 3 components: give a vector of the shape \(3,\)"):
            som.bmu(x)
    for lookup in (som.bmus, som.best_two, som.excess2s):
        with pytest.raises(ValueError, match=r"give an array of the shape \(number of vectors, 3\)"):
            lookup(np.zeros((5, 1)))


def test_lists_and_values_that_are_no_floats_are_looked_up_like_arrays() -> None:
    som = line_map()
    assert som.bmu([3]) == som.bmu(np.array([3])) == som.bmus([[3]])[0] == 1
    assert som.excess2([3]).tolist() == [5, 0, 45]
    assert (Som.of_planes([[[0.0], [1.0], [10.0]]]).weights == som.weights).all()
    pair = Som(1, 2, np.array([[0.0, 5.0], [5.0, 7.0]]))
    assert pair.bmus([[3.0, None]]).tolist() == pair.bmus([[3.0, np.nan]]).tolist() == [1]


def test_where_units_stand_cannot_be_written() -> None:
    coordinates = Som.random(3, 4, 2, rng()).coordinates
    with pytest.raises(ValueError, match="read-only"):
        np.multiply(coordinates, 30, out=coordinates)


@pytest.mark.parametrize("vectors", [np.zeros((0, 1)), np.zeros((2, 2)), np.zeros(1), [[np.nan]], [[np.inf]]])
def test_inputs_that_do_not_fit_are_refused_by_either_training(vectors: np.ndarray) -> None:
    with pytest.raises(ValueError, match="cannot train"):
        line_map().train(vectors, 1, Schedule(alpha=(0.5, 0.5), radius=(1.0, 1.0)), rng())
    with pytest.raises(ValueError, match="cannot train"):
        line_map().train_batch(vectors, 1, (1.0, 1.0))


@pytest.mark.parametrize(("dtype", "allowed", "too_large"), [(np.float32, 1e18, 1e20), (np.float64, 1e150, 1e155)])
def test_values_whose_squares_overflow_are_refused(dtype: type, allowed: float, too_large: float) -> None:
    weights = rng().random((20, 4))
    vectors = rng(1).random((30, 4))
    som, large = Som(4, 5, weights.astype(dtype)), Som(4, 5, (weights * allowed).astype(dtype))
    assert (large.bmus(vectors * allowed) == som.bmus(vectors)).all()
    with pytest.raises(ValueError, match=f"too large to compute distances in {dtype.__name__}"):
        Som(4, 5, (weights * too_large).astype(dtype))
    with pytest.raises(ValueError, match=f"cannot train.* too large to compute distances in {dtype.__name__}"):
        som.train_batch(vectors * too_large, 1, (1.0, 1.0))


def test_infinite_components_are_refused() -> None:
    som = Som.random(2, 2, 2, rng())
    broken = np.array([np.inf, 0.5])
    for lookup in (som.bmu, som.excess2):
        with pytest.raises(ValueError, match="infinite"):
            lookup(broken)
    with pytest.raises(ValueError, match="row 1 of the vectors contains an infinite"):
        som.bmus(np.stack([np.zeros(2), broken]))


def test_planes_show_each_component_on_the_grid() -> None:
    planes = Som(2, 2, np.array([[0.0, 9.0], [1.0, 8.0], [2.0, 7.0], [3.0, 6.0]])).planes
    assert planes[:, :, 0].tolist() == [[0, 1], [2, 3]]
    assert planes[:, :, 1].tolist() == [[9, 8], [7, 6]]
