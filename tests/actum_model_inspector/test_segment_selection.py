from dataclasses import replace

import numpy as np
import pytest

from actum_model_inspector.answered import AnsweredSegment, headline
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
