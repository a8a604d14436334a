"""The map of actions and its neurons learn scores, and are as sure as scores of people left out let them be."""

import numpy as np
import pytest

from model_trainer.discriminants import Axes
from model_trainer.progress import silent
from model_trainer.upper_layers import Scored, UpperLayers, held_out_gains, train_upper, variance_within
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


def gain(*stages: Scored) -> list[float]:
    return held_out_gains(stages, ACTIONS, TINY, rng(), silent)


def test_unseen_scores_are_answered() -> None:
    unseen = upper(scored(0.1, 0.2)).cosines(scores(0.2, seed=7))
    assert (unseen.argmax(axis=1) == TARGETS).mean() > 0.95


def test_cosines_are_those_of_each_row_alone() -> None:
    layers, rows = upper(scored(0.1, 0.2)), scores(0.2, seed=7)[:6].astype(np.float32)
    alone = [layers.layer3.cosines(layers.concepts.activity(row)) for row in rows]
    np.testing.assert_array_equal(layers.cosines(rows), np.stack(alone))


def test_what_the_map_learns_is_partly_the_one_partly_the_other() -> None:
    """Half and half: the mean of the map's inputs is what its linear beginning stands about."""
    one, other = scored(0.1, 0.3), scored(0.3, 0.1)
    swapped = Axes(NOBODY, NOBODY, one.axes.held_out, one.axes.own)
    mirrored = Scored(swapped, one.owners, one.targets, one.folds)
    assert TINY.held_out_share == 0.5
    np.testing.assert_array_equal(upper(one).concepts.layout.weights, upper(mirrored).concepts.layout.weights)
    assert (upper(one).concepts.layout.weights != upper(other).concepts.layout.weights).any()


def test_gains_are_fitted_on_the_scores_of_people_left_out() -> None:
    """However well their own axes know them."""
    (sure,), (unsure,) = gain(scored(0.05, 0.05)), gain(scored(0.05, 2.0))
    assert sure > 3 * unsure


def test_each_stage_has_its_own_gain() -> None:
    early, late = gain(scored(0.05, 2.0), scored(0.05, 0.2))
    assert early < 0.5 * late


def test_variance_within_by_hand() -> None:
    """Of the first action 1 and 4, of the second 0 and 0: what lies between actions does not count."""
    rows = np.array([[0.0, 10.0], [2.0, 14.0], [50.0, 50.0], [50.0, 50.0]])
    assert variance_within(rows, np.array([0, 0, 1, 1])) == pytest.approx((2.5 + 0) / 2)
    assert variance_within(rows[2:], np.array([0, 1])) > 0
