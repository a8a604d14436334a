"""Convolutions are MiniRocket's: a kernel's response by hand, and the same features as aeon's own transform."""

from pathlib import Path

import numpy as np

from som_classifier.convolutions import (
    COORDINATES,
    COUNTED,
    DILATIONS,
    FILTERS,
    INSTANTS,
    KERNELS,
    Convolutions,
    resampled,
)


def series(seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(COORDINATES, INSTANTS)).cumsum(axis=1).astype(np.float32)


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


def test_a_feature_is_the_share_of_instants_above_a_bias() -> None:
    coordinates = np.random.default_rng(1).integers(2, size=(FILTERS, COORDINATES)).astype(np.float32)
    convolutions = Convolutions(coordinates, np.tile(np.float32([-1e9, 0.0, 1e9]), (FILTERS, 1)))
    features = convolutions.features(series()).reshape(FILTERS, 3)
    above = (convolutions.responses(series()) > 0) & COUNTED
    assert (features[:, 0] == 1).all() and (features[:, 2] == 0).all()
    np.testing.assert_allclose(features[:, 1], above.sum(axis=1) / COUNTED.sum(axis=1), rtol=1e-6)


def test_resampling_keeps_lines_and_both_ends() -> None:
    line = np.linspace(1.0, 2.0, 7)[:, None, None] * np.arange(45.0).reshape(15, 3)
    np.testing.assert_allclose(resampled(line), np.linspace(1.0, 2.0, INSTANTS) * np.arange(45.0)[:, None], rtol=1e-6)
    assert resampled(line[:1]).tolist() == np.repeat(np.arange(45.0)[:, None], INSTANTS, axis=1).tolist()


def test_missing_joints_are_interpolated_and_one_that_is_never_there_is_0() -> None:
    line = np.linspace(1.0, 2.0, 8)[:, None, None] * np.ones((15, 3))
    gappy = line.copy()
    gappy[2:5, 4], gappy[:, 9] = np.nan, np.nan
    found = resampled(gappy).reshape(15, 3, INSTANTS)
    assert not found[9].any()
    np.testing.assert_allclose(np.delete(found, 9, axis=0), np.delete(resampled(line).reshape(found.shape), 9, axis=0))


def test_the_features_are_those_of_another_implementation() -> None:
    """Given its channels and biases. Summed in another order, a response may lie on the other side of a bias.

    The file holds what aeon's MiniRocket drew for its series with n_kernels=2520 and random_state=0, and its features.
    """
    other = np.load(Path(__file__).with_name("minirocket.npz"))
    assert other["dilations"].tolist() == list(DILATIONS)
    coordinates = np.zeros((FILTERS, COORDINATES), np.float32)
    drawn = np.split(other["channels"], np.cumsum(other["channel_counts"])[:-1])
    for of_filter, channels in zip(coordinates, drawn, strict=True):
        of_filter[channels] = 1
    often = np.repeat(other["biases_per_dilation"], len(KERNELS))[:, None]
    biases = np.full((FILTERS, often.max()), np.nan, np.float32)
    biases[np.arange(often.max()) < often] = other["biases"]
    own = Convolutions(coordinates, biases)
    found = np.stack([own.features(each) for each in other["series"]])[:, ~np.isnan(biases).ravel()]
    assert (np.abs(found - other["features"]) < 1e-5).mean() > 0.999
    np.testing.assert_allclose(found, other["features"], atol=0.13)
