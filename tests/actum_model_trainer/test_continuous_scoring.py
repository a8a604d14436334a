"""What was found without marks is scored one to one, whatever its order and its clock."""

import json
from collections.abc import Sequence
from dataclasses import replace
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from actum_model_trainer.continuous.continuous_report import continuous_report
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth, point_fractions
from actum_model_trainer.continuous.matching import intersection_over_union, matched
from actum_model_trainer.continuous.scoring import ContinuousScores, scores_of

S = 1_000_000_000
LABELS = ("lift", "push", "drink")


def done(label: str, start_s: float, end_s: float, agent: int = 1, point_s: float | None = None) -> Truth:
    point_ns = None if point_s is None else round(point_s * S)
    return Truth("a.mcap", agent, round(start_s * S), round(end_s * S), label, point_ns)


def found(
    label: str, start_s: float, end_s: float, *, agent: int = 1, confidence: float = 0.9, after_s: float = 0.25
) -> Detection:
    start_ns, end_ns = round(start_s * S), round(end_s * S)
    return Detection("a.mcap", agent, start_ns, end_ns, end_ns + round(after_s * S), label, confidence)


def seen(end_s: float, agent: int = 1) -> Stretch:
    return Stretch("a.mcap", agent, 0, round(end_s * S))


def moved(truth: Truth, by_ns: int) -> Truth:
    point_ns = None if truth.point_ns is None else truth.point_ns + by_ns
    return replace(truth, start_ns=truth.start_ns + by_ns, end_ns=truth.end_ns + by_ns, point_ns=point_ns)


def scored(detections: Sequence[Detection], truths: Sequence[Truth], minutes: float = 1.0) -> ContinuousScores:
    return scores_of(Found(detections, truths, [seen(60 * minutes)]))


LIFT, PUSH = done("lift", 10, 12), done("push", 20, 24)

