"""Maps that answer with a soft activity: shares of one, the same for a frame alone as among others."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.som import Som
from people import STANDING
from som_classifier.layers import Concepts, FirstMaps, shares

POSTURE = STANDING - STANDING[2]


def map_of(rows: int, cols: int, dim: int, seed: int = 0) -> Som:
    return Som(rows, cols, np.random.default_rng(seed).normal(0, 0.5, (rows * cols, dim)).astype(np.float32))


def first_maps(posture_contrast: float = 3.0, velocity_contrast: float = 2.0) -> FirstMaps:
    return FirstMaps(map_of(5, 4, 45), map_of(3, 4, 45, 1), (posture_contrast, velocity_contrast))


def inputs(frames: int = 30, missing: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    gaps = np.where(rng.random((frames, 15, 1)) < missing, np.nan, 0.0)
    gaps[:, 2] = 0
    return POSTURE + rng.normal(0, 0.3, (frames, 15, 3)) + gaps, rng.normal(0, 0.1, (frames, 15, 3)) + gaps


@pytest.mark.parametrize("missing", [0.0, 0.3])
def test_a_frame_alone_answers_as_among_others(missing: float) -> None:
    maps, (postures, velocities) = first_maps(), inputs(missing=missing)
    alone = np.array([maps.activity(*frame) for frame in zip(postures, velocities, strict=True)])
    np.testing.assert_allclose(alone, maps.activities(postures, velocities), atol=1e-6)


@pytest.mark.parametrize("missing", [0.0, 0.3])
def test_each_maps_activity_is_shares_of_one(missing: float) -> None:
    maps = first_maps()
    activities = maps.activities(*inputs(missing=missing))
    assert activities.shape == (30, maps.units) == (30, 20 + 12)
    assert activities.min() >= 0
    for units in (slice(0, 20), slice(20, 32)):
        np.testing.assert_allclose(activities[:, units].sum(axis=1), 1.0, atol=1e-6)


def test_activity_by_hand() -> None:
    """y is exp(−(d² − d²_min) / contrast) over its sum, each map with its own contrast."""
    maps, (postures, velocities) = first_maps(), inputs(1)
    expected = []
    for som, x, contrast in ((maps.postures, postures, 3.0), (maps.velocities, velocities, 2.0)):
        y = np.exp(-som.distances2(x.reshape(1, -1)[0]) / contrast)
        expected.append(y / y.sum())
    np.testing.assert_allclose(maps.activity(postures[0], velocities[0]), np.concatenate(expected), rtol=1e-4)


def test_the_smaller_the_contrast_the_more_the_winner_takes() -> None:
    postures, velocities = inputs(1)
    winners_share = [
        first_maps(contrast, 1.0).activity(postures[0], velocities[0])[:20].max() for contrast in (0.01, 1.0, 100.0)
    ]
    assert winners_share == sorted(winners_share, reverse=True)
    assert winners_share[0] == pytest.approx(1.0)
    assert winners_share[2] == pytest.approx(1 / 20, rel=0.5)


@settings(deadline=None)
@given(st.integers(0, 14))
def test_what_a_missing_joint_would_have_said_does_not_matter(joint: int) -> None:
    """Units that differ there alone are equals."""
    postures, velocities = inputs(1)
    weights = first_maps().postures.weights.copy()
    weights[1] = weights[0]
    weights[1, 3 * joint : 3 * joint + 3] += 1.0
    maps = FirstMaps(Som(5, 4, weights), first_maps().velocities, (3.0, 2.0))
    postures[0, joint] = np.nan
    activity = maps.activity(postures[0], velocities[0])
    assert activity[0] == pytest.approx(activity[1], rel=1e-5)


def test_shares_divide_by_the_sum_of_each_row() -> None:
    np.testing.assert_allclose(shares(np.array([[1.0, 3.0], [2.0, 2.0]])), [[0.25, 0.75], [0.5, 0.5]])


def concepts(mean: np.ndarray | None = None) -> Concepts:
    return Concepts(map_of(4, 3, 5), 2.0, np.zeros(12, np.float32) if mean is None else mean)


def test_a_concepts_activity_is_of_unit_length_before_its_mean_is_taken_off() -> None:
    scores = np.random.default_rng(0).random(5).astype(np.float32)
    y = np.exp(-concepts().layout.distances2(scores) / 2.0)
    unit = y / np.linalg.norm(y)
    np.testing.assert_allclose(concepts().activity(scores), unit, rtol=1e-4)
    mean = np.linspace(0, 1, 12).astype(np.float32)
    np.testing.assert_allclose(concepts(mean).activity(scores), unit - mean, atol=1e-5)


def test_with_the_mean_of_training_what_all_share_is_gone() -> None:
    activities = np.random.default_rng(0).random((40, 12))
    unit = activities / np.linalg.norm(activities, axis=1, keepdims=True)
    centred = concepts(unit.mean(axis=0).astype(np.float32)).centred(activities)
    np.testing.assert_allclose(centred.mean(axis=0), 0, atol=1e-6)
    for row, among in zip(activities, centred, strict=True):
        np.testing.assert_allclose(concepts(unit.mean(axis=0).astype(np.float32)).centred(row), among, atol=1e-12)
