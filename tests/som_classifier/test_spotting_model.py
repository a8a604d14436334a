"""What windows are worth, which thresholds stand for how many false alarms, and what a model's file brings back."""

import json
from dataclasses import replace
from math import log
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.node import SECOND_NS
from som_classifier.model_loading import ModelError, load_model
from som_classifier.pyramid_model import PyramidModel
from som_classifier.segmentation import NO_BACKGROUND, Segmentation
from som_classifier.spotting.spotted import SpottingOptions
from som_classifier.spotting.spotting_model import (
    NONE_BELOW_IOU,
    WHOLE_FROM_IOU,
    CompletenessHeads,
    PyramidSpottingMetadata,
    SpottingModel,
    completeness_of_iou,
    iou_of_completeness,
)
from unmarked import spotting_model

METADATA = PyramidSpottingMetadata(
    interval_s=0.1, lag_s=0.2, overlap=0.15, duration_weight=0.1, window_durations_s=[0.5, 1.0, 2.0],
    log_duration_means=[log(0.5), log(2.0)], log_duration_sds=[0.2, 0.5], thresholds=[0.3, 0.5, 0.7, 0.9],
    false_alarms_per_min=[4.0, 1.5, 1.5, 0.5], recalls=[1.0, 0.9, 0.8, 0.5], precisions=[0.5, 0.7, 0.8, 1.0],
    threshold=0.7, probability=[6.0, -3.0], background_s=60.0,
)  # fmt: skip
HEADS = CompletenessHeads(np.zeros((3, 2), np.float32), np.zeros(2, np.float32))
LEARNED = SpottingModel(HEADS, METADATA)


def test_an_overlap_counts_as_nothing_up_to_one_bound_and_as_the_whole_from_the_other() -> None:
    iou = np.array([0.0, NONE_BELOW_IOU, (NONE_BELOW_IOU + WHOLE_FROM_IOU) / 2, WHOLE_FROM_IOU, 1.0])
    np.testing.assert_allclose(completeness_of_iou(iou), [0.0, 0.0, 0.5, 1.0, 1.0])


@given(iou=st.floats(NONE_BELOW_IOU, WHOLE_FROM_IOU))
def test_between_them_the_overlap_is_found_again(iou: float) -> None:
    assert iou_of_completeness(float(completeness_of_iou(np.array(iou)))) == pytest.approx(iou)


@given(answer=st.floats(-10, 10))
def test_whatever_a_head_answers_what_is_done_is_a_share(answer: float) -> None:
    assert 0.0 <= iou_of_completeness(answer) <= 1.0


def test_heads_answer_by_their_axes_and_offsets() -> None:
    heads = CompletenessHeads(np.array([[1, 0], [0, 2], [1, 1]], np.float32), np.array([0.5, -1], np.float32))
    assert heads.completeness(np.array([[1, 2, 3]], np.float32)).tolist() == [[4.5, 6.0]]


def test_a_usual_duration_costs_nothing_and_an_unusual_one_up_to_a_limit() -> None:
    durations_s = np.array([0.5, 2.0, 1000.0, 0.0])
    judged = LEARNED.judged(np.zeros(4, np.int64), (durations_s * SECOND_NS).astype(np.int64), np.full((4, 2), 0.8))
    assert judged.actions[:2].tolist() == [0, 1]
    assert judged.worth[:3] == pytest.approx([0.8, 0.8, 0.8 - 0.1 * 4.5])
    assert judged.durations == pytest.approx(durations_s / 1.25)


