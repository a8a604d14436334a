"""The map of actions and its neurons learn scores, and are as sure as scores of people left out let them be."""

import numpy as np
import pytest

from actum_model_trainer.discriminants import Axes
from actum_model_trainer.progress import silent
from actum_model_trainer.upper_layers import Scored, UpperLayers, mixed, train_upper, variance_within
from performers import TINY

ACTIONS, PEOPLE, EACH = 3, 4, 5
TARGETS = np.tile(np.repeat(np.arange(ACTIONS), EACH), PEOPLE)
FOLDS = np.repeat(np.arange(PEOPLE), ACTIONS * EACH)
NOBODY = np.zeros((0, ACTIONS), np.float32)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def scores(noise: float, seed: int = 0) -> np.ndarray:
    """About 1 for the action done and 0 for the others."""
    return np.asarray(np.eye(ACTIONS)[TARGETS] + rng(seed).normal(0, noise, (len(TARGETS), ACTIONS)))


def scored(own_noise: float, held_out_noise: float) -> Scored:
    axes = Axes(NOBODY, NOBODY, scores(own_noise), scores(held_out_noise, 1))
    return Scored(axes, np.arange(len(TARGETS)), TARGETS, FOLDS)


def upper(stage: Scored) -> UpperLayers:
    return train_upper(stage, ACTIONS, TINY, rng(), silent)


def test_unseen_scores_are_answered() -> None:
    unseen = upper(scored(0.1, 0.2)).cosines(scores(0.2, seed=7))
    assert (unseen.argmax(axis=1) == TARGETS).mean() > 0.95


def test_cosines_are_those_of_each_row_alone() -> None:
    layers, rows = upper(scored(0.1, 0.2)), scores(0.2, seed=7)[:6].astype(np.float32)
    alone = [layers.layer3.cosines(layers.action_map.activity(row)) for row in rows]
    np.testing.assert_allclose(layers.cosines(rows), np.stack(alone), atol=1e-5)


def test_what_the_map_learns_is_partly_the_one_partly_the_other() -> None:
    """Half and half: the mean of the map's inputs is what its linear beginning stands about."""
    one, other = scored(0.1, 0.3), scored(0.3, 0.1)
    swapped = Axes(NOBODY, NOBODY, one.axes.held_out, one.axes.own)
    mirrored = Scored(swapped, one.owners, one.targets, one.folds)
    assert TINY.held_out_share == 0.5
    np.testing.assert_array_equal(upper(one).action_map.som.weights, upper(mirrored).action_map.som.weights)
    assert (upper(one).action_map.som.weights != upper(other).action_map.som.weights).any()


def test_one_example_of_each_action_is_enough() -> None:
    """Its scores are almost perfect, those of strangers not half as large: there the map of actions must be at home."""
    targets = np.arange(10)
    perfect = 0.98 * np.eye(10)
    layers = train_upper(
        Scored(Axes(NOBODY, NOBODY, perfect, perfect), targets, targets, np.zeros(10, np.intp)), 10, TINY, rng(), silent
    )
    asked = rng().integers(10, size=200)
    strangers = 0.35 * np.eye(10)[asked] + rng(1).normal(0.06, 0.04, (200, 10))
    told = layers.cosines(strangers).argmax(axis=1)
    assert (told == strangers.argmax(axis=1)).mean() > 0.95


def test_mixtures_fill_up_what_is_few() -> None:
    rows, targets = mixed(np.eye(3), np.arange(3), 500, 0.55, rng())
    np.testing.assert_array_equal(rows[:3], np.eye(3))
    np.testing.assert_array_equal(targets[:3], np.arange(3))
    assert rows.shape == (500, 3)
    np.testing.assert_array_equal(rows.argmax(axis=1), targets)
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    assert 0.55 <= rows.max(axis=1).min() < 0.6


def test_what_is_enough_stays_as_it_is() -> None:
    rows, targets = mixed(scores(0.1), TARGETS, len(TARGETS), 0.55, rng())
    np.testing.assert_array_equal(rows, scores(0.1))
    np.testing.assert_array_equal(targets, TARGETS)


def test_variance_within_by_hand() -> None:
    """Of the first action 1 and 4, of the second 0 and 0: what lies between actions does not count."""
    rows = np.array([[0.0, 10.0], [2.0, 14.0], [50.0, 50.0], [50.0, 50.0]])
    assert variance_within(rows, np.array([0, 0, 1, 1])) == pytest.approx((2.5 + 0) / 2)
    assert variance_within(rows[2:], np.array([0, 1])) > 0
