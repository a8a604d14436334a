"""How early contacts are foreseen is scored as the page says, on takes whose answer is known."""

import numpy as np
import pytest
from benchmarks.intent import baselines
from benchmarks.intent.learning import features_of
from benchmarks.intent.scoring import Said, ahead, before, calibration_error, earliest, false_alarms_per_min
from benchmarks.intent.takes import Contact, Take, simulated

from action_fusion.intent.contact_network import shipped_network
from action_fusion.intent.recent_paths import ARMS
from actum.node import SECOND_NS

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
    early = [said(1, 1.0, 4.4)]
    assert ahead(early, 0.5).precision == 0.0
    assert false_alarms_per_min(early) == pytest.approx(60 / 10)
    assert false_alarms_per_min([said(1, 1.0, 4.6)]) == 0.0


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


def test_the_network_that_comes_with_actum_foresees_contacts_of_people_it_has_not_seen() -> None:
    network = shipped_network()
    takes = simulated([201], 9)
    told = []
    for take in takes:
        probability = np.array([network.foresee(each).probability.sum(axis=0) for each in features_of(take)])
        told.append(Said(take, probability))
    assert before(told, 0.5).right >= 0.8
    assert ahead(told, 0.8).median_s >= 0.3
