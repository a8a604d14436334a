"""An object's track: little lag, a velocity, one outlier ignored, carried on for a moment while covered."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from actum.geometry import angle_between_rad
from actum.messages import TrackedObject
from actum.node import SECOND_NS
from marker_tracker.pose.pose_tracks import PREDICTED_S, Tracks, interpolated_rotation
from marker_tracker.pose.poses import Measurement, Pose

RATE_HZ = 30
NOISE_M = np.array([0.001, 0.001, 0.006])
MEMORY_NS = 2 * SECOND_NS


def pose(position_m: Any, turn: Any = (0.0, 0.0, 0.0), error_px: float = 0.1) -> Pose:
    transform = np.eye(4)
    transform[:3, :3] = cv2.Rodrigues(np.array(turn, dtype=float))[0]
    transform[:3, 3] = position_m
    return Pose(transform, error_px)


def measured(*poses: Pose) -> Measurement:
    return Measurement(1, "cup", poses, np.diag(NOISE_M**2), 0.9)


def followed(path: Callable[[float], Any], frames: int, noise: float = 0.0) -> list[TrackedObject]:
    """The track of an object seen on a path, in every frame."""
    tracks, chance = Tracks(MEMORY_NS), np.random.default_rng(0)
    listed = []
    for i in range(frames):
        position_m = np.asarray(path(i / RATE_HZ)) + noise * NOISE_M * chance.normal(size=3)
        tracks.update(stamp(i), [measured(pose(position_m))])
        listed += tracks.listed(stamp(i))
    return listed


def stamp(frame: float) -> int:
    return round(SECOND_NS * (1 + frame / RATE_HZ))


def smooth(t: float) -> float:
    """From 0 to 1 within a second, at rest at both ends."""
    u = min(max(t, 0.0), 1.0)
    return u * u * (3 - 2 * u)


def lift(t: float) -> list[float]:
    return [0.0, -0.3 * smooth(t - 0.5), 1.5]


def test_a_lifted_object_is_shown_less_than_a_frame_late() -> None:
    heights = np.array([found.position_m[1] for found in followed(lift, 60)])
    times = np.arange(60) / RATE_HZ
    lags = [np.abs(heights - [lift(t - late)[1] for t in times]).sum() for late in np.arange(0, 0.1, 0.001)]
    assert np.argmin(lags) * 0.001 < 0.5 / RATE_HZ


def test_its_velocity_is_that_of_the_path() -> None:
    seen = followed(lambda t: [0.4 * t, 0.0, 1.5 - 0.2 * t], 40, noise=1.0)
    assert seen[0].velocity_mps is None
    assert np.allclose(seen[-1].velocity_mps, [0.4, 0.0, -0.2], atol=0.15)


def test_a_still_object_is_shown_steadier_than_it_is_measured() -> None:
    depths = np.array([found.position_m[2] for found in followed(lambda t: [0.0, 0.0, 1.5], 200, noise=1.0)])
    assert depths[20:].std() < 0.9 * NOISE_M[2]
    assert abs(depths[20:].mean() - 1.5) < 0.002


def test_a_moving_object_is_carried_on_for_a_moment_and_then_stays_listed_where_it_ended() -> None:
    tracks = Tracks(MEMORY_NS)
    for i in range(15):
        tracks.update(stamp(i), [measured(pose([0.5 * i / RATE_HZ, 0.0, 1.5]))])
    last_m = 0.5 * 14 / RATE_HZ
    frames = range(15, 15 + 40)
    hidden = [tracks.listed(stamp(i))[0] for i in frames]
    predicted = [found.predicted for found in hidden]
    x = np.array([found.position_m[0] for found in hidden])
    assert not any(found.seen for found in hidden)
    assert sum(predicted) == pytest.approx(PREDICTED_S * RATE_HZ, abs=1)
    assert predicted == sorted(predicted, reverse=True)
    assert last_m < x[0] < last_m + 0.02
    assert (np.diff(x) >= -1e-9).all()
    assert x[-1] < last_m + 0.1
    assert hidden[-1].velocity_mps is None
    assert (np.diff([found.confidence for found in hidden]) < 0).all()


def test_a_still_object_does_not_drift_while_covered() -> None:
    tracks, chance = Tracks(MEMORY_NS), np.random.default_rng(1)
    for i in range(30):
        tracks.update(stamp(i), [measured(pose([0.0, 0.0, 1.5] + NOISE_M * chance.normal(size=3)))])
    (seen,), (covered,) = tracks.listed(stamp(29)), tracks.listed(stamp(34))
    assert covered.position_m == seen.position_m


@pytest.mark.parametrize(("second_m", "believed_m"), [((0.6, 0.0), 0.6), ((-0.6, 0.3), 0.0)])
def test_one_measurement_far_off_is_not_believed_but_two_are_unless_they_contradict_each_other(
    second_m: tuple[float, float], believed_m: float
) -> None:
    tracks = Tracks(MEMORY_NS)
    for i in range(10):
        tracks.update(stamp(i), [measured(pose([0.0, 0.0, 1.5]))])
    assert tracks.update(stamp(10), [outlier := measured(pose([0.6, 0.0, 1.5]))]) == [outlier]
    (doubted,) = tracks.listed(stamp(10))
    assert (doubted.seen, doubted.position_m[0]) == (False, pytest.approx(0.0, abs=0.001))
    agrees = believed_m == second_m[0]
    assert tracks.update(stamp(11), [second := measured(pose([*second_m, 1.5]))]) == ([] if agrees else [second])
    assert tracks.update(stamp(12), [measured(pose([believed_m, 0.0, 1.5]))]) == []
    assert tracks.listed(stamp(12))[0].position_m[0] == pytest.approx(believed_m, abs=0.001)


def test_a_measurement_far_off_is_held_back_sooner_of_a_hidden_object_than_of_a_seen_one() -> None:
    """Its occluder may be followed in the wrong place: beyond 4 standard deviations it stays where it was."""
    for hidden in (False, True):
        tracks = Tracks(MEMORY_NS)
        for i in range(30):
            tracks.update(stamp(i), [measured(pose([0.0, 0.0, 1.5]))])
        away = replace(measured(pose([0.026, 0.0, 1.5])), hidden=hidden)
        assert bool(tracks.update(stamp(30), [away])) is hidden


def test_an_object_rejoins_at_once_wherever_it_comes_back() -> None:
    tracks = Tracks(MEMORY_NS)
    tracks.update(stamp(0), [measured(pose([0.0, 0.0, 1.5]))])
    assert tracks.update(stamp(30), [measured(pose([0.5, -0.3, 1.2]))]) == []
    assert tracks.listed(stamp(30))[0].position_m == [0.5, -0.3, 1.2]


@settings(max_examples=50)
@given(st.tuples(*[st.floats(-2, 2)] * 3), st.tuples(*[st.floats(-2, 2)] * 3))
def test_tracks_are_the_same_wherever_the_frame_has_its_origin(start, shift) -> None:
    def path(t: float) -> Any:
        return np.add(start, [0.3 * t, -0.2 * smooth(t), 0.1 * t])

    moved = followed(lambda t: path(t) + np.array(shift), 12)
    for here, there in zip(followed(path, 12), moved, strict=True):
        assert np.allclose(np.add(here.position_m, shift), there.position_m, atol=1e-9)
        assert here.velocity_mps is None or np.allclose(here.velocity_mps, there.velocity_mps, atol=1e-6)


@given(st.tuples(*[st.floats(-1, 1)] * 3), st.tuples(*[st.floats(-1, 1)] * 3), st.floats(0, 1))
def test_a_rotation_interpolated_part_of_the_way_leaves_the_rest(one, other, part) -> None:
    start, end = (cv2.Rodrigues(np.array(each))[0] for each in (one, other))
    angle = angle_between_rad(start, end)
    assert angle_between_rad(interpolated_rotation(start, end, part), end) == pytest.approx(
        (1 - part) * angle, abs=1e-5
    )
