"""Which segments are shown of each action, and how reliable the confidence of all answers is."""

from dataclasses import replace

import numpy as np
import pytest

from actum_model_inspector.answered import AnsweredSegment, headline
from actum_model_inspector.reliability_diagram import bins, calibration_error, labelled_answers, reliability_picture
from actum_model_inspector.segment_selection import examples, file_names, mistake_name, mistakes
from som_classifier.model import Recognition

PUSH = Recognition("push", 0.8, {"push": 0.9, "pull": 0.1}, "right_arm", np.zeros((1, 2)))


def said(confidence: float, label: str | None = "push", answer: str = "push") -> AnsweredSegment:
    return AnsweredSegment("a.mcap", "1", "s", label, [], replace(PUSH, label=answer, confidence=confidence), 0)


REJECTED = replace(said(0.5), recognition=None, action_unit=None)


def test_the_example_of_an_action_is_its_right_answer_of_median_confidence() -> None:
    right = [said(confidence) for confidence in (0.9, 0.5, 0.7)]
    assert examples([*right, said(0.95, "push", "pull")])["push"] is right[2]


def test_where_none_is_right_the_surest_wrong_one_is_the_example() -> None:
    wrong = [said(0.3, "pull"), said(0.6, "pull")]
    assert examples(wrong)["pull"] is wrong[1]


def test_without_labels_the_answers_are_the_examples_and_nothing_is_a_mistake() -> None:
    unlabelled = said(0.4, None)
    assert examples([unlabelled, REJECTED]) == {"push": unlabelled}
    assert mistakes([unlabelled, REJECTED]) == []


def test_mistakes_are_the_surest_wrong_answers_one_for_each_pair() -> None:
    sure, unsure, other = said(0.9, "pull"), said(0.8, "pull"), said(0.7, "lift")
    assert mistakes([other, unsure, said(1.0), sure]) == [sure, other]


def test_file_names_are_plain_and_no_two_are_alike() -> None:
    names = file_names(["Pick up", "pick-up", "pick/up", "…", "押す", mistake_name(1), "x" * 300])
    assert list(names.values()) == ["pick-up", "pick-up-2", "pick-up-3", "action", "押す", "mistake-1-2", "x" * 50]


@pytest.mark.parametrize(
    ("answered", "words"),
    [
        (said(0.93), "push: 0 frames, recognised push 0.93"),
        (said(0.93, "pull"), "pull: 0 frames, taken for push 0.93"),
        (said(0.93, None), "an action without a label: 0 frames, recognised push 0.93"),
        (REJECTED, "push: 0 frames, rejected"),
    ],
)
def test_a_headline_says_what_was_done_and_what_it_was_taken_for(answered: AnsweredSegment, words: str) -> None:
    assert headline(answered) == words


def test_answers_are_sorted_by_tenths_of_confidence() -> None:
    found = bins([said(0.12), said(0.18, "pull"), said(0.95), said(1.0)])
    assert [(each.low, each.n, each.correct) for each in found] == [(0.1, 2, 1), (0.9, 2, 2)]
    assert found[0].confidence == pytest.approx(0.15)


def test_who_is_as_sure_as_right_has_no_calibration_error() -> None:
    assert calibration_error(bins([said(0.75), said(0.75), said(0.75), said(0.75, "pull")])) == pytest.approx(0)
    assert calibration_error(bins([said(1.0), said(1.0, "pull")])) == pytest.approx(0.5)


def test_only_what_has_label_and_answer_is_judged() -> None:
    both = said(0.5)
    assert labelled_answers([both, said(0.5, None), REJECTED]) == [both]


def test_too_few_answers_make_no_reliability_diagram() -> None:
    with pytest.raises(ValueError, match="at least 30"):
        reliability_picture([said(0.5)] * 29)
    assert reliability_picture([said(0.5)] * 30).axes
