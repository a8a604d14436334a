"""An evaluation counts the final answers of the classifier's own node."""

import json
from collections.abc import Callable
from math import sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from actum.messages import Action
from actum.node import replay
from actum.recording import Recording
from actum_model_trainer.evaluation import Evaluation, Prediction, evaluate, wilson_interval
from actum_model_trainer.recorded_segments import classifier_input
from actum_model_trainer.report import confusion, report, summary
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from people import FRAME_NS, skeleton
from performers import HAND_PATHS, TINY, TINY_OF_EACH_KIND, TINY_PAPER, mark, performance
from som_classifier.node import SomClassifier
from som_classifier.presets import Preset

Record = Callable[..., Recording]
each_preset = pytest.mark.parametrize("preset", TINY_OF_EACH_KIND, ids=lambda preset: preset.name)

FIVE = Evaluation(
    (
        Prediction("a.mcap", "1", "push", "push", 0.9, unknown=False),
        Prediction("a.mcap", "2", "push", "pull", 0.5, unknown=True),
        Prediction("a.mcap", "3", "push", None),
        Prediction("b.mcap", "1", "lift", "lift", 1.0, unknown=False),
        Prediction("b.mcap", "2", "lift", "lift", 0.8, unknown=False),
    )
)
WITHOUT_CONFIDENCE = Evaluation(tuple(Prediction(p.file, p.segment_id, p.label, p.predicted) for p in FIVE.predictions))


def test_rejections_count_as_wrong() -> None:
    assert (FIVE.n, FIVE.correct, FIVE.accuracy) == (5, 3, 3 / 5)
    push = FIVE.per_class["push"]
    assert (push.n, push.correct, push.rejected, push.accuracy) == (3, 1, 1, 1 / 3)


def test_confusion_counts_done_by_answered() -> None:
    assert FIVE.labels == ["lift", "pull", "push"]
    assert FIVE.confusion == [[2, 0, 0], [0, 0, 0], [0, 1, 1]]


def test_an_action_is_told_with_its_mean_confidence_and_how_much_was_unknown() -> None:
    push, lift, pull = (FIVE.per_class[label] for label in ("push", "lift", "pull"))
    assert (push.confidence, push.unknown) == (pytest.approx(0.7), 1 / 2)
    assert (lift.confidence, lift.unknown) == (pytest.approx(0.9), 0)
    assert (pull.confidence, pull.unknown) == (None, None)
    assert sum(FIVE.unknown_decisions) == 1
    assert len(FIVE.unknown_decisions) == 4


def test_answers_that_tell_no_confidence_have_none_on_average() -> None:
    push = WITHOUT_CONFIDENCE.per_class["push"]
    assert (push.confidence, push.unknown, WITHOUT_CONFIDENCE.unknown_decisions) == (None, None, [])


def test_how_far_confidence_is_off_is_told_of_thirty_answers_and_not_of_fewer() -> None:
    right, wrong = (Prediction("a.mcap", "1", "push", answer, 0.75) for answer in ("push", "pull"))
    rejected = Prediction("a.mcap", "1", "push", None)
    assert Evaluation((right, wrong) * 15).calibration_error == pytest.approx(0.25)
    assert Evaluation((*(right, wrong) * 14, right, rejected, rejected)).calibration_error is None


def test_json_has_every_key_and_survives_a_round_trip() -> None:
    written = json.loads(json.dumps(FIVE.as_json()))
    assert list(written) == ["accuracy", "n", "calibration_error", "labels", "confusion", "per_class", "predictions"]
    rejected = {"predicted": None, "confidence": None, "unknown": None}
    assert written["predictions"][2] == {"file": "a.mcap", "segment_id": "3", "label": "push"} | rejected
    assert (written["predictions"][1]["confidence"], written["predictions"][1]["unknown"]) == (0.5, True)
    nothing = {"n": 0, "correct": 0, "rejected": 0, "accuracy": 0.0, "confidence": None, "unknown": None}
    assert written["per_class"]["pull"] == nothing


def test_nothing_to_answer_is_no_accuracy() -> None:
    assert (Evaluation(()).n, Evaluation(()).accuracy) == (0, 0.0)


@given(st.integers(2, 1000), st.data())
def test_wilson_bounds_are_where_the_share_is_1_96_deviations_off(n: int, data: st.DataObject) -> None:
    correct = data.draw(st.integers(1, n - 1))
    low, high = wilson_interval(correct, n)
    assert 0 < low < correct / n < high < 1
    for bound in (low, high):
        assert abs(correct / n - bound) == pytest.approx(1.959964 * sqrt(bound * (1 - bound) / n), rel=1e-4)


def test_wilson_at_the_edges_and_of_nothing() -> None:
    assert wilson_interval(0, 10) == pytest.approx((0.0, 1 - wilson_interval(10, 10)[0]))
    assert wilson_interval(10, 10)[1] == pytest.approx(1.0)
    assert wilson_interval(0, 0) == (0.0, 1.0)


