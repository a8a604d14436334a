"""What is measured of simulated people whom nobody marks: their actions, objects, idling, partial answers and cost."""

import pytest

pytest.importorskip("aeon", reason='the peers need pip install -e ".[benchmarks]"')

import json
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from benchmarks.continuous import four_people, idle
from benchmarks.continuous.bench import scores_table
from benchmarks.continuous.cost import told
from benchmarks.continuous.early import (
    Heard,
    Listener,
    Saying,
    completeness_errors,
    false_names,
    named,
    silent,
)
from benchmarks.continuous.four_people import cost_of, reachable_bytes
from benchmarks.continuous.idle import BETWEEN, Idled, watched_idling
from benchmarks.continuous.scene import Acted, acted_on
from benchmarks.continuous.sensitivity import ASKED_PER_MIN, classifier_at
from benchmarks.continuous.simulated import TAUGHT, TESTED, recording_of
from benchmarks.continuous.streams import stream_of

from actum.messages import Action
from actum.messages import Truth as SceneTruth
from actum_model_trainer.continuous.detections import Detection, Found, Stretch, Truth
from actum_model_trainer.continuous.watching import watched
from recognisers import tiny_model
from scene_simulator.everyday import FAMILIAR, Everyday
from scene_simulator.programme import Task
from scene_simulator.simulator import Simulator
from som_classifier.model import Model
from som_classifier.node import SomClassifier
from som_classifier.pyramid_model import PyramidModel
from som_classifier.spotting.spotted import SpottedSegment, Spotter, SpottingOptions
from spotters import beating, finding, spotting

pytestmark = pytest.mark.thorough

S = 1_000_000_000


def test_nobody_is_both_taught_and_tested() -> None:
    four = range(four_people.FIRST, four_people.FIRST + four_people.PEOPLE)
    everybody = [*TAUGHT, *TESTED, *idle.PEOPLE, *four]
    assert len(set(everybody)) == len(everybody)


def test_a_recorded_scene_holds_every_action_and_the_doings_between(tmp_path: Path) -> None:
    stream = stream_of(recording_of(3, 1, Everyday(FAMILIAR), tmp_path))
    assert stream.person == 3
    assert sorted(truth.label for truth in stream.truths) == ["lift", "point", "pull", "push", "put"]
    acting_ns = sum(truth.end_ns - truth.start_ns for truth in stream.truths)
    assert stream.seen[-1].end_ns - stream.seen[0].start_ns > 2 * acting_ns


def test_the_goals_stand_below_the_scores_they_are_for() -> None:
    found = Found([Detection("a", 1, 0, S, S, "lift", 0.9)], [Truth("a", 1, 0, S, "lift")], [Stretch("a", 1, 0, 9 * S)])
    lines = scores_table({"ours": found}, {"required": {"F1@.5": "≥ 0.70"}}).splitlines()
    header, goals = (line.strip("|").split("|") for line in (lines[0], lines[-1]))
    assert dict(zip(header, goals, strict=True)) == {
        column: " *required* " if column == header[0] else " ≥ 0.70 " if column == " F1@.5 " else "  "
        for column in header
    }


def saying(*labels: str | None, every_s: float = 0.1) -> list[Saying]:
    """Labels said one after the other; completeness rises by 0.1 each time."""
    return [Saying(round(i * every_s * S), label, None if label is None else i / 10) for i, label in enumerate(labels)]


def heard(said: list[Saying], *truths: tuple[float, float, str]) -> Heard:
    done = [Truth("a", 1, round(start * S), round(end * S), label) for start, end, label in truths]
    return Heard({1: said}, Found((), done, [Stretch("a", 1, 0, said[-1].stamp_ns)]))


def test_the_newest_partial_answer_counts_at_each_share_of_an_action() -> None:
    own = heard(saying(None, None, None, None, "push", "push", "lift", "lift", "lift", "lift", "lift"), (0, 1, "lift"))
    assert named(own, 0.3) == {"none": 1}
    assert named(own, 0.5) == {"another": 1}
    assert named(own, 0.8) == {"right": 1}


def test_what_was_said_before_an_action_does_not_count_for_it() -> None:
    assert named(heard(saying("lift", "lift", None, None, None), (0.2, 0.4, "lift")), 0.5) == {"none": 1}


def test_completeness_is_held_against_the_share_that_is_over() -> None:
    own = heard(saying("lift", "push", "lift", None, None), (0, 0.4, "lift"))
    assert completeness_errors(own) == pytest.approx([0.0, 0.5 - 0.2])


def test_a_false_name_is_counted_once_for_as_long_as_it_is_said() -> None:
    own = heard(saying("push", "push", None, "push", "lift", "lift", "lift"), (0.5, 0.6, "lift"))
    assert false_names(own) == 2
    assert silent(own) == (1, 5)


