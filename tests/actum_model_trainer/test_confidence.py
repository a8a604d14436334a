"""Confidence follows from cross-validated scores, and from the prior where few people are known."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from actum.arrays import Indices
from actum.skeletons import INDEX
from actum.som import Som
from actum_model_trainer.confidence import (
    body_movement,
    cross_validated_inverse_temperature,
    expected_log_errors,
    inverse_temperatures,
    least_movement_m,
    log_errors_of,
)
from actum_model_trainer.discriminants import Discriminants, FittedStage
from actum_model_trainer.progress import silent
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training_data import SampleMeasures
from actum_model_trainer.upper_layers import UpperLayers, train_upper
from performers import TINY
from recognisers import tiny_samples
from som_classifier.body_movement import LEAST_M, BodyMovement, log_movements
from som_classifier.first_layer import MAP_INPUTS, FirstMaps
from som_classifier.kinematics import averaged

ACTIONS, EACH = 3, 30
TARGETS = np.repeat(np.arange(ACTIONS), EACH)
NOBODY = np.zeros((0, ACTIONS), np.float32)
PRIOR = replace(TINY.prior, gain=1.0, gain_where_inferred=0.8)
"""Less sure than the cross-validated examples below."""


def scored(noise: float) -> FittedStage:
    """Scores of about 1 for the action done and 0 for the others."""
    rows = np.eye(ACTIONS)[TARGETS] + np.random.default_rng(1).normal(0, noise, (len(TARGETS), ACTIONS))
    return FittedStage(Discriminants(NOBODY, NOBODY, rows, rows, rows, NOBODY), np.arange(len(TARGETS)), TARGETS)


UPPER: UpperLayers = train_upper(scored(0.1), ACTIONS, TINY, np.random.default_rng(0), silent)


def inverse_temperature(noise: float, people: int, depth_inferred: bool = False) -> float:
    (found,) = inverse_temperatures([scored(noise)], UPPER, PRIOR, people, depth_inferred)
    return found


def matched(noise: float) -> float:
    return cross_validated_inverse_temperature(scored(noise), UPPER)


def test_from_one_person_it_is_the_prior_however_well_their_own_examples_are_told_apart() -> None:
    assert matched(0.05) > PRIOR.gain
    assert inverse_temperature(0.05, people=1) == pytest.approx(PRIOR.gain)
    assert inverse_temperature(0.05, people=1, depth_inferred=True) == pytest.approx(PRIOR.gain_where_inferred)


def test_as_many_people_as_the_prior_is_worth_count_as_much() -> None:
    half = inverse_temperature(0.05, people=1 + round(PRIOR.people))
    assert half == pytest.approx(np.sqrt(PRIOR.gain * matched(0.05)))


@pytest.mark.parametrize("people", [1, 2, 50])
def test_it_is_never_larger_than_the_matched_one(people: int) -> None:
    assert inverse_temperature(3.0, people) == matched(3.0) < PRIOR.gain


def test_each_stage_has_its_own_inverse_temperature() -> None:
    early, late = inverse_temperatures([scored(3.0), scored(0.1)], UPPER, PRIOR, 5, False)
    assert early < 0.5 * late


def still_maps() -> FirstMaps:
    """A first layer of one unit in each map."""
    maps = {name: Som(1, 1, np.zeros((1, each.size), np.float32)) for name, each in MAP_INPUTS.items()}
    return FirstMaps(maps, dict.fromkeys(maps, 1.0), (0.4, 0.1))


def test_expected_log_errors_by_hand() -> None:
    """A map of one unit: three samples of one action are off it by d² = 1 m², one of another by e² m²."""
    off_m = np.zeros((1, 15, 3))
    off_m[0, 7, 1] = 1.0
    first = still_maps()
    log_errors = log_errors_of(first, [off_m, off_m, np.e * off_m, off_m])
    found = expected_log_errors(log_errors, np.array([0, 0, 1, 0]), PRIOR)
    mean = (0 + 0 + 2 + 0) / 4
    once_more = [(3 * 0 + mean) / 4, (2 + mean) / 2]
    assert found == pytest.approx([PRIOR.log_error + own - mean for own in once_more])


def test_frames_without_any_joint_do_not_fail() -> None:
    """It counts as no error at all, as it does live."""
    first = still_maps()
    nothing, still_m = np.full((2, 15, 3), np.nan), np.zeros((2, 15, 3))
    log_errors = log_errors_of(first, [nothing, still_m])
    assert expected_log_errors(log_errors, np.array([0, 1]), PRIOR) == [PRIOR.log_error] * 2


def moving(label: str, way_m: float) -> SegmentSample:
    """A sample in which all joints go that far."""
    one = tiny_samples()[0]
    postures = np.zeros_like(one.postures)
    postures[..., 1] = np.linspace(0, way_m, len(postures))[:, None]
    return replace(one, label=label, postures=postures)


def measures_of(samples: Sequence[SegmentSample]) -> SampleMeasures:
    return SampleMeasures.of(samples, still_maps(), [sample.postures for sample in samples])


def least_m(samples: Sequence[SegmentSample]) -> float:
    measures = measures_of(samples)
    return least_movement_m(measures.movements_m, np.unique(measures.labels, return_inverse=True)[1])


def body_of(samples: Sequence[SegmentSample], targets: Indices, people: int) -> BodyMovement:
    measures = measures_of(samples)
    return body_movement(measures.log_movements, measures.movements_m, targets, measures.people, PRIOR, people)


def test_the_least_movement_is_that_of_the_action_that_moves_least() -> None:
    wide, small = moving("lift", 0.4), moving("point", 0.2)
    assert least_m([wide, small]) == pytest.approx(least_m([small]), abs=1e-4)
    assert 0 < least_m([small]) < least_m([wide])


def test_one_sample_that_was_marked_while_nothing_was_done_does_not_decide() -> None:
    samples = [moving("lift", way_m) for way_m in (0.3, 0.3, 0.3, 0.0)]
    assert least_m(samples) == least_m(samples[:1])


def test_standing_still_can_be_taught() -> None:
    assert least_m([moving("lift", 0.4), moving("lift", 0.5), moving("stand", 0.01)]) < 0.01


def swaying(person: str, way_m: float) -> SegmentSample:
    """A sample of one action in which everything goes to and fro so far."""
    return replace(moving("lift", way_m), person=person)


def test_how_much_legs_and_trunk_move_is_the_mean_of_the_logarithm_over_an_actions_samples() -> None:
    samples = [swaying("1", 0.4), swaying("2", 0.8), moving("stand", 0.0)]
    body = body_of(samples, np.array([0, 0, 1]), 2)
    first, second = (np.exp(log_movements(averaged(each.stamps_ns, each.postures))) for each in samples[:2])
    assert np.exp(body.usual[0]) == pytest.approx(np.sqrt(first * second))
    assert np.exp(body.usual[1]) == pytest.approx([LEAST_M, LEAST_M])


def test_by_how_much_more_they_move_is_shown_by_other_people_and_from_one_person_the_prior() -> None:
    samples = [swaying("1", 0.4), swaying("2", 0.8), swaying("2", 0.8)]
    targets = np.zeros(3, dtype=np.intp)
    assert body_of(samples, targets, 1).most_above == [PRIOR.movement_above] * 2
    shown = np.log(2)  # the second person beside the first
    expected = (PRIOR.people * PRIOR.movement_above + shown) / (PRIOR.people + 1)
    assert body_of(samples, targets, 2).most_above == pytest.approx([expected] * 2, rel=1e-3)
    alone = [swaying("1", 0.4)] * 3
    assert body_of(alone, targets, 3).most_above == [PRIOR.movement_above] * 2, "nobody beside another"


def test_people_who_all_stand_still_may_move_twice_as_much() -> None:
    samples = [swaying(str(person), 0.0) for person in range(20)]
    body = body_of(samples, np.zeros(20, dtype=np.intp), 20)
    assert body.most_above == pytest.approx([np.log(2)] * 2)


def test_legs_that_nobody_showed_may_move_as_they_like() -> None:
    unseen = [swaying(str(person), 0.1) for person in range(3)]
    for each in unseen:
        each.postures[:, [INDEX[joint] for joint in ("left_knee", "left_foot", "right_knee", "right_foot")]] = np.nan
    body = body_of(unseen, np.zeros(3, dtype=np.intp), 3)
    assert body.usual[0][0] == pytest.approx(np.log(100)) and body.most_above[0] == pytest.approx(PRIOR.movement_above)
