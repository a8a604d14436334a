"""Whole recordings are watched without their marks, which are what the answers are held against."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from actum.messages import AUTO, Action, Message, Posture, Segment
from actum.node import Counters, Tick
from actum.recording import Recording
from actum_model_trainer import continuous_cross_validation
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.scoring import scores_of
from actum_model_trainer.continuous.watching import NoSpotterError, found_by, views_of, watched
from actum_model_trainer.continuous_cross_validation import found_without_each, models_without, with_points
from actum_model_trainer.provenance import TrainingError
from people import FRAME_NS, STANDING, skeleton
from performers import TINY, mark, performance
from recognisers import tiny_model
from som_classifier.model import Model

Record = Callable[..., Recording]


class Finder:
    """A stand-in for the classifier, which answers what it is told to once a posture has a certain stamp."""

    name = "finder"
    inputs = ()

    def __init__(self, *answers: tuple[int, int, int, str], agent: int = 1, origin: str | None = AUTO) -> None:
        self.counters = Counters()
        self.heard: list[Message | Tick] = []
        self._answers = list(enumerate(answers))
        self._agent, self._origin = agent, origin

    def handle(self, message: Message | Tick) -> Iterable[Message]:
        self.heard.append(message)
        while isinstance(message, Posture) and self._answers and message.stamp_ns >= self._answers[0][1][2]:
            number, (start_ns, end_ns, _, label) = self._answers.pop(0)
            for kind, stamp_ns in (("start", start_ns), ("end", end_ns)):
                yield mark(kind, stamp_ns, f"auto-{number}").model_copy(
                    update={"origin": self._origin, "agent": self._agent}
                )
            yield self._action(f"auto-{number}", start_ns, end_ns, label)

    def _action(self, segment_id: str, start_ns: int, end_ns: int, label: str) -> Action:
        return Action(
            stamp_ns=end_ns, sensor="kinect0", valid=bool(label), reason=None if label else "too few frames",
            agent=self._agent, segment_id=segment_id, start_ns=start_ns, end_ns=end_ns, final=True,
            action=label or None, confidence=0.75, activations={}, part=None, frames=9, missed=0,
            familiarity=0.5,
        )  # fmt: skip


def swaying(frame: int) -> NDArray[np.float64]:
    """Somebody who stands, and sways as people do: frames that repeat each other are no postures."""
    return STANDING + np.array([0.002 * np.sin(frame), 0.0, 0.0])


def frames(*indices: int) -> list[int]:
    return [index * FRAME_NS for index in indices]


@pytest.fixture
def lifts(record: Record) -> Recording:
    """Three lifts of 20 frames, 5 frames between."""
    skeletons, marks = performance(["lift"] * 3)
    return record("lifts", *skeletons, *marks, action_points_ns=f'{{"1": {35 * FRAME_NS}}}')


def test_no_mark_reaches_the_classifier(lifts: Recording) -> None:
    finder = Finder()
    watched(finder, lifts, "kinect0", "a")
    assert not any(isinstance(message, Segment) for message in finder.heard)
    assert sum(isinstance(message, Posture) for message in finder.heard) == 75


def test_what_was_found_is_told_with_when_it_was_decided(lifts: Recording) -> None:
    start_ns, end_ns, decided_ns = frames(1, 18, 24)
    found = watched(Finder((start_ns, end_ns, decided_ns, "lift")), lifts, "kinect0", "a")
    assert found.detections == [Detection("a", 1, start_ns, end_ns, decided_ns, "lift", 0.75, familiarity=0.5)]


def test_what_was_marked_is_the_truth_with_its_action_point(lifts: Recording) -> None:
    found = watched(Finder(), lifts, "kinect0", "a")
    assert found.truths == [
        Truth("a", 1, 25 * k * FRAME_NS, (25 * k + 19) * FRAME_NS, "lift", 35 * FRAME_NS if k == 1 else None)
        for k in range(3)
    ]
    assert found.seen == [Stretch("a", 1, 0, 74 * FRAME_NS)]


def test_answers_to_marks_and_rejected_segments_are_no_detections(lifts: Recording) -> None:
    answer = (*frames(1, 18, 24), "lift")
    assert watched(Finder(answer, origin=None), lifts, "kinect0", "a").detections == []
    assert watched(Finder((*frames(1, 18, 24), "")), lifts, "kinect0", "a").detections == []


def test_a_labelled_mark_belongs_to_the_agent_it_names_or_to_the_nearest(record: Record) -> None:
    beside = np.array([1.0, 0.0, 2.0])
    skeletons = [skeleton(i * FRAME_NS, swaying(i) + beside, swaying(i)) for i in range(60)]
    named = mark("start", 20 * FRAME_NS, "named", "wave").model_copy(update={"agent": 1})
    marks = [named, mark("end", 30 * FRAME_NS, "named"), mark("start", 5 * FRAME_NS, "x", "push")]
    recording = record("two", *skeletons, *marks, mark("end", 15 * FRAME_NS, "x"))
    found = watched(Finder(), recording, "kinect0", "a")
    assert {(truth.label, truth.agent) for truth in found.truths} == {("wave", 1), ("push", 2)}
    assert {stretch.agent for stretch in found.seen} == {1, 2}


def test_marks_without_label_or_end_are_no_truths(record: Record) -> None:
    skeletons, _ = performance(["lift"])
    marks = [mark("start", 0, "a"), mark("end", 9 * FRAME_NS, "a"), mark("start", FRAME_NS, "b", "push")]
    assert watched(Finder(), record("odd", *skeletons, *marks), "kinect0", "a").truths == []


def test_time_in_which_nobody_is_seen_is_no_background(record: Record) -> None:
    gone = [skeleton(i * FRAME_NS) for i in range(30, 90)]
    before = [skeleton(i * FRAME_NS, swaying(i)) for i in range(30)]
    after = [skeleton(i * FRAME_NS, swaying(i)) for i in range(90, 120)]
    found = watched(Finder(), record("away", *before, *gone, *after), "kinect0", "a")
    assert [(s.start_ns, s.end_ns) for s in found.seen] == [tuple(frames(0, 29)), tuple(frames(90, 119))]


def test_a_model_that_cannot_find_actions_says_so_and_what_to_do(lifts: Recording) -> None:
    with pytest.raises(NoSpotterError, match="cannot find actions without marks: train it again"):
        found_by(tiny_model(), [lifts])


def test_each_person_is_watched_by_a_model_of_all_others(
    three_people: list[Recording], monkeypatch: pytest.MonkeyPatch
) -> None:
    def found(model: Model, recordings: list[Recording], *_: object) -> Found:
        tested.append((model.metadata.persons, [recording.person for recording in recordings]))
        own = recordings[0].person
        truth = Truth(own, 1, 0, 100, "lift", 10 * int(own))
        return Found([Detection(own, 1, 0, 200, 200, "lift", 0.9)], [truth], [Stretch(own, 1, 0, 1000)])

    tested: list[tuple[list[str], list[str]]] = []
    monkeypatch.setattr(continuous_cross_validation, "found_by", found)
    pooled = found_without_each(three_people, models_without(three_people, TINY))
    assert tested == [(["2", "3"], ["1"]), (["1", "3"], ["2"]), (["1", "2"], ["3"])]
    assert [d.point_ns for d in pooled.detections] == [60, 60, 40]
    assert scores_of(pooled).event.f1 == 1.0


def test_one_person_cannot_be_left_out(three_people: list[Recording]) -> None:
    with pytest.raises(TrainingError, match="at least two people"):
        found_without_each(three_people[:1], lambda *_: tiny_model())


def test_points_are_claimed_in_the_middle_where_none_are_known() -> None:
    own = Detection("a", 1, 100, 300, 400, "lift", 0.5)
    assert [d.point_ns for d in with_points([own, replace(own, label="push")], {"lift": 0.25})] == [150, 200]


def test_a_recording_without_marks_is_all_background(record: Record) -> None:
    idle = record("idle", *(skeleton(i * FRAME_NS, swaying(i)) for i in range(901)))
    assert views_of(idle) == [("kinect0", str(idle.path))]
    scores = scores_of(watched(Finder((*frames(1, 18, 24), "lift")), idle, "kinect0", "a"))
    assert scores.background_min == pytest.approx(0.5, rel=1e-3)
    assert scores.false_per_min == pytest.approx(2.0, rel=1e-3)
