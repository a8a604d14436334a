"""Discriminants are ridge regression as in the textbook; cross-validated scores know nothing of the person scored."""

from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum_model_trainer.discriminants import (
    FOLDS_WITHIN_AN_ACTION,
    MAX_PERSON_FOLDS,
    Discriminants,
    fit_discriminants,
    fit_without_and_with,
    folds_of,
)

SHRINKAGE = 0.2
PEOPLE, ACTIONS = 4, 3
FOLDS = np.repeat(np.arange(PEOPLE), 6)


def training(inputs: int = 40, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Six vectors of each person, two of each action, and the indicators of their actions."""
    rng = np.random.default_rng(seed)
    actions = np.tile(np.repeat(np.arange(ACTIONS), 2), PEOPLE)
    vectors = rng.normal(size=(ACTIONS, inputs))[actions] + rng.normal(size=(len(actions), inputs)) + 3.0
    return vectors.astype(np.float32), np.eye(ACTIONS)[actions]


def ridge(centred: np.ndarray, indicators: np.ndarray, penalty: float) -> tuple[np.ndarray, np.ndarray]:
    """(XᵀX + penalty)⁻¹ Xᵀ (indicators − intercept), and the intercept."""
    intercept = indicators.mean(axis=0)
    system = centred.T @ centred + penalty * np.eye(centred.shape[1])
    return np.linalg.solve(system, centred.T @ (indicators - intercept)), intercept


@pytest.mark.parametrize("inputs", [5, 40])
def test_axes_are_the_ridge_solution(inputs: int) -> None:
    vectors, indicators = training(inputs)
    centred = vectors.astype(np.float64) - vectors.mean(axis=0, dtype=np.float64)
    expected, intercept = ridge(centred, indicators, SHRINKAGE * np.square(centred).sum(axis=1).mean())
    found = fit_discriminants(vectors, indicators, FOLDS, SHRINKAGE)
    np.testing.assert_allclose(found.axes, expected, atol=1e-5)
    np.testing.assert_allclose(found.training_scores, centred @ expected + intercept, atol=1e-4)
    np.testing.assert_allclose(vectors @ found.axes + found.offsets, found.training_scores, atol=1e-4)
    assert found.axes.dtype == found.offsets.dtype == np.float32


@pytest.mark.parametrize("fold", range(PEOPLE))
def test_cross_validated_scores_are_those_of_axes_fitted_without_the_fold(fold: int) -> None:
    """About the mean of all vectors; the labels of the fold are not looked at."""
    vectors, indicators = training()
    centred = vectors.astype(np.float64) - vectors.mean(axis=0, dtype=np.float64)
    penalty = SHRINKAGE * np.square(centred).sum(axis=1).mean()
    axes, intercept = ridge(centred[fold != FOLDS], indicators[fold != FOLDS], penalty)
    found = fit_discriminants(vectors, indicators, FOLDS, SHRINKAGE)
    np.testing.assert_allclose(
        found.cross_validated_scores[fold == FOLDS], centred[fold == FOLDS] @ axes + intercept, atol=1e-4
    )


@given(st.integers(0, PEOPLE - 1), st.permutations(range(ACTIONS)))
def test_labels_of_the_fold_left_out_do_not_matter_to_the_bit(fold: int, order: list[int]) -> None:
    vectors, indicators = training()
    relabelled = np.where((fold == FOLDS)[:, None], indicators[:, order], indicators)
    one, other = (fit_discriminants(vectors, each, FOLDS, SHRINKAGE) for each in (indicators, relabelled))
    np.testing.assert_array_equal(
        one.cross_validated_scores[fold == FOLDS], other.cross_validated_scores[fold == FOLDS]
    )
    if order != sorted(order):
        assert (one.cross_validated_scores[fold != FOLDS] != other.cross_validated_scores[fold != FOLDS]).any()


def test_where_nobody_else_is_there_scores_are_their_own() -> None:
    vectors, indicators = training()
    found = fit_discriminants(vectors, indicators, np.zeros(len(vectors), np.intp), SHRINKAGE)
    np.testing.assert_array_equal(found.cross_validated_scores, found.training_scores)


def test_an_action_that_nobody_else_does_is_scored_by_axes_that_know_it() -> None:
    """Discriminants without it would take it for another with certainty."""
    vectors, indicators = training()
    alone = indicators[:, 2].astype(bool) & (FOLDS != 1)
    found = fit_discriminants(vectors[~alone], indicators[~alone], FOLDS[~alone], SHRINKAGE)
    own_action = indicators[~alone][:, 2].astype(bool)
    np.testing.assert_array_equal(found.cross_validated_scores[own_action], found.training_scores[own_action])
    assert (found.cross_validated_scores[~own_action] != found.training_scores[~own_action]).all()


MANY = [f"{number:02}" for number in range(MAX_PERSON_FOLDS + 3)]


@pytest.mark.parametrize(
    ("people", "labels", "folds"),
    [
        ("bacabc", "aaaaaa", [1, 0, 2, 0, 1, 2]),
        (MANY, "a" * len(MANY), [*range(MAX_PERSON_FOLDS), 0, 1, 2]),
        ("a" * 9, "aabaabaab", [0, 1, 0, 2, 3, 1, 4, 0, 2]),
        ("mmmfm", "xyxxy", [1, 0, 1, 0, 1]),
    ],
    ids=[
        "people are folds",
        "many people share folds",
        "one person's examples are divided",
        "so is one person's action",
    ],
)
def test_folds_are_of_people_or_within_an_action(people: Sequence[str], labels: str, folds: list[int]) -> None:
    """An action that only one person did is divided: without that person nothing would be known of it."""
    assert folds_of(people, list(labels)).tolist() == folds
    assert FOLDS_WITHIN_AN_ACTION == 5


def with_background() -> tuple[np.ndarray, np.ndarray, float, Discriminants]:
    """Seven vectors of background beside the training: all centred, their indicators, the penalty, what is fitted."""
    vectors, indicators = training()
    background = np.random.default_rng(3).normal(size=(7, vectors.shape[1])).astype(np.float32)
    every = np.concatenate([vectors, background])
    centred = every.astype(np.float64) - every.mean(axis=0, dtype=np.float64)
    penalty = SHRINKAGE * np.square(centred).sum(axis=1).mean()
    padded = np.concatenate([indicators, np.zeros((7, ACTIONS))])
    _, found = fit_without_and_with(vectors, indicators, FOLDS, SHRINKAGE, background)
    return centred, padded, penalty, found


@pytest.mark.parametrize("inputs", [5, 40])
def test_background_changes_nothing_of_the_discriminants_without_it(inputs: int) -> None:
    vectors, indicators = training(inputs)
    background = np.random.default_rng(3).normal(size=(7, inputs)).astype(np.float32)
    without, _ = fit_without_and_with(vectors, indicators, FOLDS, SHRINKAGE, background)
    alone = fit_discriminants(vectors, indicators, FOLDS, SHRINKAGE)
    for name, expected in vars(alone).items():
        np.testing.assert_allclose(getattr(without, name), expected, atol=1e-5, err_msg=name)


def test_untaught_scores_are_those_of_axes_fitted_without_the_action() -> None:
    """About the mean of all vectors, background included."""
    centred, indicators, penalty, found = with_background()
    for action in range(ACTIONS):
        kept, rows = indicators[:, action] == 0, np.flatnonzero(indicators[:, action])
        axes, intercept = ridge(centred[kept], indicators[kept], penalty)
        np.testing.assert_allclose(found.untaught_scores[rows], centred[rows] @ axes + intercept, atol=1e-4)
        assert np.abs(found.untaught_scores[rows, action]).max() < 1e-6


def test_background_scores_are_those_of_axes_fitted_without_the_vector() -> None:
    """About the mean of all vectors and indicators."""
    centred, indicators, penalty, found = with_background()
    assert len(found.training_scores) == len(centred) - 7 and len(found.background_scores) == 7
    intercept = indicators.mean(axis=0)
    for number, row in enumerate(range(len(centred) - 7, len(centred))):
        kept = np.arange(len(centred)) != row
        system = centred[kept].T @ centred[kept] + penalty * np.eye(centred.shape[1])
        axes = np.linalg.solve(system, centred[kept].T @ (indicators[kept] - intercept))
        np.testing.assert_allclose(found.background_scores[number], centred[row] @ axes + intercept, atol=1e-4)
