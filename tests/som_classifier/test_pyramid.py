"""Cells over a segment hold the mean activity within them, whatever was summed before."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from som_classifier.pyramid import MOST_FRAMES, SCALE, PrefixSums, Pyramid, quantised

UNITS = 4
PLAIN = Pyramid((1, 2, 4), 0.0)
OVERLAPPING = Pyramid((1, 2, 4), 0.25)


def trail(activities: np.ndarray, steps_um: np.ndarray | None = None, begun: int = 0, far_um: int = 0) -> PrefixSums:
    """Running sums of activities (n, units), over parts that have moved so far in each frame."""
    steps = np.zeros(len(activities), np.int64) if steps_um is None else steps_um
    running = np.concatenate([np.zeros((1, activities.shape[1]), np.uint32), quantised(activities)])
    sums = np.cumsum(running, axis=0, dtype=np.uint32) + np.uint32(begun)
    return PrefixSums(list(sums), np.array([far_um, *(far_um + np.cumsum(steps))]))


def random_activities(frames: int, seed: int = 0) -> np.ndarray:
    activities = np.random.default_rng(seed).random((frames, UNITS))
    return np.asarray(activities / activities.sum(axis=1, keepdims=True))


def random_steps(frames: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed + 1).integers(0, 50_000, frames)


def means(pyramid: Pyramid, trail: PrefixSums) -> np.ndarray:
    """Each cell's mean activity (cells, units)."""
    return np.asarray(pyramid.vector(trail).astype(np.float64) ** 4).reshape(pyramid.cells, UNITS)


def test_activities_become_whole_numbers() -> None:
    assert quantised(np.array([0.0, 1.0, 0.5])).tolist() == [0, 2**19, 2**18]
    activities = np.random.default_rng(0).random(1000)
    assert np.abs(quantised(activities) / SCALE - activities).max() <= 0.5 / SCALE


@settings(deadline=None)
@given(st.integers(1, 40), st.integers(0, 100), st.sampled_from([PLAIN, OVERLAPPING, Pyramid((3,), 0.5)]))
def test_where_activity_is_constant_every_cell_is_its_fourth_root(frames: int, seed: int, pyramid: Pyramid) -> None:
    activity = np.array([0.0, 0.0625, 0.3125, 0.625])
    vector = pyramid.vector(trail(np.tile(activity, (frames, 1)), random_steps(frames, seed)))
    assert vector.dtype == np.float32
    np.testing.assert_allclose(vector, np.tile(activity**0.25, pyramid.cells), rtol=1e-6)


@pytest.mark.parametrize("frames", [MOST_FRAMES, MOST_FRAMES + 1, 3 * MOST_FRAMES])
@pytest.mark.parametrize("begun", [0, 2**32 - 1])
def test_however_many_frames_there_are_every_cell_is_its_fourth_root(frames: int, begun: int) -> None:
    activity = np.array([0.0, 0.0625, 0.5, 1.0])
    long = trail(np.tile(activity, (frames, 1)), begun=begun)
    np.testing.assert_allclose(OVERLAPPING.vector(long), np.tile(activity**0.25, OVERLAPPING.cells), rtol=1e-6)
    np.testing.assert_array_equal(long.since_start([0, 1, frames]), np.outer([0, 1, frames], activity * SCALE))


def test_a_unit_that_wins_one_frame_in_sixteen_counts_half_of_one_that_always_wins() -> None:
    """Of one in 81 it would be a third: what is rarely seen still counts."""
    activities = np.zeros((16, UNITS))
    activities[:, 0] = activities[5, 1] = 1.0
    np.testing.assert_allclose(Pyramid((1,), 0.0).vector(trail(activities)), [1.0, 0.5, 0.0, 0.0], rtol=1e-6)


@settings(deadline=None)
@given(st.integers(1, 40), st.integers(0, 2**32 - 1), st.integers(0, 2**50))
def test_when_the_summing_began_does_not_matter_to_the_bit(frames: int, begun: int, far_um: int) -> None:
    activities, steps = random_activities(frames), random_steps(frames)
    fresh = OVERLAPPING.vector(trail(activities, steps))
    np.testing.assert_array_equal(OVERLAPPING.vector(trail(activities, steps, begun, far_um)), fresh)


