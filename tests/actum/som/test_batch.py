"""Batch training and the linear start, against the equation and plain principal components."""

import tracemalloc

import numpy as np
import pytest

from actum.som import BatchTraining, Som
from map_cases import rng


def one_epoch(som: Som, vectors: np.ndarray, radius: float) -> np.ndarray:
    """The equation with every Gaussian written out."""
    apart2 = np.square(som.coordinates[:, None] - som.coordinates).sum(axis=2)
    winners = np.square(vectors[:, None] - som.weights).sum(axis=2).argmin(axis=1)
    pulls = np.exp(-apart2 / (2 * radius**2))[:, winners]
    return pulls @ vectors / pulls.sum(axis=1, keepdims=True)


@pytest.mark.parametrize(("dtype", "tolerance"), [(np.float64, 1e-12), (np.float32, 1e-5)])
def test_an_epoch_moves_every_unit_to_the_mean_of_its_neighbourhood(dtype: type, tolerance: float) -> None:
    vectors = rng(1).random((300, 4))
    som = Som.random(6, 9, 4, rng(), dtype)
    training = BatchTraining(som, vectors, [3.0, 1.2])
    for radius in (3.0, 1.2):
        expected = one_epoch(training.som, vectors, radius)
        training.run_epoch()
        np.testing.assert_allclose(training.som.weights, expected, atol=tolerance)
    assert training.som.weights.dtype == dtype


def test_a_large_map_needs_no_table_of_all_pairs_of_units() -> None:
    """48 × 48 units have 42 MB of distances."""
    som = Som.random(48, 48, 2, rng())
    training = BatchTraining(som, rng(1).random((100, 2)), [3.0])
    tracemalloc.start()
    try:
        training.run_epoch()
        assert tracemalloc.get_traced_memory()[1] < 10e6
    finally:
        tracemalloc.stop()


def test_a_unit_that_no_input_reaches_stays_where_it_is() -> None:
    som = Som(1, 3, np.array([[0.0], [5.0], [9.0]]))
    assert som.train_batch([[1.0], [2.0]], 1, (0.01, 0.01)).weights.tolist() == [[1.5], [5.0], [9.0]]


def test_the_radius_falls_exponentially_over_the_epochs() -> None:
    vectors = rng(1).random((100, 2))
    som = Som.random(4, 4, 2, rng())
    explicit = BatchTraining(som, vectors, [4.0, 2.0, 1.0])
    for _ in range(3):
        explicit.run_epoch()
    assert (som.train_batch(vectors, 3, (4.0, 1.0)).weights == explicit.som.weights).all()
    with pytest.raises(IndexError):
        explicit.run_epoch()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_map_is_ordered(dtype: type) -> None:
    vectors = rng(1).random((500, 2)).astype(dtype)
    trained = Som.linear(8, 8, vectors).train_batch(vectors, 15, (4.0, 0.7))
    assert trained.quantization_error(vectors) < 0.06
    assert trained.topographic_error(vectors) < 0.1


def test_progress_is_reported_to_its_end() -> None:
    reported: list[tuple[int, int]] = []
    Som.random(2, 2, 1, rng()).train_batch([[1.0]], 2, (1.0, 1.0), lambda *progress: reported.append(progress))
    assert reported == [(0, 2), (1, 2), (2, 2)]


@pytest.mark.parametrize("radius", [0.0, -1.0, np.nan, np.inf])
def test_radii_that_make_no_sense_are_refused(radius: float) -> None:
    with pytest.raises(ValueError, match="radii"):
        BatchTraining(Som.random(2, 2, 2, rng()), np.zeros((3, 2)), [radius])


@pytest.mark.parametrize("dim", [2, 5, 40])
def test_a_linear_map_spans_the_two_main_directions(dim: int) -> None:
    """Four standard deviations along either; the first principal component along the longer side."""
    vectors = rng(1).normal(size=(400, dim)) * np.geomspace(8, 1, dim) @ np.linalg.qr(rng(2).normal(size=(dim, dim)))[0]
    variances, directions = np.linalg.eigh(np.cov(vectors.T, bias=True))
    planes = Som.linear(5, 9, vectors).planes
    along, across = planes[2, 8] - planes[2, 0], planes[4, 4] - planes[0, 4]
    for axis, number in ((along, -1), (across, -2)):
        assert np.linalg.norm(axis) == pytest.approx(4 * variances[number] ** 0.5, rel=1e-6)
        assert abs(axis @ directions[:, number]) == pytest.approx(np.linalg.norm(axis), rel=1e-6)
    np.testing.assert_allclose(planes[2, 4], vectors.mean(axis=0), atol=1e-12)


def test_a_linear_map_of_one_dimension_or_of_equal_inputs_is_finite() -> None:
    assert Som.linear(2, 3, rng().random((10, 1))).weights.shape == (6, 1)
    assert Som.linear(1, 4, rng().random((10, 3))).weights.shape == (4, 3)
    np.testing.assert_allclose(Som.linear(2, 2, np.full((5, 3), 7.0)).weights, 7.0)


@pytest.mark.parametrize(
    ("vectors", "problem"),
    [
        (np.zeros((0, 2)), "cannot train"),
        (np.zeros(2), "cannot train"),
        ([[1.0, np.nan], [2.0, np.nan]], "component 1 is NaN in every"),
    ],
)
def test_a_linear_map_needs_vectors(vectors: np.ndarray, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        Som.linear(2, 2, vectors)