@given(
    duration_s=st.floats(0.1, 5.0), answers=st.tuples(st.floats(-1, 2), st.floats(-1, 2)), threshold=st.floats(0.1, 0.9)
)
def test_more_completeness_is_worth_more_and_a_higher_threshold_leaves_less(
    duration_s: float, answers: tuple[float, float], threshold: float
) -> None:
    def gain(answer: float, threshold: float) -> float:
        ends_ns = np.array([round(duration_s * SECOND_NS)])
        judged = LEARNED.judged(np.zeros(1, np.int64), ends_ns, np.array([[answer, -10.0]]))
        return float(judged.gainful(threshold)[1].gains.sum())

    assert gain(max(answers), threshold) >= gain(min(answers), threshold)
    more, less = gain(answers[0], threshold), gain(answers[0], threshold + 0.05)
    assert less < more or less == more == 0


def test_a_candidate_is_a_windows_likeliest_action_where_it_is_worth_anything() -> None:
    starts_ns = [3 * SECOND_NS // 2, 0, 0]
    found = LEARNED.candidates(starts_ns, 2 * SECOND_NS, [[0.9, 0.8], [0.9, 0.8], [0.4, 0.4]], 0.5)
    assert [(each.start_ns, each.action, each.completeness) for each in found] == [(starts_ns[0], 0, 0.9), (0, 1, 0.8)]
    assert all(each.gain > 0 for each in found)


ANSWERS = st.sampled_from([-0.5, 0.3, 0.6, 0.7]) | st.floats(-1, 2, width=32)


@given(
    windows=st.lists(st.tuples(st.integers(1, 5 * SECOND_NS), ANSWERS, ANSWERS), min_size=1, max_size=8),
    threshold=st.sampled_from([0.3, 0.6]) | st.floats(0.1, 0.9),
)
def test_the_few_windows_of_a_decision_are_judged_as_many_are_in_training(
    windows: list[tuple[int, float, float]], threshold: float
) -> None:
    now_ns = 9 * SECOND_NS
    starts_ns, answers = [now_ns - each[0] for each in windows], [each[1:] for each in windows]
    judged = LEARNED.judged(np.array(starts_ns), np.full(len(windows), now_ns), np.array(answers, np.float32))
    gainful, spans = judged.gainful(threshold)
    found = LEARNED.candidates(starts_ns, now_ns, np.array(answers, np.float32).tolist(), threshold)
    assert [each.action for each in found] == judged.actions[gainful].tolist()
    assert [each.completeness for each in found] == judged.completeness[gainful].tolist()
    assert [(each.start_ns, each.end_ns, each.gain) for each in found] == list(
        zip(spans.starts_ns, spans.ends_ns, spans.gains, strict=True)
    )


def test_a_threshold_is_the_lowest_with_no_more_false_alarms_than_asked_for() -> None:
    asked = [10.0, 4.0, 3.9, 1.5, 1.0, 0.5, 0.4, 0.0]
    assert [METADATA.threshold_for(each) for each in asked] == [0.3, 0.3, 0.5, 0.5, 0.9, 0.9, 0.9, 0.9]
    assert METADATA.threshold_for(None) == 0.7


@given(rates=st.lists(st.floats(0, 20), min_size=4, max_size=4), asked=st.tuples(st.floats(0, 25), st.floats(0, 25)))
def test_who_bears_more_false_alarms_never_gets_a_higher_threshold(
    rates: list[float], asked: tuple[float, float]
) -> None:
    of = METADATA.model_copy(update={"false_alarms_per_min": sorted(rates, reverse=True)})
    assert of.threshold_for(max(asked)) <= of.threshold_for(min(asked))


def test_where_no_false_alarms_could_be_counted_the_chosen_threshold_stands() -> None:
    assert METADATA.model_copy(update={"false_alarms_per_min": []}).threshold_for(0.1) == 0.7


def test_a_precision_is_that_of_the_threshold_in_use_interpolated_between_those_it_was_counted_at() -> None:
    counted = METADATA.model_copy(update={"threshold": 0.6})
    assert [counted.precision_for(asked) for asked in (None, 4.0, 0.5)] == pytest.approx([0.75, 0.5, 1.0])


def test_a_probability_is_logistic() -> None:
    assert LEARNED.probability(0.5) == 0.5
    assert [round(LEARNED.probability(answer), 3) for answer in (0.0, 1.0)] == [0.047, 0.953]


def saved(folder: Path, **changes: object) -> Path:
    """A trained model's file with something of its search changed, or arrays where their names begin so."""
    model, path = spotting_model(), folder / "model.npz"
    model.save(path)
    with np.load(path) as file:
        contents = dict(file)
    metadata = json.loads(str(contents["metadata"]))
    of_arrays = {name: value for name, value in changes.items() if name.startswith("completeness_")}
    metadata["spotting"] |= {name: value for name, value in changes.items() if name not in of_arrays}
    contents |= {"metadata": np.array(json.dumps(metadata)), **of_arrays}
    np.savez(path, **{name: value for name, value in contents.items() if value is not None})
    return path


def test_a_file_brings_back_the_same_search(tmp_path: Path) -> None:
    model, loaded = spotting_model(), load_model(saved(tmp_path))
    assert isinstance(loaded, PyramidModel) and loaded.heads is not None and model.heads is not None
    assert loaded.id == model.id and loaded.metadata.spotting == model.metadata.spotting
    np.testing.assert_array_equal(loaded.heads.axes, model.heads.axes)
    np.testing.assert_array_equal(loaded.heads.offsets, model.heads.offsets)


def test_a_file_from_before_there_was_a_search_loads_and_cannot_search(tmp_path: Path) -> None:
    replace(
        spotting_model(), heads=None, metadata=spotting_model().metadata.model_copy(update={"spotting": None})
    ).save(tmp_path / "old.npz")
    with np.load(tmp_path / "old.npz") as file:
        contents = dict(file)
    metadata = json.loads(str(contents["metadata"]))
    assert metadata.pop("spotting") is None
    np.savez(tmp_path / "old.npz", **contents | {"metadata": np.array(json.dumps(metadata))})
    old = load_model(tmp_path / "old.npz")
    assert old.spotter(SpottingOptions()) is None and old.background_s is None


@pytest.mark.parametrize(
    "changes",
    [
        {"completeness_axes": None},
        {"completeness_offsets": None},
        {"completeness_axes": np.zeros((5, 3), np.float32)},
        {"completeness_offsets": np.zeros(2, np.float32)},
        {"completeness_offsets": np.zeros(3)},
        {"completeness_offsets": np.array([0, np.nan, 0], np.float32)},
        {"log_duration_means": [0.0]},
        {"log_duration_sds": [0.1] * 4},
        {"log_duration_sds": [0.1, 0.0, 0.1]},
        {"thresholds": []},
        {"thresholds": [0.3, 0.75, 0.6, 0.9]},
        {"false_alarms_per_min": [1.0]},
        {"precisions": []},
        {"precisions": [0.9]},
        {"precisions": [1.5] * 14},
        {"window_durations_s": []},
        {"window_durations_s": [1.0, 0.5]},
        {"window_durations_s": [1.0, 1e9]},
        {"lag_s": 1e9},
        {"interval_s": 0.0},
        {"probability": [1.0]},
        {"threshold": float("nan")},
        {"threshold": "high"},
    ],
    ids=str,
)
def test_a_file_whose_search_is_damaged_is_refused(tmp_path: Path, changes: dict[str, object]) -> None:
    path = saved(tmp_path, **changes)
    with pytest.raises(ModelError) as error:
        load_model(path)
    assert str(path) in str(error.value) and "actum train" in str(error.value)


def test_a_model_says_how_much_background_it_has_seen_and_the_service_tells_where_it_is_none(tmp_path: Path) -> None:
    seen = load_model(saved(tmp_path))
    assert seen.background_s is not None and 50 < seen.background_s < 70
    assert NO_BACKGROUND not in Segmentation().state(seen)
    none = load_model(saved(tmp_path, background_s=0.0))
    assert none.background_s == 0.0
    assert NO_BACKGROUND in Segmentation().state(none)
