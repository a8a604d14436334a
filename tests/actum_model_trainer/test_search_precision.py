"""How often an action is done in what a search finds, as training counts it, and what a search is worth."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.scoring import background_min, event_scores
from actum_model_trainer.spotting.threshold_choice import precision, worth_of
from performers import TINY

PRIOR = TINY.prior
TRUTHS = [Truth("file", 1, 100, 200, "lift"), Truth("file", 1, 300, 500, "push"), Truth("other", 1, 600, 700, "lift")]


def precision_of(*found: tuple[str, int, int, int]) -> float:
    """As counted where segments of these files, agents and bounds were found, without what the prior adds."""
    detections = [Detection(*each, each[3], "lift", 1.0) for each in found]
    added = PRIOR.precision_segments
    return precision(Found(detections, TRUTHS), PRIOR) * (len(found) + added) - added * PRIOR.precision


@pytest.mark.parametrize(
    ("found", "is_done"),
    [
        (("file", 1, 100, 200), True),
        (("file", 1, 300, 500), True),
        (("file", 1, 150, 260), True),
        (("file", 1, 380, 420), True),
        (("file", 1, 0, 1000), True),
        (("file", 1, 151, 260), False),
        (("file", 1, 210, 290), False),
        (("file", 2, 100, 200), False),
        (("other", 1, 100, 200), False),
        (("third", 1, 100, 200), False),
    ],
    ids=[
        "an action",
        "an action that is called otherwise",
        "half of the shorter",
        "within an action",
        "around one",
        "less than half",
        "between actions",
        "somebody else",
        "another recording",
        "a recording in which nothing is done",
    ],
)
def test_an_action_is_done_where_half_of_the_shorter_is_common_whatever_it_is_called(
    found: tuple[str, int, int, int], is_done: bool
) -> None:
    assert precision_of(found) == pytest.approx(float(is_done))


def test_each_segment_found_counts_once() -> None:
    assert precision_of(("file", 1, 100, 500), ("file", 1, 100, 200), ("file", 1, 210, 290)) == pytest.approx(2)


@given(right=st.integers(0, 300), wrong=st.integers(0, 300))
def test_few_segments_move_it_little_from_the_prior_and_many_leave_little_of_that(right: int, wrong: int) -> None:
    found = [Detection("file", 1, *bounds, 500, "lift", 1.0) for bounds in [(100, 200)] * right + [(210, 290)] * wrong]
    counted, added = precision(Found(found, TRUTHS), PRIOR), PRIOR.precision_segments
    weight = len(found) / (len(found) + added)
    own = right / len(found) if found else 0.0
    assert counted == pytest.approx(weight * own + (1 - weight) * PRIOR.precision)
    assert 0.0 < counted <= 1.0


@pytest.mark.parametrize(
    ("minutes", "alarms", "cost"),
    [(10, 0, 0.0), (10, 5, 0.0), (10, 6, 0.01), (10, 25, 0.2), (1, 1, 0.05), (0.5, 1, 0.15), (0.4, 9, 0.0)],
)
def test_each_false_alarm_a_minute_costs_a_tenth_after_the_first_half(minutes: float, alarms: int, cost: float) -> None:
    """Nothing costs anything where there is less than half a minute of background."""
    seen = Stretch("file", 1, 0, round(minutes * 60 * SECOND_NS))
    starts_ns = [round(k * 0.5 * SECOND_NS) for k in range(alarms)]
    found = Found([Detection("file", 1, at, at + 1, at + 1, "lift", 1.0) for at in starts_ns], seen=[seen])
    assert worth_of(event_scores(found, background_min(found.seen, found.truths))) == pytest.approx(-cost)
