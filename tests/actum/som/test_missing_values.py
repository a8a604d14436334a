"""Components that are NaN: left out of every distance, and nothing learned from them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from actum.som import BatchTraining, Schedule, SequentialTraining, Som, Steps, adapt_in_numpy
from map_cases import rng

NAN = np.nan


def with_gaps(vectors: np.ndarray, seed: int = 3) -> np.ndarray:
    """Blank about a third of the components, but the first of each row never."""
    blanked = vectors.copy()
    gaps = rng(seed).random(vectors.shape) < 1 / 3
    gaps[:, 0] = False
    blanked[gaps] = NAN
    return blanked


def test_distances_count_the_known_components_scaled_up_by_hand() -> None:
    """At (3, ?) the squared distances over the first component, 9 and 4, are doubled."""
    som = Som(1, 2, np.array([[0.0, 5.0], [5.0, 7.0]]))
    x = np.array([3.0, NAN])
    assert som.excess2(x).tolist() == [10, 0]
    assert som.bmu(x) == 1
    assert som.quantization_error(x[None]) == pytest.approx(8**0.5)


@given(arrays(np.float64, (6, 5), elements=st.one_of(st.just(NAN), st.floats(-3, 3))))
def test_every_lookup_counts_the_known_components_only(vectors: np.ndarray) -> None:
    vectors[:, 2] = np.nan_to_num(vectors[:, 2])
    som = Som.random(3, 4, 5, rng())
    for i, x in enumerate(vectors):
        known = ~np.isnan(x)
        distances2 = np.square(som.weights - x)[:, known].sum(axis=1) * (5 / known.sum())
        np.testing.assert_allclose(som.excess2(x), distances2 - distances2.min(), atol=1e-11)
        np.testing.assert_allclose(som.excess2s(vectors)[i], distances2 - distances2.min(), atol=1e-11)
        assert distances2[som.bmu(x)] == pytest.approx(distances2.min(), abs=1e-11)
        assert distances2[som.bmus(vectors)[i]] == pytest.approx(distances2.min(), abs=1e-11)
        np.testing.assert_allclose(distances2[som.best_two(vectors)[i]], np.sort(distances2)[:2], atol=1e-11)


def test_a_row_without_any_known_component_is_refused() -> None:
    som = Som.random(2, 2, 2, rng())
    nothing = np.array([NAN, NAN])
    for lookup in (som.bmu, som.excess2):
        with pytest.raises(ValueError, match="only NaN"):
            lookup(nothing)
    rows = np.stack([np.zeros(2), nothing])
    for lookup in (som.bmus, som.best_two, som.excess2s, som.quantization_error, som.topographic_error):
        with pytest.raises(ValueError, match="row 1 of the vectors contains only NaN"):
            lookup(rows)
    with pytest.raises(ValueError, match="cannot train.* row 1 of the vectors contains only NaN"):
        som.train_batch(rows, 1, (1.0, 1.0))


def test_training_leaves_the_missing_components_of_all_units_as_they_are() -> None:
    som = Som.random(4, 4, 3, rng())
    vectors = rng(1).random((50, 3))
    vectors[:, 1] = NAN
    schedule = Schedule(alpha=(0.5, 0.1), radius=(2.0, 1.0))
    for trained in (som.train(vectors, 60, schedule, rng(2)), som.train_batch(vectors, 3, (2.0, 1.0))):
        assert (trained.weights[:, 1] == som.weights[:, 1]).all()
        assert (trained.weights[:, [0, 2]] != som.weights[:, [0, 2]]).all()


def test_training_without_a_component_is_training_in_fewer_dimensions() -> None:
    som = Som.random(4, 5, 3, rng())
    flat = Som(4, 5, som.weights[:, [0, 2]])
    vectors = rng(1).random((50, 3))
    gappy = np.where([False, True, False], NAN, vectors)
    decay = Steps(np.full(50, 0.3), np.linspace(3, 1, 50))
    for kernel in (adapt_in_numpy, None):
        whole = SequentialTraining(som, gappy, np.arange(50), decay, kernel)
        part = SequentialTraining(flat, vectors[:, [0, 2]], np.arange(50), decay, kernel)
        whole.run(50)
        part.run(50)
        assert (whole.som.weights[:, [0, 2]] == part.som.weights).all()


def test_a_batch_epoch_moves_each_component_to_the_mean_of_the_known() -> None:
    """A single unit wins all: the means are those of the known values of each column."""
    vectors = with_gaps(rng(1).random((60, 4)))
    training = BatchTraining(Som(1, 1, np.zeros((1, 4))), vectors, [1.0])
    training.run_epoch()
    np.testing.assert_allclose(training.som.weights[0], np.nanmean(vectors, axis=0))


def test_maps_are_ordered_in_spite_of_gaps() -> None:
    whole = rng(1).random((600, 2)) @ rng(2).random((2, 5))
    gappy = with_gaps(whole)
    som = Som.linear(7, 7, gappy)
    for trained in (
        som.train_batch(gappy, 15, (3.0, 0.7)),
        som.train(gappy, 4000, Schedule((0.5, 0.02), (3.0, 0.7)), rng(4)),
    ):
        assert trained.quantization_error(whole) < 0.6 * np.linalg.norm(whole - whole.mean(axis=0), axis=1).mean()
        assert trained.topographic_error(whole) < 0.2
