"""Whole recordings are watched by the classifier's own node, whose model finds actions."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from actum.messages import AUTO
from actum.recording import Recording
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import found_by
from people import FRAME_NS
from performers import performance
from recognisers import tiny_model
from som_classifier.spotting.spotted import SpottedSegment
from spotters import LAG_NS, finding
from unmarked import recorded, scene, spotting_model

Record = Callable[..., Recording]
LIFTS = [SpottedSegment(25 * k * FRAME_NS, (25 * k + 19) * FRAME_NS, "lift") for k in range(3)]


@pytest.fixture
def lifts(record: Record) -> Recording:
    skeletons, marks = performance(["lift"] * 3)
    return record("lifts", *skeletons, *marks)


def test_segments_that_the_classifier_found_are_held_against_the_marks(lifts: Recording) -> None:
    found = found_by(finding(tiny_model(), *LIFTS[:2]), [lifts])
    assert [(d.start_ns, d.end_ns, d.agent, d.file) for d in found.detections] == [
        (each.start_ns, each.end_ns, 1, str(lifts.path)) for each in LIFTS[:2]
    ]
    assert all(0 <= d.decided_ns - d.end_ns - LAG_NS < FRAME_NS for d in found.detections)
    scores = scores_of(found)
    assert (scores.event.truths, scores.false_detections) == (3, 0)
    assert scores.event.recall == pytest.approx(2 / 3)
    assert scores.latency_s == pytest.approx((0.2, 0.2), abs=0.04)


def test_marks_that_a_classifier_put_while_recording_are_not_told_again(record: Record) -> None:
    skeletons, marks = performance(["lift"] * 3)
    own = [mark.model_copy(update={"origin": AUTO, "label": None}) for mark in marks]
    assert found_by(finding(tiny_model(), *LIFTS), [record("own", *skeletons, *own)]).truths == ()


def test_what_is_found_is_ranked_by_the_familiarity_that_is_published(tmp_path: Path) -> None:
    acted, model = scene(), spotting_model()
    recording = recorded(tmp_path, "scene", [*acted.skeletons(), *acted.marks()])
    searches = [
        model.metadata.spotting.model_copy(update={"precisions": [precision] * len(model.metadata.spotting.precisions)})
        for precision in (1.0, 0.5)
        if model.metadata.spotting is not None
    ]
    certain, half = (
        found_by(replace(model, metadata=model.metadata.model_copy(update={"spotting": each})), [recording]).detections
        for each in searches
    )
    assert len(certain) > 1
    assert [each.sureness for each in half] == pytest.approx([each.sureness / 2 for each in certain])
    assert all(each.sureness == each.familiarity for each in certain)