@settings(deadline=None)
@given(st.integers(0, 30), st.integers(1, 30))
def test_a_window_of_a_long_trail_is_the_same_as_alone_to_the_bit(before: int, frames: int) -> None:
    activities, steps = random_activities(before + frames), random_steps(before + frames)
    whole = trail(activities, steps)
    window = whole.between(before, len(whole))
    alone = trail(activities[before:], steps[before:])
    np.testing.assert_array_equal(OVERLAPPING.vector(window), OVERLAPPING.vector(alone))
    begun = whole.between(0, before + 1)
    np.testing.assert_array_equal(
        OVERLAPPING.vector(begun), OVERLAPPING.vector(trail(activities[: before + 1], steps[: before + 1]))
    )


@pytest.mark.parametrize("frames", [3600, 4096, 8191])
def test_a_minute_of_one_unit_alone_is_summed_without_loss(frames: int) -> None:
    """At 60, 68 and 136 frames a second, also where the running sums wrap around."""
    always = np.tile([1.0, 0.0, 0.0, 0.0], (frames, 1))
    np.testing.assert_allclose(PLAIN.vector(trail(always, begun=2**32 - 5)), np.tile([1, 0, 0, 0], 7), rtol=1e-6)


def test_the_first_level_is_the_mean_of_all_and_the_next_of_each_half() -> None:
    activities = random_activities(12)
    pooled = means(PLAIN, trail(activities))
    for cell, frames in enumerate((slice(0, 12), slice(0, 6), slice(6, 12), slice(0, 3), slice(3, 6), slice(6, 9))):
        np.testing.assert_allclose(pooled[cell], activities[frames].mean(axis=0), atol=1e-5)


@settings(deadline=None)
@given(st.integers(1, 50))
def test_the_cells_of_a_level_tile_the_segment(frames: int) -> None:
    """However the frames divide, a level's mean is the segment's."""
    activities = random_activities(frames)
    pooled = means(PLAIN, trail(activities))
    for level in (slice(0, 1), slice(1, 3), slice(3, 7)):
        np.testing.assert_allclose(pooled[level].mean(axis=0), activities.mean(axis=0), atol=1e-5)


def test_cells_reach_over_their_borders_but_not_over_the_segments() -> None:
    """Halves that reach a quarter of their length over the middle hold five eighths of the segment."""
    activities = random_activities(16)
    pooled = means(Pyramid((2,), 0.25), trail(activities))
    np.testing.assert_allclose(pooled, [activities[:10].mean(axis=0), activities[6:].mean(axis=0)], atol=1e-5)


def test_order_matters_on_all_levels_but_the_first() -> None:
    activities = random_activities(20)
    forth, back = means(PLAIN, trail(activities)), means(PLAIN, trail(activities[::-1]))
    np.testing.assert_allclose(forth[0], back[0], atol=1e-5)
    np.testing.assert_allclose(forth[1:3], back[2:0:-1], atol=1e-5)
    assert np.abs(forth[1:] - back[1:]).max(axis=1).min() > 0.01


@settings(deadline=None)
@given(st.integers(1, 5), st.integers(1, 100_000))
def test_pace_does_not_matter(dwell: int, step_um: int) -> None:
    """Each frame shown several times, at rest or in even movement."""
    activities = random_activities(11)
    slow = np.repeat(activities, dwell, axis=0)
    expected = OVERLAPPING.vector(trail(activities))
    for steps in (None, np.full(len(slow), step_um)):
        np.testing.assert_allclose(OVERLAPPING.vector(trail(slow, steps)), expected, atol=1e-4)


def test_cells_are_measured_half_by_time_and_half_by_movement() -> None:
    """Ten frames in movement, ten at rest: the middle lies after two thirds of the movement."""
    moving, resting = np.eye(UNITS)[[0, 1]]
    activities = np.vstack([np.tile(moving, (10, 1)), np.tile(resting, (10, 1))])
    steps = np.repeat([3000, 0], 10)
    first, second = means(Pyramid((2,), 0.0), trail(activities, steps))
    np.testing.assert_allclose(first, moving, atol=1e-5)
    np.testing.assert_allclose(second, 0.25 * moving + 0.75 * resting, atol=1e-5)


def test_one_frame_is_in_every_cell_and_none_is_an_error() -> None:
    activities = random_activities(1)
    np.testing.assert_allclose(means(OVERLAPPING, trail(activities)), np.tile(activities, (7, 1)), atol=1e-5)
    with pytest.raises(ValueError, match="no frame"):
        OVERLAPPING.vector(trail(random_activities(0)))
