import numpy as np
import pytest

pytest.importorskip("aeon", reason='the peers need pip install -e ".[benchmarks]"')

from benchmarks.recognition.development import DevelopmentSet
from benchmarks.recognition.sets import HALF_ERROR, PEERS, Errors

pytestmark = pytest.mark.thorough

SEQUENCES = 4


@pytest.fixture
def errors() -> Errors:
    """Ours is wrong about one sequence, the second peer about two, the others about all."""
    wrong = np.ones((1 + len(PEERS), SEQUENCES))
    wrong[0] = [1, 0, 0, 0]
    wrong[2] = [0, 1, 1, 0]
    return Errors(DevelopmentSet("made up", "", [], [], []), wrong, np.ones(SEQUENCES))


def test_the_best_peer_makes_the_fewest_errors(errors: Errors) -> None:
    assert errors.best_peer == 2


def test_the_ratio_is_of_errors_and_half_a_one(errors: Errors) -> None:
    ratio = np.exp(errors.log_ratio(np.ones(SEQUENCES)))
    assert ratio == pytest.approx((1 + HALF_ERROR) / (2 + HALF_ERROR))


def test_a_resample_counts_each_sequence_as_often_as_it_is_drawn(errors: Errors) -> None:
    times = np.array([[4, 0, 0, 0], [0, 3, 1, 0], [0, 0, 0, 4]])
    expected = [(4 + HALF_ERROR) / HALF_ERROR, HALF_ERROR / (4 + HALF_ERROR), 1.0]
    np.testing.assert_allclose(np.exp(errors.log_ratio(times)), expected)
