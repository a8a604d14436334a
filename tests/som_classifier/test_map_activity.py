"""A map's soft activity and its centre, by hand; the ordered vector: what it keeps of a trajectory, and what not."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.som import Som
from som_classifier.map_activity import (
    NO_WINNER,
    MapActivity,
    map_activity,
    ordered_vector,
    resampled,
    soft_activity,
    trajectory,
    without_repeats,
)


def test_activity_is_one_at_the_winner_and_falls_with_squared_distance() -> None:
    np.testing.assert_allclose(soft_activity(np.array([0.0, 2.0, 8.0]), 4.0), np.exp([0, -0.5, -2]))


def test_activity_distinguishes_where_the_papers_does_not() -> None:
    distance2 = np.array([1.0, 1.5, 4.0])
    assert len(set(np.exp(-np.sqrt(distance2) / 1e6).astype(np.float16))) == 1
    assert np.ptp(soft_activity(distance2 - 1.0, 1.0)) > 0.9


def test_the_centre_of_activity_by_hand() -> None:
    """Three units in a row at 0, 1 and 3: an input at 0 is 1 and 9 further off in d² from the others."""
    row = Som(1, 3, np.array([[0.0], [1.0], [3.0]]))
    seen = map_activity(row, np.array([[0.0], [np.nan]]), contrast=2.0)
    weights = np.exp([0.0, -0.5, -4.5])
    assert seen.winners.tolist() == [0, NO_WINNER]
    assert seen.centres[0] == pytest.approx([0.0, weights @ [0, 1, 2] / weights.sum()])
    assert np.isnan(seen.centres[1]).all()


@given(st.floats(0, 3))
def test_with_little_contrast_left_the_centre_is_the_winner(at: float) -> None:
    row = Som(1, 3, np.array([[0.0], [1.0], [3.0]]))
    seen = map_activity(row, np.array([[at]]), contrast=1e-3)
    if min(abs(at - border) for border in (0.5, 2.0)) > 0.05:
        assert seen.centres[0] == pytest.approx(row.coordinates[seen.winners[0]])


cells = st.lists(st.integers(0, 899), min_size=1, max_size=40)
points = st.integers(2, 80)


def path_of(numbers: list[int]) -> np.ndarray:
    unique = without_repeats(np.array(numbers))
    return np.stack(np.divmod(unique, 30), axis=1).astype(np.float64)


def position_along(path: np.ndarray, point: np.ndarray, after: float) -> float:
    """The smallest arc length, not before `after`, at which the polyline passes through a point."""
    reached = 0.0
    for start, end in pairwise(path):
        step = float(np.linalg.norm(end - start))
        along = float(np.clip((point - start) @ (end - start) / step**2, 0, 1))
        on_it = np.allclose(start + along * (end - start), point, atol=1e-9)
        if on_it and reached + along * step >= after - 1e-9:
            return reached + along * step
        reached += step
    raise AssertionError(f"{point} is not on the path after {after}")


def test_repeats_are_dropped_only_where_they_follow_each_other() -> None:
    assert without_repeats(np.array([7, 7, 3, 3, 3, 7, 1])).tolist() == [7, 3, 7, 1]


def test_a_trajectory_has_the_centre_at_each_change_of_the_winner() -> None:
    centres = np.arange(12.0).reshape(6, 2)
    seen = MapActivity(np.array([7, 7, NO_WINNER, 7, 3, 7]), centres)
    assert trajectory(seen).tolist() == centres[[0, 4, 5]].tolist()


def test_resampling_by_hand() -> None:
    """A path of length 3 + 4 cut into seven equal steps."""
    corner = np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]])
    expected = [[0, 0], [1, 0], [2, 0], [3, 0], [3, 1], [3, 2], [3, 3], [3, 4]]
    np.testing.assert_allclose(resampled(corner, 8), expected, atol=1e-12)


def test_the_vector_is_row_and_column_point_after_point() -> None:
    vector = ordered_vector(np.array([[1.0, 5.0], [3.0, 9.0]]), 3)
    np.testing.assert_allclose(vector, [1, 5, 2, 7, 3, 9])


def test_a_still_posture_is_its_point_repeated() -> None:
    assert ordered_vector(np.array([[4.0, 9.0]]), 3).tolist() == [4, 9, 4, 9, 4, 9]


@pytest.mark.parametrize(("path", "count"), [(np.empty((0, 2)), 5), (np.zeros((3, 2)), 1)])
def test_no_point_or_no_length_is_an_error(path: np.ndarray, count: int) -> None:
    with pytest.raises(ValueError, match="cannot be resampled"):
        ordered_vector(path, count)


@given(cells, st.data(), points)
def test_frames_repeated_leave_it_bit_identical(numbers: list[int], data: st.DataObject, count: int) -> None:
    """The same movement at any speed, even an uneven one."""
    dwell = data.draw(st.lists(st.integers(1, 5), min_size=len(numbers), max_size=len(numbers)))
    slower = np.repeat(numbers, dwell).tolist()
    np.testing.assert_array_equal(ordered_vector(path_of(slower), count), ordered_vector(path_of(numbers), count))


@given(cells, points)
def test_the_movement_reversed_is_the_vector_reversed(numbers: list[int], count: int) -> None:
    forth, back = resampled(path_of(numbers), count), resampled(path_of(numbers[::-1]), count)
    np.testing.assert_allclose(back, forth[::-1], atol=1e-9)


@given(cells, points)
def test_the_ends_are_kept_exactly(numbers: list[int], count: int) -> None:
    path = path_of(numbers)
    placed = resampled(path, count)
    assert placed[0].tolist() == path[0].tolist()
    assert placed[-1].tolist() == path[-1].tolist()


@given(cells, points)
def test_points_stand_at_equal_arc_length_along_the_path(numbers: list[int], count: int) -> None:
    path = path_of(numbers)
    step = float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) / (count - 1)
    if len(path) == 1:
        return
    for k, point in enumerate(resampled(path, count)):
        assert position_along(path, point, after=k * step) == pytest.approx(k * step, abs=1e-6)
