"""How early contacts are foreseen is scored as the page says, on takes whose answer is known."""

from dataclasses import replace

import numpy as np
import pytest

from action_fusion.intent.recent_paths import ARMS
from actum.node import SECOND_NS
from actum_model_trainer.foreseeing import baselines
from actum_model_trainer.foreseeing.scoring import (
    Said,
    ahead,
    before,
    calibration_error,
    earliest,
    false_alarms_per_min,
)
from actum_model_trainer.foreseeing.takes import Contact, Take

FRAMES, RATE_HZ = 301, 30
STAMPS_NS = np.arange(FRAMES) * SECOND_NS // RATE_HZ
TOUCHED_S = 6.0


def reach() -> Take:
    """The right hand goes straight from the origin to object 1, 0.6 m away, in the last 0.9 s before it touches it."""
    share = np.clip((STAMPS_NS / SECOND_NS - (TOUCHED_S - 0.9)) / 0.9, 0.0, 1.0)
    arms_m = np.full((FRAMES, len(ARMS), 3), np.nan)
    arms_m[:, 0] = 0.6 * (share**3 * (10 - 15 * share + 6 * share**2))[:, None] * [0.0, 0.0, 1.0]
    arms_m[:, 1] = [-0.3, 0.0, 0.0]
    places = {1: np.tile([0.0, 0.0, 0.6], (FRAMES, 1)), 2: np.tile([0.6, 0.0, 0.0], (FRAMES, 1))}
    return Take("reach", STAMPS_NS, arms_m, places, [Contact(round(TOUCHED_S * SECOND_NS), 0, 1, "lift")])


def said(number: int, from_s: float, until_s: float, probability: float = 0.8) -> Said:
    scores = np.zeros((FRAMES, 2))
    told = (from_s * SECOND_NS <= STAMPS_NS) & (until_s * SECOND_NS > STAMPS_NS)
    scores[told, number - 1] = probability
    return Said(reach(), scores)


def test_time_ahead_counts_from_the_first_frame_of_the_announcement() -> None:
    assert ahead([said(1, 5.4, 6.0)], 0.5).median_s == pytest.approx(0.6, abs=0.5 / RATE_HZ)


def test_an_announcement_of_another_object_is_wrong_and_foresees_nothing() -> None:
    result = ahead([said(2, 5.4, 6.0)], 0.5)
    assert (result.median_s, result.precision, result.recall) == (0.0, 0.0, 0.0)


def test_what_was_announced_longer_ago_than_the_horizon_is_a_false_alarm() -> None:
    early = [said(1, 4.0, 4.4)]
    assert ahead(early, 0.5).precision == 0.0
    assert false_alarms_per_min(early) == pytest.approx(60 / 10)
    assert false_alarms_per_min([said(1, 4.6, 5.0)]) == 0.0


def test_what_is_announced_while_somebody_points_is_no_false_alarm_and_no_probability_of_a_contact() -> None:
    early = said(1, 2.0, 3.0)
    pointing = replace(early, take=replace(early.take, pointing_ns=[(2 * SECOND_NS, 4 * SECOND_NS)]))
    assert false_alarms_per_min([early]) > 0 == false_alarms_per_min([pointing])
    late = said(1, 5.4, 6.0)
    assert calibration_error([early, late]) > calibration_error([pointing, late]) == pytest.approx(0.2)
    assert ahead([pointing, late], 0.5).precision == 1.0 > ahead([early, late], 0.5).precision


def test_what_is_announced_for_longer_than_the_horizon_is_announced_anew() -> None:
    """From 1.0, 2.5 and 4.0 s on in vain, and from 5.6 s on rightly."""
    result = ahead([said(1, 1.0, 6.0)], 0.5)
    assert result.precision == pytest.approx(1 / 4)
    assert result.median_s == pytest.approx(0.4, abs=0.1)


def test_two_objects_that_both_hands_are_about_to_touch_are_both_announced_for_as_long_as_both_are_likely() -> None:
    """That one or the other is likelier from frame to frame makes no further announcement."""
    take = reach()
    both = replace(take, contacts=[*take.contacts, Contact(round(6.1 * SECOND_NS), 1, 2, "hold")])
    told = (5.4 * SECOND_NS <= STAMPS_NS) & (STAMPS_NS < 6 * SECOND_NS)
    swaying = np.where(np.arange(FRAMES)[:, None] % 20 < 10, [0.8, 0.9], [0.9, 0.8])
    scored = Said(both, np.where(told[:, None], swaying, 0.0))
    assert [one.number for one in scored.announcements(0.5)] == [1, 2]
    result = ahead([scored], 0.5)
    assert (result.precision, result.recall) == (1.0, 1.0)
    assert result.median_s == pytest.approx(0.65, abs=0.5 / RATE_HZ)
    assert before([scored], 0.5).brier == pytest.approx(0.1**2 + 0.2**2, abs=1e-9)


def test_the_earliest_threshold_leaves_out_what_is_said_too_often_in_vain() -> None:
    sure, unsure = said(1, 5.6, 6.0, 0.9), said(2, 1.0, 2.0, 0.4)
    both = Said(sure.take, np.maximum(sure.scores, unsure.scores))
    assert earliest([both]).median_s == pytest.approx(0.4, abs=0.5 / RATE_HZ)
    assert earliest([both]).threshold > 0.4


def test_a_certain_and_right_answer_has_a_brier_score_of_0_and_a_wrong_one_of_2() -> None:
    assert before([said(1, 5.0, 6.0, 1.0)], 0.5).brier == 0.0
    assert before([said(2, 5.0, 6.0, 1.0)], 0.5).brier == 2.0


def test_probabilities_that_come_true_as_often_as_they_say_have_no_calibration_error() -> None:
    half = Said(reach(), np.where(STAMPS_NS[:, None] >= 3 * SECOND_NS + 1, [0.5, 0.0], 0.0))
    counted = STAMPS_NS > 3 * SECOND_NS
    true = counted & (TOUCHED_S - 1.5 <= STAMPS_NS / SECOND_NS) & (STAMPS_NS / SECOND_NS < TOUCHED_S)
    assert calibration_error([half]) == pytest.approx(abs(0.5 - true.sum() / counted.sum()))


@pytest.mark.parametrize(
    ("method", "from_s"),
    [(baselines.nearest, 5.3), (baselines.constant_velocity, 5.3), (baselines.minimum_jerk, 5.3)],
)
def test_on_a_straight_reach_at_minimum_jerk_every_baseline_is_right(method: baselines.Method, from_s: float) -> None:
    scores = method(reach())
    moving = (from_s * SECOND_NS < STAMPS_NS) & (STAMPS_NS < (TOUCHED_S - 0.1) * SECOND_NS)
    assert (scores[moving].argmax(axis=1) == 0).all()


def test_minimum_jerk_knows_the_end_of_such_a_reach_after_three_quarters_of_its_time() -> None:
    row = round((TOUCHED_S - 0.225) * RATE_HZ)
    assert -baselines.minimum_jerk(reach())[row, 0] < 0.1


def test_never_announces_nothing() -> None:
    assert earliest([Said(reach(), baselines.never(reach()))]).recall == 0.0


def test_before_contacts_at_the_very_beginning_nothing_was_said() -> None:
    at_once = replace(reach(), contacts=[Contact(round(0.2 * SECOND_NS), 0, 1, "lift")])
    assert np.isnan(before([Said(at_once, np.zeros((FRAMES, 2)))], 0.5)).all()