@each_preset
def test_final_answers_are_compared_with_labels(
    three_people: list[Recording], samples: list[SegmentSample], preset: Preset
) -> None:
    model = train(samples, preset)
    evaluation = evaluate(model, three_people[:1])
    assert [p.label for p in evaluation.predictions] == [*HAND_PATHS] * 2
    assert [p.segment_id for p in evaluation.predictions] == ["0", "1", "2", "3", "4", "5"]
    assert evaluation.accuracy == 1.0


@pytest.mark.parametrize(("preset", "told"), [(TINY, True), (TINY_PAPER, False)])
def test_confidence_is_the_answers_own_and_unknown_is_told_where_the_model_can_tell(
    three_people: list[Recording], samples: list[SegmentSample], preset: Preset, told: bool
) -> None:
    model = train(samples, preset)
    final = [
        message
        for message in replay(SomClassifier(model), classifier_input(three_people[0], "kinect0"))
        if isinstance(message, Action) and message.final
    ]
    predictions = evaluate(model, three_people[:1]).predictions
    assert [p.confidence for p in predictions] == [action.confidence for action in final]
    assert [p.unknown for p in predictions] == [action.unknown if told else None for action in final]


def test_a_label_the_model_does_not_know_is_wrong(samples: list[SegmentSample], record: Record) -> None:
    model = train(samples, TINY)
    skeletons, marks = performance(["lift"])
    renamed = [m.model_copy(update={"label": m.label and "juggle"}) for m in marks]
    (prediction,) = evaluate(model, [record("new", *skeletons, *renamed)]).predictions
    assert (prediction.label, prediction.predicted, prediction.correct) == ("juggle", "lift", False)


def test_segments_that_cannot_be_answered_are_predicted_as_none(samples: list[SegmentSample], record: Record) -> None:
    model = train(samples, TINY)
    marks = [mark("start", 0, "x", "lift"), mark("end", 9 * FRAME_NS, "x"), mark("start", FRAME_NS, "y", "push")]
    nobody = [skeleton(i * FRAME_NS) for i in range(12)]
    evaluation = evaluate(model, [record("nobody", *nobody, *marks)])
    assert [(p.segment_id, p.predicted) for p in evaluation.predictions] == [("x", None), ("y", None)]
    assert {(p.confidence, p.unknown) for p in evaluation.predictions} == {(None, None)}


def shown(evaluation: Evaluation) -> str:
    console = Console(record=True, width=120)
    console.print(report(evaluation, seconds=1.25))
    return console.export_text()


def test_the_report_shows_accuracy_interval_classes_and_confusion() -> None:
    text = shown(FIVE)
    low, high = wilson_interval(3, 5)
    assert f"60.0% (3 of 5, 95 % interval {low:.1%} to {high:.1%})" in text
    assert "33.3%" in text
    assert "confusion" in text
    assert "1 of 4 answers told unknown" in text
    assert "ECE" not in text
    push = next(line for line in text.splitlines() if "push" in line).replace("│", " ").split()
    assert push == ["push", "3", "1", "1", "33.3%", "70.0%", "50.0%"]


def test_the_report_of_many_answers_tells_how_far_confidence_is_off() -> None:
    assert "confidence off by 0.200 on average (ECE)" in str(summary(Evaluation(FIVE.predictions * 10), seconds=1.0))


def test_the_report_of_answers_without_confidence_leaves_it_open() -> None:
    text = shown(WITHOUT_CONFIDENCE)
    push = next(line for line in text.splitlines() if "push" in line).replace("│", " ").split()
    assert push == ["push", "3", "1", "1", "33.3%", "-", "-"]
    assert "unknown," not in text


def test_no_mistake_is_lost_however_many_actions_there_are_and_however_long_their_names() -> None:
    console = Console(record=True, width=80)
    labels = [f"{number}_pick_up_the_cup_and_put_it_down_again_slowly_with_care" for number in range(10, 50)]
    answers = [None, *labels[:-1]]
    predictions = [Prediction("a.mcap", "1", *pair) for pair in zip(labels, answers, strict=True) for _ in range(140)]
    console.print(confusion(Evaluation(tuple(predictions))))
    text = console.export_text()
    assert text.count(" 140 ") == len(labels)
    assert text.count("(rejected)") == 1
    assert "48_pick" in text and "49_pick" in text


def test_the_report_of_right_answers_has_no_confusion() -> None:
    assert str(confusion(Evaluation((Prediction("a.mcap", "1", "push", "push"),)))) == "confusion: none"


@pytest.mark.parametrize("labels", [["reach [left]", "reach [right]"], ["reach [/left]", "b"]])
def test_the_report_shows_labels_as_they_are(labels: list[str]) -> None:
    predictions = tuple(Prediction("a.mcap", str(k), labels[k % 2], labels[0]) for k in range(4))
    assert all(shown(Evaluation(predictions)).count(label) == 2 for label in labels)
