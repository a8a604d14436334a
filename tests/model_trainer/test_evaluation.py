"""An evaluation counts the final answers of the classifier's own node."""

import json
from collections.abc import Callable
from math import sqrt

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from actum.recording import Recording
from model_trainer.evaluation import (
    Evaluation,
    Prediction,
    evaluate,
    leave_one_person_out,
    wilson_interval,
)
from model_trainer.report import confusion, report
from model_trainer.samples import samples_from
from model_trainer.training import TrainingError, train
from people import FRAME_NS, skeleton
from performers import HAND_PATHS, TINY, TINY_OF_EACH_KIND, TINY_PAPER, mark, performance
from som_classifier.model import Model
from som_classifier.presets import Preset

Record = Callable[..., Recording]
each_preset = pytest.mark.parametrize("preset", TINY_OF_EACH_KIND, ids=lambda preset: preset.name)

FIVE = Evaluation(
    (
        Prediction("a.mcap", "1", "push", "push"),
        Prediction("a.mcap", "2", "push", "pull"),
        Prediction("a.mcap", "3", "push", None),
        Prediction("b.mcap", "1", "lift", "lift"),
        Prediction("b.mcap", "2", "lift", "lift"),
    )
)


def test_rejections_count_as_wrong() -> None:
    assert (FIVE.n, FIVE.correct, FIVE.accuracy) == (5, 3, 3 / 5)
    push = FIVE.per_class["push"]
    assert (push.n, push.correct, push.rejected, push.accuracy) == (3, 1, 1, 1 / 3)


def test_confusion_counts_done_by_answered() -> None:
    assert FIVE.labels == ["lift", "pull", "push"]
    assert FIVE.confusion == [[2, 0, 0], [0, 0, 0], [0, 1, 1]]


def test_json_has_every_key_and_survives_a_round_trip() -> None:
    written = json.loads(json.dumps(FIVE.as_json()))
    assert list(written) == ["accuracy", "n", "labels", "confusion", "per_class", "predictions"]
    assert written["predictions"][2] == {"file": "a.mcap", "segment_id": "3", "label": "push", "predicted": None}
    assert written["per_class"]["pull"] == {"n": 0, "correct": 0, "rejected": 0, "accuracy": 0.0}


def test_nothing_to_answer_is_no_accuracy() -> None:
    assert (Evaluation(()).n, Evaluation(()).accuracy) == (0, 0.0)


@given(st.integers(2, 1000), st.data())
def test_wilson_bounds_are_where_the_share_is_1_96_deviations_off(n: int, data: st.DataObject) -> None:
    correct = data.draw(st.integers(1, n - 1))
    low, high = wilson_interval(correct, n)
    assert 0 < low < correct / n < high < 1
    for bound in (low, high):
        assert abs(correct / n - bound) == pytest.approx(1.959964 * sqrt(bound * (1 - bound) / n), rel=1e-4)


def test_wilson_at_the_edges() -> None:
    assert wilson_interval(0, 10) == pytest.approx((0.0, 1 - wilson_interval(10, 10)[0]))
    assert wilson_interval(10, 10)[1] == pytest.approx(1.0)


def test_wilson_of_nothing_is_everything() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0)


@each_preset
def test_final_answers_are_compared_with_labels(three_people: list[Recording], preset: Preset) -> None:
    model = train(samples_from(three_people).usable, preset)
    evaluation = evaluate(model, three_people[:1])
    assert [p.label for p in evaluation.predictions] == [*HAND_PATHS] * 2
    assert [p.segment_id for p in evaluation.predictions] == ["0", "1", "2", "3", "4", "5"]
    assert evaluation.accuracy == 1.0


def test_a_label_the_model_does_not_know_is_wrong(three_people: list[Recording], record: Record) -> None:
    model = train(samples_from(three_people).usable, TINY)
    skeletons, marks = performance(["lift"])
    renamed = [m.model_copy(update={"label": m.label and "juggle"}) for m in marks]
    (prediction,) = evaluate(model, [record("new", *skeletons, *renamed)]).predictions
    assert (prediction.label, prediction.predicted, prediction.correct) == ("juggle", "lift", False)


def test_segments_that_cannot_be_answered_are_predicted_as_none(three_people: list[Recording], record: Record) -> None:
    model = train(samples_from(three_people).usable, TINY)
    marks = [mark("start", 0, "x", "lift"), mark("end", 9 * FRAME_NS, "x"), mark("start", FRAME_NS, "y", "push")]
    nobody = [skeleton(i * FRAME_NS) for i in range(12)]
    evaluation = evaluate(model, [record("nobody", *nobody, *marks)])
    assert [(p.segment_id, p.predicted) for p in evaluation.predictions] == [("x", None), ("y", None)]


@pytest.mark.parametrize(("preset", "first"), [(TINY, "map of postures"), (TINY_PAPER, "layer 1")])
def test_each_person_is_tested_once_on_a_model_of_the_others(
    three_people: list[Recording], preset: Preset, first: str
) -> None:
    stages: list[str] = []
    evaluation = leave_one_person_out(three_people, preset, progress=lambda stage, *_: stages.append(stage))
    assert evaluation.n == 3 * 2 * len(HAND_PATHS)
    assert evaluation.accuracy > 0.8
    assert [p.file for p in evaluation.predictions[::6]] == [str(recording.path) for recording in three_people]
    assert {stage for stage in stages if stage.endswith(first)} == {f"without {n}: {first}" for n in "123"}


@each_preset
def test_the_model_a_person_is_tested_on_is_made_of_the_others_samples_alone(
    three_people: list[Recording], preset: Preset, monkeypatch: pytest.MonkeyPatch
) -> None:
    tested: list[tuple[str, str]] = []

    def noted(model: Model, own: list[Recording], *_: object) -> Evaluation:
        tested.append((own[0].person, model.id))
        return Evaluation(())

    monkeypatch.setattr("model_trainer.evaluation.evaluate", noted)
    leave_one_person_out(three_people, preset, seed=3)
    of_others = {person: [r for r in three_people if r.person != person] for person in "123"}
    assert tested == [
        (person, train(samples_from(others).usable, preset, 3).id) for person, others in of_others.items()
    ]


def test_an_action_of_one_person_alone_is_never_recognised(three_people: list[Recording], record: Record) -> None:
    """The model that is tested on a person has seen nothing of them."""
    skeletons, marks = performance(["lift", "push"], seed=9)
    renamed = [m.model_copy(update={"label": m.label and "own action"}) for m in marks]
    recordings = [*three_people, record("person4", *skeletons, *renamed, person="4")]
    own = [p for p in leave_one_person_out(recordings, TINY).predictions if p.label == "own action"]
    assert [p.predicted for p in own] == ["lift", "push"]


def test_one_person_cannot_be_left_out(three_people: list[Recording]) -> None:
    with pytest.raises(TrainingError, match="at least two persons"):
        leave_one_person_out(three_people[:1], TINY)


def test_the_report_shows_accuracy_interval_classes_and_confusion() -> None:
    console = Console(record=True, width=120)
    console.print(report(FIVE, seconds=1.25))
    text = console.export_text()
    low, high = wilson_interval(3, 5)
    assert f"60.0% (3 of 5, 95 % interval {low:.1%} to {high:.1%})" in text
    assert "33.3%" in text
    assert "confusion" in text


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
    console = Console(record=True, width=120)
    predictions = tuple(Prediction("a.mcap", str(k), labels[k % 2], labels[0]) for k in range(4))
    console.print(report(Evaluation(predictions), seconds=1.0))
    assert all(console.export_text(clear=False).count(label) == 2 for label in labels)
