import numpy as np
import pytest

from scene_simulator.noise import CorrelatedNoise, SkeletonNoise, Sway
from scene_simulator.parameters import load_parameters
from scene_simulator.random_streams import random_stream
from scene_simulator.trajectories import bent_path, bump, minimum_jerk, set_down_displacement

SHARE = np.linspace(0, 1, 2001)
RATE_HZ = 30


def test_minimum_jerk_starts_and_ends_at_rest_and_is_fastest_in_the_middle() -> None:
    progress = minimum_jerk(SHARE)
    speed = np.gradient(progress, SHARE)

    assert (progress[0], progress[1000], progress[-1]) == pytest.approx((0, 0.5, 1))
    assert (speed[0], speed[-1]) == pytest.approx((0, 0), abs=1e-5)
    assert speed.max() == pytest.approx(1.875, abs=1e-4)
    assert speed.argmax() == 1000


def test_a_reach_ends_where_it_should_whatever_its_bend() -> None:
    start, end, bulge = np.array([0.0, 0, 2]), np.array([0.3, -0.1, 1.7]), np.array([0.02, -0.1, 0])
    path = bent_path(start, end, bulge, SHARE)

    np.testing.assert_allclose(path[[0, -1]], [start, end])
    np.testing.assert_allclose(path[1000], (start + end) / 2 + bulge)
    assert bump(SHARE).max() == pytest.approx(1)


def test_an_object_is_moved_off_its_support_before_it_sinks_through_it() -> None:
    moved = set_down_displacement(np.array([0.1, 0.15, 0.0]), SHARE)

    np.testing.assert_allclose(moved[-1], [0.1, 0.15, 0.0])
    assert (np.interp(0.4, SHARE, moved[:, 0] / 0.1)) > 5 * np.interp(0.4, SHARE, moved[:, 1] / 0.15)


def test_noise_has_its_standard_deviation_and_its_memory() -> None:
    noise = CorrelatedNoise(random_stream("test"), np.full(200, 0.02), time_constant_s=0.15, frame_rate_hz=RATE_HZ)
    values = np.array([noise.step() for _ in range(1500)])

    assert values.std() == pytest.approx(0.02, rel=0.02)
    for lag in (1, 5):
        correlation = (values[lag:] * values[:-lag]).mean() / values.var()
        assert correlation == pytest.approx(np.exp(-lag / RATE_HZ / 0.15), abs=0.02)


def test_a_hand_is_now_and_then_seen_far_off_and_said_to_be_unsure() -> None:
    parameters = load_parameters().noise
    noise = SkeletonNoise(random_stream("test"), parameters, 1.0, RATE_HZ)
    measured, confidence = zip(*(noise.measure(np.zeros((15, 3))) for _ in range(6000)), strict=True)
    hand, unsure = np.array(measured)[:, 8], np.array(confidence)[:, 8] < 1

    assert unsure.mean() == pytest.approx(parameters.excursions_per_s * parameters.excursion_s, rel=0.5)
    assert hand[unsure].std() > 1.3 * hand[~unsure].std()
    assert np.all(np.array(confidence)[:, 0] == 1)


def test_sway_is_slow_and_small() -> None:
    parameters = load_parameters().sway
    time = np.arange(0, 600, 1 / RATE_HZ)
    sway = Sway(random_stream("test"), parameters).at(time)

    assert sway[:, 0].std() == pytest.approx(parameters.pelvis_sd_m, rel=0.1)
    speed = np.abs(np.diff(sway[:, 0])) * RATE_HZ
    assert speed.max() < 2 * np.pi * parameters.frequency_range_hz[1] * 4 * parameters.pelvis_sd_m
