"""The answers that processes which share a sensor hear from each other."""

import time

import pytest

from actum.codec import encode
from actum.messages import Message
from actum.runtime import resuming
from actum.runtime.journal import WrittenAnswer
from actum.runtime.resuming import KEPT_S, HeardAnswers
from events import event
from scenes import action


def heard_of(answers: HeardAnswers, message: Message, ago_s: float = 0.0) -> None:
    answers.hear(WrittenAnswer(time.time_ns() - round(ago_s * 1e9), encode(message)), message)


def test_only_what_another_process_has_put_is_answered_elsewhere() -> None:
    answers, own, others = HeardAnswers(), action("push"), action("push").model_copy(update={"segment_id": "other"})
    answers.add(encode(own))
    heard_of(answers, own)
    heard_of(answers, others)
    assert not answers.is_answered_elsewhere(own)
    assert answers.is_answered_elsewhere(others)
    assert answers.is_answered_elsewhere(others.model_copy(update={"valid": False, "reason": "frames lost"}))
    assert not answers.is_answered_elsewhere(others.model_copy(update={"session_id": "the next one"}))


def test_a_partial_action_is_answered_by_nobody() -> None:
    answers, final = HeardAnswers(), action("push")
    heard_of(answers, final)
    assert not answers.is_answered_elsewhere(final.model_copy(update={"final": False}))


def test_answers_keep_the_time_at_which_they_were_given_and_are_forgotten_by_it() -> None:
    answers = HeardAnswers()
    for number, ago_s in enumerate((KEPT_S + 1.0, KEPT_S - 5.0, 0.0)):
        heard_of(answers, action("push").model_copy(update={"segment_id": str(number)}), ago_s)
    kept = answers.answers
    assert [round(each.age_s) for each in kept] == [round(KEPT_S - 5.0), 0]


def test_no_more_than_so_many_are_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resuming, "MOST_HEARD", 3)
    answers = HeardAnswers()
    made = [action("push").model_copy(update={"segment_id": str(number)}) for number in range(5)]
    for each in made:
        heard_of(answers, each)
    assert len(answers.answers) == 3
    assert [answers.is_answered_elsewhere(each) for each in made] == [False, False, True, True, True]


def test_events_count_as_answers() -> None:
    answers, told = HeardAnswers(), event("s1", "push the cup")
    heard_of(answers, told)
    assert answers.is_answered_elsewhere(told)
