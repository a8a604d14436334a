"""Soft activity of a map and its centre, against hand-computed cases."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.som import Som
from som_classifier.map_activity import NO_WINNER, map_activity, soft_activity


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
