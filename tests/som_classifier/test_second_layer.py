"""The map of actions: soft activity of unit length, less what all actions share."""

import numpy as np

from actum.som import Som
from som_classifier.second_layer import ActionMap

SOM = Som(4, 3, np.random.default_rng(0).normal(0, 0.5, (12, 5)).astype(np.float32))


def action_map(mean: np.ndarray | None = None) -> ActionMap:
    return ActionMap(SOM, 2.0, np.zeros(12, np.float32) if mean is None else mean)


def test_the_activity_is_of_unit_length_before_the_mean_is_subtracted() -> None:
    scores = np.random.default_rng(0).random(5).astype(np.float32)
    y = np.exp(-np.square(SOM.weights - scores).sum(axis=1) / 2.0)
    unit = y / np.linalg.norm(y)
    np.testing.assert_allclose(action_map().activity(scores), unit, rtol=1e-4)
    mean = np.linspace(0, 1, 12).astype(np.float32)
    np.testing.assert_allclose(action_map(mean).activity(scores), unit - mean, atol=1e-5)


def test_with_the_mean_of_training_what_all_actions_share_is_gone() -> None:
    activities = np.random.default_rng(0).random((40, 12))
    unit = activities / np.linalg.norm(activities, axis=1, keepdims=True)
    centred = action_map(unit.mean(axis=0).astype(np.float32)).centred(activities)
    np.testing.assert_allclose(centred.mean(axis=0), 0, atol=1e-6)
    for row, among in zip(activities, centred, strict=True):
        np.testing.assert_allclose(action_map(unit.mean(axis=0).astype(np.float32)).centred(row), among, atol=1e-12)
