"""An associative map goes on without input as it went on before."""

import numpy as np
import pytest

from actum.arrays import Floats
from actum_model_trainer.associative_training import AssociationLearning
from som_classifier.associative_som import AssociativeSom

THERE_AND_BACK = [0, 1, 2, 3, 2, 1]
CIRCLE = [0, 1, 2, 3]
UNITS = 4


def one_hot(cycle: list[int], rounds: int = 1) -> Floats:
    return np.eye(UNITS, dtype=np.float32)[cycle * rounds]


def learnt(cycle: list[int]) -> AssociativeSom:
    """A map that was shown a cycle of single active units again and again."""
    learning, shown = AssociationLearning(UNITS), one_hot(cycle, rounds=3)
    for _ in range(100):
        for before, now, after in zip(shown, shown[1:], shown[2:], strict=False):
            learning.adapt(now, before, after, 0.5)
    return learning.learnt


@pytest.mark.parametrize("cycle", [CIRCLE, THERE_AND_BACK])
def test_a_cycle_goes_on(cycle: list[int]) -> None:
    shown = one_hot(cycle, rounds=3)
    followed = learnt(cycle).continued(shown[1], shown[0], steps=8)
    assert followed == pytest.approx(shown[2:10], abs=0.05)


def test_a_movement_goes_on_in_the_direction_in_which_it_began() -> None:
    association, (left, middle, right) = learnt(THERE_AND_BACK), np.eye(UNITS, dtype=np.float32)[:3]
    assert association.continued(middle, left, steps=1)[0].argmax() == 2
    assert association.continued(middle, right, steps=1)[0].argmax() == 0


def test_untrained_activity_stays_as_it_is() -> None:
    now, before = np.random.default_rng(0).random((2, UNITS))
    assert np.array_equal(AssociativeSom.untrained(UNITS).continued(now, before, steps=3), [now] * 3)


def test_the_delta_rule_corrects_a_share_of_the_error() -> None:
    """With ‖x‖² = 2 and zero weights the new answer is β times the change, from either of the two inputs half of it."""
    learning, (now, before, after) = AssociationLearning(UNITS), np.eye(UNITS, dtype=np.float32)[:3]
    learning.adapt(now, before, after, 0.5)
    expected = np.zeros((2, UNITS, UNITS))
    expected[0, 0], expected[1, 1] = 0.25 * (after - now), 0.25 * (after - now)
    assert np.array_equal(learning.learnt.changes, expected)


def test_readings_are_those_of_the_activities_in_between() -> None:
    """Values are read from their mean over the units, in which the sum of activity does not count."""
    rng = np.random.default_rng(1)
    association = AssociativeSom((0.1 * rng.normal(size=(2, UNITS, UNITS))).astype(np.float16))
    now, before, values = *rng.random((2, UNITS)), rng.normal(size=(UNITS, 3))
    followed = association.continued(now, before, steps=4)[[0, 1, 3]]
    read = np.tensordot(np.concatenate([now, before]), association.readings(values, (1, 2, 4)), axes=1)
    assert read == pytest.approx((followed - now) @ (values - values.mean(axis=0)), abs=1e-4)


@pytest.mark.parametrize("changes", [np.zeros((2, 3, 4)), np.zeros((3, 4)), np.full((2, 3, 3), np.nan)])
def test_other_weights_are_refused(changes: Floats) -> None:
    with pytest.raises(ValueError, match=r"give finite numbers of the shape \(2, units, units\)"):
        AssociativeSom(changes.astype(np.float16))
