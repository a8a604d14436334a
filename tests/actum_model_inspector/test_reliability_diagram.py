from dataclasses import replace

import numpy as np
import pytest

from actum_model_inspector.answered import AnsweredSegment
from actum_model_inspector.reliability_diagram import bins, calibration_error, labelled_answers, reliability_picture
from som_classifier.model import Recognition

PUSH = Recognition("push", 0.8, {"push": 0.9, "pull": 0.1}, "right_arm", np.zeros((1, 2)))


def said(confidence: float, label: str | None = "push", answer: str = "push") -> AnsweredSegment:
    return AnsweredSegment("a.mcap", "1", "s", label, [], replace(PUSH, label=answer, confidence=confidence), 0)


REJECTED = replace(said(0.5), recognition=None, action_unit=None)


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