def test_a_listener_hears_what_a_classifier_says_with_each_posture(tmp_path: Path) -> None:
    recording = recording_of(3, 1, Everyday(FAMILIAR), tmp_path)
    listener = Listener(SomClassifier(beating(tiny_model())))
    found = watched(listener, recording, "kinect0", "a")
    said = listener.said[1]
    assert {each.label for each in said} == {None, "lift"}
    assert [each.stamp_ns for each in said] == sorted({each.stamp_ns for each in said})
    assert found.truths and found.detections


def test_the_setting_reaches_the_search() -> None:
    asked: list[float | None] = []

    def search(options: SpottingOptions) -> Spotter | None:
        asked.append(options.false_alarms_per_min)
        return None

    for rate in ASKED_PER_MIN:
        classifier_at(spotting(tiny_model(), search), rate)
        assert set(asked) == {rate}
        asked.clear()


def alarm(start_s: float, end_s: float, valid: bool = True) -> Action:
    return Action(
        stamp_ns=round(end_s * S),
        sensor="kinect0",
        valid=valid,
        reason=None if valid else "no person",
        agent=1,
        segment_id="a",
        start_ns=round(start_s * S),
        end_ns=round(end_s * S),
        final=True,
        action="lift" if valid else None,
        confidence=0.9 if valid else 0.0,
        activations={},
        part=None,
        frames=9,
        missed=0,
    )


def test_a_false_alarm_belongs_to_what_was_done_for_most_of_it() -> None:
    doings = {round(0.1 * i * S): BETWEEN if i < 8 else "drink" for i in range(30)}
    own = Idled(doings, {None: [alarm(0.5, 2.0), alarm(0.0, 0.9), alarm(1.0, 2.0, valid=False)]})
    assert own.alarms(None) == {"drink": 1, BETWEEN: 1}
    assert own.rejected(None) == 1


def test_an_idle_person_is_watched_at_every_sensitivity() -> None:
    own = watched_idling(beating(tiny_model()), 41, 0.2)
    seconds = len(own.doings) / 30
    assert seconds >= 12
    for asked in idle.ASKED_PER_MIN:
        assert 0 < own.alarms(asked).total() <= seconds
        assert own.rejected(asked) == 0


def test_the_object_of_an_action_that_was_found_is_held_against_the_truth() -> None:
    truths = [Truth("", 1, k * S, k * S + S // 2, "lift") for k in range(3)]
    detections = [Detection("", 1, k * S + 1, k * S + S // 2, 0, "lift", 0.9) for k in range(2)]
    own = Acted(Found(detections, truths), {1: 7, S + 1: None}, {0: 7, S: 8, 2 * S: 9})
    assert (own.objects.correct, own.objects.n) == (1, 2)


def calling_nothing_unknown(model: Model) -> Model:
    """Return the model with a verifier that takes all for true: the bodies of the scene are not those it knows."""
    assert isinstance(model, PyramidModel)
    return replace(model, verifier=replace(model.verifier, least_likeness=-1e9, least_found_likeness=-1e9))


def test_the_services_name_the_object_of_an_action_that_nobody_marked() -> None:
    simulator = Simulator([Task("lift", 2)], 20, 20, image_hz=10)
    start, end = (message for frame in simulator.frames() for message in frame if isinstance(message, SceneTruth))
    model = finding(calling_nothing_unknown(tiny_model()), SpottedSegment(start.stamp_ns, end.stamp_ns, "lift"))
    own = acted_on(model, Simulator([Task("lift", 2)], 20, 20, image_hz=10))
    assert [truth.label for truth in own.found.truths] == ["lift"]
    assert own.event_objects == own.true_objects == {start.stamp_ns: 2}


def test_one_of_four_is_answered_as_if_alone() -> None:
    cost = cost_of(beating(calling_nothing_unknown(tiny_model())), minutes=0.1, alone_minutes=0.1)
    assert [same for _, same in cost.alone] == [True] * four_people.PEOPLE
    assert cost.told == sum(count for count, _ in cost.alone) > 0
    assert cost.late.resident_mb > cost.late.classifier_mb > cost.late.spotters_mb > 0
    assert "| 4 | 6 | the same |" in "\n".join(told(json.loads(json.dumps(asdict(cost)))))
    assert cost.core > 0 and cost.posture_ms[0] <= cost.posture_ms[1] <= cost.posture_ms[2]


def test_memory_is_counted_once_with_what_a_view_keeps_alive() -> None:
    whole = np.zeros(1_000_000)
    seen: set[int] = set()
    assert reachable_bytes([whole[:1], whole], seen) == pytest.approx(8e6, rel=0.01)
    assert reachable_bytes([whole], seen) < 1000
