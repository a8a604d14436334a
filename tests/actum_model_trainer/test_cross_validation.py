"""Each person is tested on a model of all others, with the very answers of the live classifier."""

from collections.abc import Callable

import pytest

from actum.messages import Segment, Skeleton
from actum.recording import Recording
from actum_model_trainer.answering import encoded
from actum_model_trainer.cross_validation import leave_one_person_out
from actum_model_trainer.evaluation import evaluate
from actum_model_trainer.provenance import TrainingError
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.samples import SegmentSample
from actum_model_trainer.training import train
from people import FRAME_NS, skeleton
from performers import HAND_PATHS, TINY, TINY_OF_EACH_KIND, TINY_PAPER, mark, performance
from som_classifier.frames import Frame
from som_classifier.model import Model
from som_classifier.presets import Preset

Record = Callable[..., Recording]
each_preset = pytest.mark.parametrize("preset", TINY_OF_EACH_KIND, ids=lambda preset: preset.name)

LEFT_HAND = 5


def troublesome() -> list[Skeleton | Segment]:
    """A person with lost frames and joints, and with segments of every kind that a stream may have."""
    skeletons, marks = performance([*HAND_PATHS] * 2, seed=7)
    for i in (3, 30, 31, 60):
        skeletons[i] = skeleton(skeletons[i].stamp_ns)
    for i in range(80, 95):
        agent = skeletons[i].agents[0]
        joints = [None if joint == LEFT_HAND else place for joint, place in enumerate(agent.joints)]
        skeletons[i] = skeletons[i].model_copy(update={"agents": [agent.model_copy(update={"joints": joints})]})
    return [
        *skeletons,
        *marks,
        mark("start", 10 * FRAME_NS, "overlapping", "push"),
        mark("end", 40 * FRAME_NS, "overlapping"),
        mark("start", 50 * FRAME_NS, "short", "push"),
        mark("end", 51 * FRAME_NS, "short"),
        mark("start", 50 * FRAME_NS, "backwards", "lift"),
        mark("end", 49 * FRAME_NS, "backwards"),
        mark("start", 60 * FRAME_NS, "without a label"),
        mark("end", 70 * FRAME_NS, "without a label"),
        mark("start", 90 * FRAME_NS, "0", "push"),
        mark("start", 100 * FRAME_NS, "without an end", "push"),
    ]


def performed(*actions: str) -> list[Skeleton | Segment]:
    skeletons, marks = performance([*actions])
    return [*skeletons, *marks]


def seen_otherwise(messages: list[Skeleton | Segment]) -> list[Skeleton | Segment]:
    """The same ids, seen by another sensor which sees only one frame in three."""
    frames = [m for m in messages if isinstance(m, Skeleton)][::3]
    marks = [m for m in messages if isinstance(m, Segment)]
    return [message.model_copy(update={"sensor": "other"}) for message in (*frames, *marks)]


def later_session(messages: list[Skeleton | Segment]) -> list[Skeleton | Segment]:
    """The same ids used anew after the source started again."""
    later_ns = 20 * 10**9
    return [
        message.model_copy(
            update={"stamp_ns": (message.stamp_ns or 0) + later_ns}
            | ({"session_id": "second"} if isinstance(message, Skeleton) else {})
        )
        for message in messages
    ]


@each_preset
def test_answers_are_those_of_the_live_classifier_to_the_bit(
    three_people: list[Recording], record: Record, preset: Preset
) -> None:
    alone = troublesome()
    too_short = [mark("start", 5 * FRAME_NS, "2", "push"), mark("end", 6 * FRAME_NS, "2")]
    first, second = performed("lift", "push") + too_short, later_session(performed("swing", "lift", "push"))
    own = [
        record("troublesome", *alone, *seen_otherwise(alone), person="4"),
        record("two_sessions", *first, *second, person="4"),
    ]
    left_out = leave_one_person_out([*three_people, *own], preset).predictions
    live = evaluate(train(samples_from(three_people).usable, preset), own).predictions
    assert [p for p in left_out if p.file in {str(recording.path) for recording in own}] == list(live)
    assert sum(p.predicted is None for p in live) >= 6
    assert sum(p.predicted is not None for p in live) >= 14


@pytest.mark.parametrize(("preset", "first"), [(TINY, "maps of the first layer"), (TINY_PAPER, "layer 1")])
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

    def noted(model: Model, sample: SegmentSample) -> list[Frame]:
        tested.append((sample.person, model.id))
        return encoded(model, sample)

    monkeypatch.setattr("actum_model_trainer.cross_validation.encoded", noted)
    leave_one_person_out(three_people, preset, seed=3)
    of_others = {person: [r for r in three_people if r.person != person] for person in "123"}
    assert list(dict.fromkeys(tested)) == [
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
    with pytest.raises(TrainingError, match="at least two people"):
        leave_one_person_out(three_people[:1], TINY)
