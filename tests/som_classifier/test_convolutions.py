"""Convolutions are MiniRocket's: a kernel's response by hand, and the same features as aeon's own transform."""

from pathlib import Path

import numpy as np

from actum.node import SECOND_NS
from actum.skeletons import INDEX
from som_classifier.convolutions import (
    COORDINATES,
    COUNTED,
    DILATIONS,
    FILTERS,
    INSTANTS,
    KERNELS,
    PLAIN_FILTERS,
    Convolutions,
    resampled,
)


def series(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(COORDINATES, INSTANTS)).cumsum(axis=1).astype(np.float32)


def evenly(count: int) -> np.ndarray:
    """So many stamps, a 30th of a second apart."""
    return np.arange(count) * (SECOND_NS // 30)


def looking_at(coordinate: int) -> Convolutions:
    coordinates = np.zeros((FILTERS, COORDINATES), np.float32)
    coordinates[:, coordinate] = 1
    return Convolutions(coordinates, np.zeros((FILTERS, 1), np.float32))


def test_a_response_by_hand() -> None:
    """The first kernel has its twos first; at dilation 1 an impulse shows it reversed, -1 everywhere else within 4."""
    impulse = np.zeros((COORDINATES, INSTANTS), np.float32)
    impulse[3, 10] = 1
    response = looking_at(3).responses(impulse)[0]
    assert response[6:15].tolist() == KERNELS[0][::-1].tolist() == [-1.0] * 6 + [2.0] * 3
    assert not response[:6].any() and not response[15:].any()


def test_each_dilation_spreads_the_kernel() -> None:
    impulse = np.zeros((COORDINATES, INSTANTS), np.float32)
    impulse[0, 16] = 1
    for dilation in (1, 2, 3):
        response = looking_at(0).responses(impulse)[(dilation - 1) * len(KERNELS)]
        assert np.flatnonzero(response).tolist() == list(range(16 - 4 * dilation, 17 + 4 * dilation, dilation))


def test_the_second_half_of_the_filters_sees_how_the_coordinates_change() -> None:
    step = np.zeros((COORDINATES, INSTANTS), np.float32)
    step[3, 10:] = 1
    impulse = np.diff(step, prepend=np.float32(0))
    np.testing.assert_array_equal(
        looking_at(3).responses(step)[PLAIN_FILTERS:], looking_at(3).responses(impulse)[:PLAIN_FILTERS]
    )


def test_a_feature_is_the_share_of_instants_above_a_bias() -> None:
    coordinates = np.random.default_rng(1).integers(2, size=(FILTERS, COORDINATES)).astype(np.float32)
    convolutions = Convolutions(coordinates, np.tile(np.float32([-1e9, 0.0, 1e9]), (FILTERS, 1)))
    features = convolutions.features(series()).reshape(FILTERS, 3)
    above = (convolutions.responses(series()) > 0) & COUNTED
    assert (features[:, 0] == 1).all() and (features[:, 2] == 0).all()
    np.testing.assert_allclose(features[:, 1], above.sum(axis=1) / COUNTED.sum(axis=1), rtol=1e-6)


def test_resampling_keeps_lines_and_both_ends() -> None:
    line = np.linspace(1.0, 2.0, 7)[:, None, None] * np.arange(45.0).reshape(15, 3)
    expected = np.linspace(1.0, 2.0, INSTANTS) * np.arange(45.0)[:, None]
    np.testing.assert_allclose(resampled(evenly(7), line)[:45], expected, rtol=1e-6)
    assert (
        resampled(evenly(1), line[:1])[:45].tolist() == np.repeat(np.arange(45.0)[:, None], INSTANTS, axis=1).tolist()
    )


def test_frames_that_were_lost_change_nothing_of_a_line() -> None:
    line, kept = np.linspace(1.0, 2.0, 20)[:, None, None] * np.ones((15, 3)), np.r_[0:4, 11:20]
    np.testing.assert_allclose(resampled(evenly(20)[kept], line[kept]), resampled(evenly(20), line), atol=1e-6)


def test_beside_the_joints_lie_vectors_between_joints_and_their_lengths() -> None:
    postures = np.random.default_rng(0).normal(size=(INSTANTS, 15, 3))
    joints, others = np.split(resampled(evenly(INSTANTS), postures), [45])
    between, lengths = np.split(others, [len(others) // 4 * 3])
    from_head = (joints.reshape(15, 3, -1)[INDEX["left_hand"]] - joints.reshape(15, 3, -1)[INDEX["head"]]).tolist()
    assert between[:3].tolist() == from_head
    np.testing.assert_allclose(lengths, np.linalg.norm(between.reshape(-1, 3, INSTANTS), axis=1), rtol=1e-5)


def test_missing_joints_are_interpolated_and_one_that_is_never_there_is_0() -> None:
    line = np.linspace(1.0, 2.0, 8)[:, None, None] * np.ones((15, 3))
    gappy = line.copy()
    gappy[2:5, 4], gappy[:, 9] = np.nan, np.nan
    found, whole = (resampled(evenly(8), each)[:45].reshape(15, 3, INSTANTS) for each in (gappy, line))
    assert not found[9].any()
    np.testing.assert_allclose(np.delete(found, 9, axis=0), np.delete(whole, 9, axis=0))


def test_the_features_are_those_of_another_implementation() -> None:
    """Given its channels and biases. Summed in another order, a response may lie on the other side of a bias.

    The file holds what aeon's MiniRocket drew for its series with n_kernels=2520 and random_state=0, and its features.
    """
    other = np.load(Path(__file__).with_name("minirocket.npz"))
    assert other["dilations"].tolist() == list(DILATIONS)
    coordinates = np.zeros((FILTERS, COORDINATES), np.float32)
    drawn = np.split(other["channels"], np.cumsum(other["channel_counts"])[:-1])
    for of_filter, channels in zip(coordinates, drawn, strict=False):  # aeon has none of differences
        of_filter[channels] = 1
    often = np.repeat(other["biases_per_dilation"], len(KERNELS))[:, None]
    biases = np.full((FILTERS, often.max()), np.nan, np.float32)
    biases[:PLAIN_FILTERS][np.arange(often.max()) < often] = other["biases"]
    own, beside = Convolutions(coordinates, biases), np.zeros((COORDINATES - 45, INSTANTS), np.float32)
    series_of_all = [np.concatenate([joints, beside]) for joints in other["series"]]
    found = np.stack([own.features(each) for each in series_of_all])[:, ~np.isnan(biases).ravel()]
    assert (np.abs(found - other["features"]) < 1e-5).mean() > 0.999
    np.testing.assert_allclose(found, other["features"], atol=0.13)
