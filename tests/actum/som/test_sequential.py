"""Sequential training: steps by hand, seeds, schedules, and pauses that leave no trace."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.som import Schedule, SequentialTraining, Som, Steps
from map_cases import line_map, rng

CONSTANT = Schedule(alpha=(0.5, 0.5), radius=(1.0, 1.0))
FALLING = Schedule(alpha=(0.5, 0.02), radius=(5.0, 0.7))


def test_schedules_run_from_first_to_last_value_over_the_steps() -> None:
    for steps in (3, 50, 1001):
        alpha, radius = Schedule(alpha=(0.4, 0.1), radius=(16.0, 1.0)).values(steps)
        assert len(alpha) == len(radius) == steps
        assert (alpha[0], alpha[-1], radius[0], radius[-1]) == pytest.approx((0.4, 0.1, 16.0, 1.0))
        assert alpha[steps // 2] == pytest.approx(0.2, rel=2 / steps)
        assert radius[steps // 2] == pytest.approx(4.0, rel=3 / steps)
        np.testing.assert_allclose(alpha[1:] / alpha[:-1], alpha[1] / alpha[0])


def test_explicit_steps_are_taken_as_they_are_or_refused_by_number() -> None:
    alphas, radii = Steps([0.5, 0.25], [2.0, 1.0]).values(2)
    assert alphas.tolist() == [0.5, 0.25] and radii.tolist() == [2.0, 1.0]
    with pytest.raises(ValueError, match="3 steps"):
        Steps([0.5, 0.25], [2.0, 1.0]).values(3)


def test_training_leaves_the_untrained_map_alone_and_is_repeatable() -> None:
    som = Som.random(6, 6, 3, rng())
    before = som.weights.copy()
    vectors = rng(1).random((40, 3))
    first, second = (som.train(vectors, 300, FALLING, rng(2)) for _ in range(2))
    assert (som.weights == before).all()
    assert (first.weights == second.weights).all()
    assert (first.weights != som.train(vectors, 300, FALLING, rng(3)).weights).any()


def test_training_is_what_its_equation_says() -> None:
    """The same map from the equation written out, in as many lines."""
    som = Som.random(5, 6, 3, rng())
    vectors = rng(1).random((40, 3))
    weights = som.weights.copy()
    order = rng(2).integers(40, size=400)
    for index, alpha, radius in zip(order, *FALLING.values(400), strict=True):
        winner = np.argmin(((weights - vectors[index]) ** 2).sum(axis=1))
        distances2 = ((som.coordinates - som.coordinates[winner]) ** 2).sum(axis=1)
        weights += alpha * np.exp(-distances2 / (2 * radius**2))[:, None] * (vectors[index] - weights)
    np.testing.assert_allclose(som.train(vectors, 400, FALLING, rng(2)).weights, weights, atol=1e-12)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_training_orders_the_map(dtype: type) -> None:
    vectors = rng(1).random((500, 2)).astype(dtype)
    untrained = Som.random(8, 8, 2, rng(), dtype)
    trained = untrained.train(vectors, 4000, FALLING, rng(2))
    assert trained.weights.dtype == dtype
    assert trained.quantization_error(vectors) < 0.07
    assert untrained.topographic_error(vectors) > 0.5
    assert trained.topographic_error(vectors) < 0.15


def test_progress_is_reported_to_its_end() -> None:
    reported: list[tuple[int, int]] = []
    line_map().train([[1.0]], 2500, CONSTANT, rng(), lambda done, total: reported.append((done, total)))
    assert reported == [(0, 2500), (1000, 2500), (2000, 2500), (2500, 2500)]


@pytest.mark.parametrize(
    ("order", "decay", "problem"),
    [
        ([0, 2], Steps([0.1] * 2, [1.0] * 2), "row numbers from 0 to 2, but .*: use row numbers from 0 to 1"),
        ([-1, 0], Steps([0.1] * 2, [1.0] * 2), "row numbers from -1 to 0"),
        ([0.5], Steps([0.1], [1.0]), "give one integer for each step"),
        ([0], Steps([np.nan], [1.0]), "alpha"),
        ([0, 0], Steps([0.5, 50.0], [1.0] * 2), "alpha.* is 0.5 and the largest 50.0: give strengths from 0 to 1"),
        ([0, 0], Steps([0.5, -0.1], [1.0] * 2), "alpha.* is -0.1 and the largest 0.5: give strengths from 0 to 1"),
        ([0, 0], Schedule((0.5, 0.0), (2.0, 1.0)), "exponential schedule from 0.5 to 0.0"),
        ([0, 0], Schedule((0.5, 0.1), (2.0, -1.0)), "exponential schedule from 2.0 to -1.0"),
        ([0], Steps([0.1], [0.0]), "radii"),
        ([0], Steps([0.1], [np.inf]), "radii"),
    ],
)
def test_steps_that_make_no_sense_are_refused(order: list[float], decay: Schedule | Steps, problem: str) -> None:
    with pytest.raises(ValueError, match=problem):
        SequentialTraining(line_map(), [[1.0], [2.0]], order, decay)


@given(st.lists(st.integers(1, 400), max_size=5), st.sampled_from([np.float32, np.float64]))
def test_a_training_may_be_interrupted_anywhere(stops: list[int], dtype: type) -> None:
    som = Som.random(4, 4, 2, rng(), dtype)
    vectors = rng(1).random((30, 2))
    training = SequentialTraining(som, vectors, rng(2).integers(30, size=600), FALLING)
    for steps in stops:
        training.run(steps)
    training.run(600)
    assert training.steps_done == 600
    assert (training.som.weights == som.train(vectors, 600, FALLING, rng(2)).weights).all()
