"""The yardstick is what its definition says."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.recording import Recording
from actum_model_trainer.baseline import POINTS, hand_path, hand_paths, nearest_neighbour
from performers import HAND_PATHS


def frames(left_m: np.ndarray, right_m: np.ndarray, torso_m: np.ndarray) -> np.ndarray:
    return np.stack([left_m, right_m, torso_m], axis=1)


def test_the_hand_with_the_longer_path_is_taken() -> None:
    moving = np.linspace([0, 0, 0], [1, 0, 0], 5)
    still = np.zeros((5, 3))
    stamps_ns = np.arange(5)
    for path_m in (hand_path(frames(*hands, still), stamps_ns) for hands in ((moving, still), (still, moving))):
        np.testing.assert_allclose(path_m, np.linspace([0, 0, 0], [1, 0, 0], POINTS))


def test_the_path_is_resampled_in_time() -> None:
    """Half the way in the first quarter of the time, the rest in the remaining three."""
    hand = np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]])
    path_m = hand_path(frames(hand, np.zeros((3, 3)), np.zeros((3, 3))), np.array([0, 25, 100]))
    elapsed = np.linspace(0, 1, POINTS)
    np.testing.assert_allclose(path_m[:, 0], np.where(elapsed < 0.25, 4 * elapsed, 1 + (elapsed - 0.25) / 0.75))


@given(st.tuples(*[st.floats(-5, 5)] * 3))
def test_where_the_person_stands_does_not_matter(shift_m: tuple[float, float, float]) -> None:
    rng = np.random.default_rng(0)
    seen = rng.random((6, 3, 3))
    stamps_ns = np.arange(6)
    np.testing.assert_allclose(hand_path(seen + shift_m, stamps_ns), hand_path(seen, stamps_ns), atol=1e-9)


def test_a_path_spans_its_segment_alone(three_people: list[Recording]) -> None:
    paths = list(hand_paths(three_people[:1]))
    assert [path.label for path in paths] == [*HAND_PATHS] * 2
    for path in paths:
        assert path.points_m is not None
        travelled_m = path.points_m[-1] - path.points_m[0]
        np.testing.assert_allclose(travelled_m, 0.9 * HAND_PATHS[path.label][1], atol=0.02)


def test_the_nearest_training_path_answers(three_people: list[Recording]) -> None:
    evaluation = nearest_neighbour(three_people[:2], three_people[2:])
    assert (evaluation.n, evaluation.accuracy) == (6, 1.0)


def test_no_training_path_is_an_error(three_people: list[Recording]) -> None:
    with pytest.raises(ValueError, match="no labelled segment"):
        nearest_neighbour([], three_people)
