"""The action map and the neurons learn scores, training and cross-validated ones."""

from dataclasses import replace

import numpy as np
import pytest

from actum_model_trainer.discriminants import Discriminants, FittedStage
from actum_model_trainer.progress import silent
from actum_model_trainer.upper_layers import UpperLayers, mixup, train_upper, within_class_variance
from performers import TINY

ACTIONS, PEOPLE, EACH = 3, 4, 5
TARGETS = np.tile(np.repeat(np.arange(ACTIONS), EACH), PEOPLE)
NOBODY = np.zeros((0, ACTIONS), np.float32)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def scores(noise: float, seed: int = 0) -> np.ndarray:
    """About 1 for the action done and 0 for the others."""
    return np.asarray(np.eye(ACTIONS)[TARGETS] + rng(seed).normal(0, noise, (len(TARGETS), ACTIONS)))


def scored(own_noise: float, cross_validated_noise: float) -> FittedStage:
    own, held_out = scores(own_noise), scores(cross_validated_noise, 1)
    return FittedStage(Discriminants(NOBODY, NOBODY, own, held_out, own, NOBODY), np.arange(len(TARGETS)), TARGETS)


def upper(stage: FittedStage) -> UpperLayers:
    return train_upper(stage, ACTIONS, TINY, rng(), silent)


def test_unseen_scores_are_answered() -> None:
    unseen = upper(scored(0.1, 0.2)).cosines(scores(0.2, seed=7))
    assert (unseen.argmax(axis=1) == TARGETS).mean() > 0.95


def test_cosines_are_those_of_each_row_alone() -> None:
    layers, rows = upper(scored(0.1, 0.2)), scores(0.2, seed=7)[:6].astype(np.float32)
    alone = [layers.layer3.cosines(layers.action_map.activity(row)) for row in rows]
    np.testing.assert_allclose(layers.cosines(rows), np.stack(alone), atol=1e-5)


def test_the_map_learns_training_and_cross_validated_scores_alike() -> None:
    """Half and half: the mean of the map's inputs is what its linear beginning stands about."""
    one, other = scored(0.1, 0.3), scored(0.3, 0.1)
    own, held_out = one.discriminants.training_scores, one.discriminants.cross_validated_scores
    swapped = replace(one.discriminants, training_scores=held_out, cross_validated_scores=own)
    mirrored = FittedStage(swapped, one.sample_indices, one.targets)
    assert TINY.held_out_share == 0.5
    np.testing.assert_array_equal(upper(one).action_map.som.weights, upper(mirrored).action_map.som.weights)
    assert (upper(one).action_map.som.weights != upper(other).action_map.som.weights).any()


def test_one_example_of_each_action_is_enough() -> None:
    """Its scores are almost perfect, those of strangers not half as large: there the map of actions must be at home."""
    targets = np.arange(10)
    perfect = 0.98 * np.eye(10)
    layers = train_upper(
        FittedStage(Discriminants(NOBODY, NOBODY, perfect, perfect, perfect, NOBODY), targets, targets),
        10,
        TINY,
        rng(),
        silent,
    )
    asked = rng().integers(10, size=200)
    strangers = 0.35 * np.eye(10)[asked] + rng(1).normal(0.06, 0.04, (200, 10))
    told = layers.cosines(strangers).argmax(axis=1)
    assert (told == strangers.argmax(axis=1)).mean() > 0.95


def test_mixup_fills_up_few_scores() -> None:
    rows, targets = mixup(np.eye(3), np.arange(3), 500, 0.55, rng())
    np.testing.assert_array_equal(rows[:3], np.eye(3))
    np.testing.assert_array_equal(targets[:3], np.arange(3))
    assert rows.shape == (500, 3)
    np.testing.assert_array_equal(rows.argmax(axis=1), targets)
    np.testing.assert_allclose(rows.sum(axis=1), 1.0)
    assert 0.55 <= rows.max(axis=1).min() < 0.6


def test_enough_scores_stay_as_they_are() -> None:
    rows, targets = mixup(scores(0.1), TARGETS, len(TARGETS), 0.55, rng())
    np.testing.assert_array_equal(rows, scores(0.1))
    np.testing.assert_array_equal(targets, TARGETS)


def test_within_class_variance_by_hand() -> None:
    """Of the first action 1 and 4, of the second 0 and 0: what lies between actions does not count."""
    rows = np.array([[0.0, 10.0], [2.0, 14.0], [50.0, 50.0], [50.0, 50.0]])
    assert within_class_variance(rows, np.array([0, 0, 1, 1])) == pytest.approx((2.5 + 0) / 2)
    assert within_class_variance(rows[2:], np.array([0, 1])) > 0