times = st.tuples(st.integers(0, 100), st.integers(1, 20)).map(lambda time: (time[0], time[0] + time[1]))
people = st.sampled_from([1, 2])
detections = st.lists(
    st.builds(
        lambda label, time, agent, after, confidence, familiarity: Detection(
            "a.mcap", agent, time[0] * S, time[1] * S, (time[1] + after) * S, label, confidence, familiarity=familiarity
        ),
        st.sampled_from(LABELS), times, people, st.integers(0, 3), st.sampled_from([0.2, 0.5, 0.9]),
        st.sampled_from([None, 0.3, 0.5, 0.8]),
    ),
    max_size=8,
)  # fmt: skip
truths = st.lists(
    st.builds(
        lambda label, time, agent: Truth("a.mcap", agent, time[0] * S, time[1] * S, label, sum(time) * S // 2),
        st.sampled_from(LABELS), times, people,
    ),
    max_size=6,
)  # fmt: skip


def all_f1(scores: ContinuousScores) -> list[float]:
    return [scores.event.f1, *scores.f1_at_iou.values(), scores.point_f1 or 0.0]


@given(detections, truths, st.randoms())
def test_the_order_counts_for_nothing(given_: list[Detection], truths_: list[Truth], random: Random) -> None:
    shuffled, shuffled_truths = list(given_), list(truths_)
    random.shuffle(shuffled)
    random.shuffle(shuffled_truths)
    assert scored(shuffled, shuffled_truths) == scored(given_, truths_)


@given(detections, truths)
def test_all_pairs_at_once_fit_as_those_that_are_matched_one_by_one(
    given_: list[Detection], truths_: list[Truth]
) -> None:
    one_by_one = [match.fit for match in matched(given_, truths_, intersection_over_union)]
    assert sorted(Found(given_, truths_).pairs.fits().tolist()) == sorted(one_by_one)


@given(detections, truths, st.integers(-(10**15), 10**15))
def test_shifting_every_stamp_changes_nothing(given_: list[Detection], truths_: list[Truth], by_ns: int) -> None:
    later = [
        replace(d, start_ns=d.start_ns + by_ns, end_ns=d.end_ns + by_ns, decided_ns=d.decided_ns + by_ns)
        for d in given_
    ]
    later_truths = [moved(truth, by_ns) for truth in truths_]
    stretch = seen(60)
    later_seen = replace(stretch, start_ns=stretch.start_ns + by_ns, end_ns=stretch.end_ns + by_ns)
    assert scores_of(Found(later, later_truths, [later_seen])) == scores_of(Found(given_, truths_, [stretch]))


@given(detections.filter(bool), truths, st.data())
def test_an_answer_told_twice_never_raises_f1(
    given_: list[Detection], truths_: list[Truth], data: st.DataObject
) -> None:
    again = data.draw(st.sampled_from(given_))
    once, twice = scored(given_, truths_), scored([*given_, again], truths_)
    assert all(after <= before for after, before in zip(all_f1(twice), all_f1(once), strict=True))
    assert twice.event.right == once.event.right
    assert twice.false_detections == once.false_detections + 1


@given(truths.filter(bool))
def test_finding_just_what_was_done_is_1(truths_: list[Truth]) -> None:
    apart = [moved(truth, 200 * number * S) for number, truth in enumerate(truths_)]
    perfect = [Detection(t.file, t.agent, t.start_ns, t.end_ns, t.end_ns, t.label, 1.0) for t in apart]
    scores = scored(perfect, apart, minutes=100)
    assert all_f1(scores) == [1.0] * 5
    assert (scores.false_detections, scores.fragmentations, scores.merges) == (0, 0, 0)
    assert (scores.recall_at_rate, scores.latency_s) == (1.0, (0.0, 0.0))


@given(truths)
def test_finding_nothing_is_0(truths_: list[Truth]) -> None:
    scores = scored([], truths_)
    assert all_f1(scores) == [0.0] * 5
    assert (scores.event.precision, scores.event.recall, scores.latency_s) == (0.0, 0.0, None)


@given(detections, truths)
def test_no_truth_and_no_detection_counts_twice(given_: list[Detection], truths_: list[Truth]) -> None:
    scores = scored(given_, truths_)
    assert scores.event.right <= min(len(given_), len(truths_))
    assert sum(score.right for score in scores.per_action.values()) == scores.event.right
    ordered = all_f1(scores)[:4]
    assert ordered == sorted(ordered, reverse=True)


def test_an_event_needs_the_right_label_and_a_time_in_common() -> None:
    assert scored([found("lift", 11.9, 15)], [LIFT]).event.f1 == 1.0
    assert scored([found("lift", 12, 15)], [LIFT]).event.f1 == 0.0
    assert scored([found("push", 10, 12)], [LIFT]).event.f1 == 0.0


def test_overlap_is_of_what_both_cover() -> None:
    """2 of 4 seconds: IoU 0.5. 1 of 5: 0.2."""
    assert scored([found("lift", 10, 14)], [LIFT]).f1_at_iou == {0.1: 1.0, 0.25: 1.0, 0.5: 1.0}
    assert scored([found("lift", 11, 15)], [LIFT]).f1_at_iou == {0.1: 1.0, 0.25: 0.0, 0.5: 0.0}


def test_f1_by_hand() -> None:
    """Two right of three found and four done: 2 · 2 / (3 + 4)."""
    more = [LIFT, PUSH, done("lift", 30, 32), done("lift", 40, 42)]
    scores = scored([found("lift", 10, 12), found("push", 20, 24), found("drink", 30, 32)], more)
    assert scores.event.f1 == pytest.approx(4 / 7)
    assert (scores.event.precision, scores.event.recall) == (pytest.approx(2 / 3), 1 / 2)
    assert {label: (s.truths, s.detections, s.right) for label, s in scores.per_action.items()} == {
        "drink": (0, 1, 0),
        "lift": (3, 1, 1),
        "push": (1, 1, 1),
    }


def test_an_answer_that_reaches_into_two_truths_is_one_of_them() -> None:
    both = [done("lift", 10, 12), done("lift", 12, 15)]
    assert scored([found("lift", 11, 15)], both).event.right == 1
    assert scored([found("lift", 11, 15), found("lift", 11, 15)], both).event.right == 1
    assert scored([found("lift", 10, 12), found("lift", 11, 15)], both).event.right == 2


def test_of_truths_that_are_overlapped_alike_the_earliest_is_claimed() -> None:
    """0 to 4 s overlaps 0 to 2 s and 0 to 8 s by a half (IoU); another answer fits the latter exactly."""
    short, long = done("lift", 0, 2), done("lift", 0, 8)
    answers = [found("lift", 0, 4), found("lift", 0, 8)]
    assert scored(answers, [short, long]).event.right == scored(answers, [long, short]).event.right == 2


def test_agents_and_files_are_separate() -> None:
    assert scored([found("lift", 10, 12, agent=2)], [LIFT]).event.f1 == 0.0
    assert scored([replace(found("lift", 10, 12), file="b.mcap")], [LIFT]).event.f1 == 0.0


def test_false_detections_are_those_that_answer_no_truth_by_minutes_without_an_action() -> None:
    """66 s seen, 6 s of which are actions: a minute of background."""
    answers = [found("lift", 10, 12), found("lift", 10.5, 11), found("drink", 21, 22), found("push", 50, 51)]
    scores = scores_of(Found(answers, [LIFT, PUSH], [seen(66)]))
    assert (scores.background_min, scores.false_detections, scores.false_per_min) == (1.0, 3, 3.0)
    assert scores.alarms_per_min == 1.0


def test_background_is_counted_for_each_person_and_outside_truths_that_overlap() -> None:
    overlapping = [done("lift", 10, 14), done("push", 12, 16)]
    scores = scores_of(Found([], overlapping, [seen(36), seen(30, agent=2)]))
    assert scores.background_min == pytest.approx((36 - 6 + 30) / 60)


def test_recordings_without_background_have_no_rate() -> None:
    scores = scores_of(Found([found("lift", 10, 12)], [LIFT], [replace(seen(12), start_ns=10 * S)]))
    assert (scores.background_min, scores.false_per_min, scores.recall_at_rate) == (0.0, None, None)
    assert scores.event.f1 == 1.0


def test_latency_is_from_the_true_end_to_the_answer() -> None:
    answers = [found("lift", 10, 12, after_s=0.5), found("push", 20, 23, after_s=0.5)]
    median_s, ninth_decile_s = scored(answers, [LIFT, PUSH]).latency_s or (None, None)
    assert median_s == pytest.approx((0.5 - 0.5) / 2)
    assert ninth_decile_s == pytest.approx(0.4)


def test_a_truth_in_pieces_and_truths_in_one_are_counted() -> None:
    assert scored([found("lift", 10, 10.8), found("push", 11, 12)], [LIFT]).fragmentations == 1
    assert scored([found("lift", 9, 30)], [LIFT, PUSH]).merges == 1
    touching = [found("lift", 9.5, 12.1), found("push", 12.1, 24)]
    scores = scored(touching, [LIFT, done("push", 12, 24)])
    assert (scores.fragmentations, scores.merges) == (0, 0)


@given(detections, truths)
def test_recall_at_a_false_alarm_a_minute_is_the_best_of_all_thresholds(
    given_: list[Detection], truths_: list[Truth]
) -> None:
    kept = [[d for d in given_ if d.sureness >= least] for least in {d.sureness for d in given_}]
    at_thresholds = [scored(each, truths_, minutes=4) for each in kept]
    allowed = [each.event.recall for each in at_thresholds if (each.false_per_min or 0.0) <= 1.0]
    assert scored(given_, truths_, minutes=4).recall_at_rate == max(allowed, default=0.0)


def test_an_action_point_is_claimed_within_a_third_of_a_second() -> None:
    of_lift = done("lift", 10, 12, point_s=11.3)
    assert scored([found("lift", 10, 12)], [of_lift]).point_f1 == 1.0
    assert scored([found("lift", 10, 11.9)], [of_lift]).point_f1 == 0.0
    told = replace(found("lift", 10, 11.9), point_ns=11 * S)
    assert scored([told], [of_lift]).point_f1 == 1.0
    assert scored([told], [LIFT]).point_f1 is None


def test_where_action_points_lie_is_the_median_of_their_fractions() -> None:
    lifts = [done("lift", 0, 4, point_s=point_s) for point_s in (1, 2, 4)]
    assert point_fractions([*lifts, PUSH]) == {"lift": 0.5}


@given(detections, truths)
def test_json_holds_all_that_is_scored(given_: list[Detection], truths_: list[Truth]) -> None:
    everything = Found(tuple(given_), tuple(truths_), (seen(60),))
    written = json.loads(json.dumps(everything.as_json()))
    assert [Detection(**each) for each in written["detections"]] == given_
    assert [Truth(**each) for each in written["truths"]] == truths_
    assert [Stretch(**each) for each in written["seen"]] == [seen(60)]
    assert json.dumps(scores_of(everything).as_json())


def test_json_has_the_keys_that_others_read() -> None:
    written = Found([found("lift", 10, 12)], [LIFT], [seen(60)]).as_json()
    assert {"file", "agent", "start_ns", "end_ns", "decided_ns", "label", "confidence"} <= set(written["detections"][0])
    assert {"file", "agent", "start_ns", "end_ns", "label"} <= set(written["truths"][0])


def test_the_report_tells_every_score_and_the_actions_as_they_are_called() -> None:
    console = Console(record=True, width=100)
    console.print(continuous_report(scored([found("[b]lift", 10, 12)], [done("[b]lift", 10, 12), PUSH]), seconds=1.5))
    text = console.export_text()
    assert "1 of 2 actions found, 0 false detections in 0.9 min of background, 1.5 s" in text
    for told in ("events F1", "F1 at IoU 0.5", "recall at 1 false detection / min", "0.25 s", "[b]lift"):
        assert told in text
    assert "action points" not in text


def test_the_report_of_nothing_is_readable() -> None:
    console = Console(record=True, width=100)
    console.print(continuous_report(scores_of(Found()), seconds=0.1))
    assert "0 of 0 actions found" in console.export_text()
