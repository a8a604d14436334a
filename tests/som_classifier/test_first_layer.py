"""Maps that answer with a soft activity: shares of one, the same for a frame alone as among others."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.skeletons import INDEX
from actum.som import Som
from people import STANDING
from som_classifier.first_layer import MAP_INPUTS, SMALLEST_ERROR2, VELOCITY_WEIGHT, FirstMaps, frame_inputs
from som_classifier.handedness import mirrored

SHARES = 0.4, 0.1
ARMS = MAP_INPUTS["arms"]
POSTURE = STANDING - STANDING[2]


def map_of(rows: int, cols: int, dim: int, seed: int = 0) -> Som:
    return Som(rows, cols, np.random.default_rng(seed).normal(0, 0.5, (rows * cols, dim)).astype(np.float32))


def first_maps(posture_contrast: float = 3.0, velocity_contrast: float = 2.0) -> FirstMaps:
    contrasts = {"postures": posture_contrast, "velocities": velocity_contrast, "arms": 1.0}
    maps = {name: map_of(5, 4, each.size, seed) for seed, (name, each) in enumerate(MAP_INPUTS.items())}
    return FirstMaps(maps, contrasts, SHARES)


def inputs(frames: int = 30, missing: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    gaps = np.where(rng.random((frames, 15, 1)) < missing, np.nan, 0.0)
    gaps[:, 2] = 0
    return POSTURE + rng.normal(0, 0.3, (frames, 15, 3)) + gaps, rng.normal(0, 0.1, (frames, 15, 3)) + gaps


@pytest.mark.parametrize("missing", [0.0, 0.3])
def test_a_frame_alone_answers_as_among_others_on_either_side(missing: float) -> None:
    maps, (postures, velocities) = first_maps(), inputs(missing=missing)
    alone = np.array([maps.frame_activities(*frame) for frame in zip(postures, velocities, strict=True)])
    np.testing.assert_allclose(alone[:, 0], maps.activities(postures, velocities), atol=1e-6)
    np.testing.assert_allclose(alone[:, 1], maps.activities(mirrored(postures), mirrored(velocities)), atol=1e-6)


@pytest.mark.parametrize("missing", [0.0, 0.3, 1.0])
def test_each_maps_activity_adds_up_to_its_share(missing: float) -> None:
    maps = first_maps()
    activities = maps.activities(*inputs(missing=missing))
    assert activities.shape == (30, maps.units) == (30, 80)
    assert activities.min() >= 0
    np.testing.assert_allclose(activities.reshape(30, 4, 20).sum(axis=2), [[1.0, 1.0, *SHARES]] * 30, atol=1e-6)


def test_the_log_error_by_hand() -> None:
    """Of the winner's squared distance, scaled up for what is missing, whatever the contrast."""
    maps, (postures, _) = first_maps(posture_contrast=3.0), inputs(missing=0.3)
    winners = maps.postures.bmus(postures.reshape(-1, 45))
    for posture, error in zip(postures, maps.log_errors(postures, winners), strict=True):
        off = posture.ravel() - maps.postures.weights
        mean2 = np.nanmean(np.square(off), axis=1).min()
        assert error == pytest.approx(np.log(45 * mean2), rel=1e-5)


def test_a_log_error_has_a_bottom_and_is_none_of_nothing() -> None:
    maps = first_maps()
    postures = np.stack([maps.postures.weights[3].reshape(15, 3), np.full((15, 3), np.nan)])
    np.testing.assert_allclose(maps.log_errors(postures, [3, 0]), [np.log(SMALLEST_ERROR2)] * 2)


def test_activity_by_hand() -> None:
    """y is share × exp(−(d² − d²_min) / contrast) over its sum, each map with its own contrast.

    The left arm is asked of the map of arms as the right one of the mirror image.
    """
    maps, (postures, velocities) = first_maps(), inputs(1)
    right, left = (
        ARMS.of(frame_inputs(*both)) for both in ((postures, velocities), (mirrored(postures), mirrored(velocities)))
    )
    expected = []
    for som, x, contrast, share in (
        (maps.postures, postures, 3.0, 1.0),
        (maps.maps["velocities"], velocities, 2.0, 1.0),
        (maps.maps["arms"], right, 1.0, SHARES[0]),
        (maps.maps["arms"], left, 1.0, SHARES[1]),
    ):
        y = np.exp(-np.square(som.weights - x.reshape(-1)).sum(axis=1) / contrast)
        expected.append(share * y / y.sum())
    as_seen, _ = maps.frame_activities(postures[0], velocities[0])
    np.testing.assert_allclose(as_seen, np.concatenate(expected), rtol=1e-4)


def test_the_smaller_the_contrast_the_more_the_winner_takes() -> None:
    postures, velocities = inputs(1)
    winners_share = [first_maps(contrast).activities(postures, velocities)[0, :20].max() for contrast in (0.01, 1, 100)]
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
    maps = replace(first_maps(), maps={**first_maps().maps, "postures": Som(5, 4, weights)})
    postures[0, joint] = np.nan
    activity = maps.activities(postures, velocities)[0]
    assert activity[0] == pytest.approx(activity[1], rel=1e-5)


def test_the_arm_is_seen_from_its_shoulder() -> None:
    """Where the body stands and how it moves on the whole says nothing about the arm."""
    postures, velocities = inputs(3)
    arms = ARMS.of(frame_inputs(postures, velocities))
    shoulder, elbow, hand = (INDEX[f"right_{name}"] for name in ("shoulder", "elbow", "hand"))
    expected = [
        speed * (vectors[:, joint] - vectors[:, shoulder])
        for vectors, speed in ((postures, 1.0), (velocities, VELOCITY_WEIGHT))
        for joint in (elbow, hand)
    ]
    np.testing.assert_allclose(arms, np.concatenate(expected, axis=1))
    elsewhere = frame_inputs(postures + np.array([1.0, 2.0, 3.0]), velocities - np.array([0.3, 0.2, 0.1]))
    np.testing.assert_allclose(ARMS.of(elsewhere), arms)


def test_where_one_arm_is_hidden_its_map_says_nothing_of_it() -> None:
    postures, velocities = inputs(1)
    postures[:, INDEX["right_shoulder"]] = velocities[:, INDEX["right_shoulder"]] = np.nan
    sides = first_maps().frame_activities(postures[0], velocities[0])
    hidden, seen, of_the_mirror, hidden_in_it = sides[:, 40:].reshape(4, 20)
    np.testing.assert_allclose(hidden, SHARES[0] / 20, rtol=1e-6)
    np.testing.assert_allclose(hidden_in_it, SHARES[1] / 20, rtol=1e-6)
    np.testing.assert_allclose(seen / SHARES[1], of_the_mirror / SHARES[0], rtol=1e-5)
    assert np.ptp(seen) > 0
