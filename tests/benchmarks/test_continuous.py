"""The peers that find actions without marks decide causally, and their windows show what they are said to show."""

import pytest

pytest.importorskip("aeon", reason='the peers need pip install -e ".[benchmarks]"')

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from benchmarks.continuous.energy import Hysteresis, speeds_m_s
from benchmarks.continuous.methods import chosen, inner_folds
from benchmarks.continuous.never_trained import absent, answered, unlabelled
from benchmarks.continuous.rocket_windows import INSTANTS, Scored, decoded, resampled
from benchmarks.continuous.streams import Fold, Stream, folds, stream_of
from benchmarks.continuous.windows import NONE, durations_s, overlap_share, sliding, training_windows

from actum.recorder import write_recording
from actum.recording import Recording
from actum_dataset_importer.importing import import_msrc12_composed
from actum_dataset_importer.msrc12 import GESTURES
from actum_model_trainer.continuous.detections import Detection, Truth
from actum_model_trainer.sample_reading import select
from msrc12_streams import lifting, written
from performers import performance

pytestmark = pytest.mark.thorough

S = 1_000_000_000
CLASSES = [NONE, "lift", "push"]


def stream(folder: Path, person: int = 1, actions: tuple[str, ...] = ("lift", "push", "swing") * 3) -> Stream:
    skeletons, marks = performance([*actions], seed=person)
    write_recording(folder / f"{person}.mcap", [*skeletons, *marks], person=str(person), source="test")
    return stream_of(Recording(folder / f"{person}.mcap"))


@pytest.fixture
def own(tmp_path: Path) -> Stream:
    return stream(tmp_path)


def test_a_stream_holds_every_frame_and_truth(own: Stream) -> None:
    assert len(own.stamps_ns) == len(own.camera_m) == 9 * 25
    assert [truth.label for truth in own.truths] == ["lift", "push", "swing"] * 3
    assert [own.frames_of(truth) for truth in own.truths] == [(25 * k, 25 * k + 19) for k in range(9)]
    assert [sample.label for sample in own.taught.usable] == [truth.label for truth in own.truths]


def test_every_person_is_tested_once_and_never_learnt_from_meanwhile(tmp_path: Path) -> None:
    streams = [stream(tmp_path, person, ("lift",)) for person in range(1, 12)]
    tested = [[each.person for each in fold.test] for fold in folds(streams, streams)]
    assert tested == [[1, 6, 11], [2, 7], [3, 8], [4, 9], [5, 10]]
    for fold in folds(streams, streams):
        assert {each.person for each in fold.training} == set(range(1, 12)) - {each.person for each in fold.test}
    inner = inner_folds(streams)
    assert sorted(person for people in inner for person in people) == list(range(1, 12))


def test_windows_end_now_and_last_as_long_as_actions(own: Stream) -> None:
    lengths_s = durations_s([own])
    ends, starts = sliding(own, lengths_s)
    assert (starts <= ends[:, None]).all()
    step, duration = np.nonzero(starts >= 0)
    lasted_s = (own.stamps_ns[ends[step]] - own.stamps_ns[starts[step, duration]]) / S
    assert (lasted_s <= lengths_s[duration] + 1e-9).all()
    assert (lasted_s >= 0.8 * lengths_s[duration] - 1e-9).all()
    assert all(1 <= later - earlier <= 3 for earlier, later in pairwise(ends.tolist()))


def test_training_windows_show_what_they_are_said_to(own: Stream) -> None:
    windows = training_windows([own], np.random.default_rng(0))
    labels = [window.label for window in windows]
    assert labels.count("lift") >= 4
    for window in windows:
        iou, _ = overlap_share(own, window.first, window.last)
        assert iou < 0.5 if window.label == NONE else iou > 0.6


def test_a_window_is_resampled_from_its_first_to_its_last_frame(own: Stream) -> None:
    (window,) = resampled(own, np.array([10]), np.array([30]))
    assert window.shape == (45, INSTANTS)
    np.testing.assert_allclose(window[:, 0], own.camera_m[10].reshape(-1), atol=1e-6)
    np.testing.assert_allclose(window[:, -1], own.camera_m[30].reshape(-1), atol=1e-6)


def scored(own: Stream, *peaks: tuple[int, float, int]) -> Scored:
    """One window of ten frames ends at every third frame; at some of them something is seen."""
    ends = np.arange(12, len(own.stamps_ns), 3)
    margins = np.full((len(ends), 1), -1.0, dtype=np.float32)
    labels = np.zeros((len(ends), 1), dtype=np.intp)
    for end, margin, label in peaks:
        margins[list(ends).index(end)], labels[list(ends).index(end)] = margin, label
    return Scored(ends, ends[:, None] - 10, labels, margins)


def test_the_strongest_of_overlapping_windows_is_answered_once(own: Stream) -> None:
    (answer,) = decoded(own, scored(own, (30, 0.5, 1), (33, 0.9, 2), (36, 0.6, 1)), CLASSES, (0.2, 0.25))
    assert (answer.label, answer.confidence) == ("push", pytest.approx(0.9))
    assert (answer.start_ns, answer.end_ns) == (own.stamps_ns[23], own.stamps_ns[33])
    assert answer.decided_ns == own.stamps_ns[42]


def test_a_second_action_may_follow_and_the_unsure_is_no_answer(own: Stream) -> None:
    answers = decoded(own, scored(own, (30, 0.5, 1), (60, 0.3, 2), (90, 0.1, 1)), CLASSES, (0.2, 0.3))
    assert [answer.label for answer in answers] == ["lift", "push"]


@pytest.mark.parametrize("until", [45, 75, 150])
def test_a_prefix_of_a_stream_gives_the_same_answers(own: Stream, until: int) -> None:
    everything = scored(own, (30, 0.5, 1), (60, 0.9, 2), (63, 0.95, 1), (120, 0.4, 2))
    steps = int(np.searchsorted(everything.ends, until, side="right"))
    prefix = Scored(
        *(array[:steps] for array in (everything.ends, everything.starts, everything.labels, everything.margins))
    )
    whole = decoded(own, everything, CLASSES, (0.2, 0.3))
    known = [answer for answer in whole if answer.decided_ns <= own.stamps_ns[everything.ends[steps - 1]]]
    assert decoded(own, prefix, CLASSES, (0.2, 0.3))[: len(known)] == known


def test_energy_cuts_where_somebody_moves(own: Stream) -> None:
    segments, speeds = Hysteresis(0.1, 0.05, 0.1, 0.3, 0.1).segments(own), speeds_m_s(own, 0.1)
    assert segments
    for first, last, decided in segments:
        assert speeds[first] >= 0.1 and speeds[last] >= 0.05
        assert (speeds[last + 1 : decided + 1] < 0.05).all()
        assert own.stamps_ns[decided] - own.stamps_ns[last] >= 0.1 * S


def test_thresholds_are_chosen_by_f1_and_latency(own: Stream) -> None:
    def answers(after_s: float, each: Stream) -> list[Detection]:
        found = [
            each.detection(*each.frames_of(truth), each.frames_of(truth)[1], truth.label, 1.0) for truth in own.truths
        ]
        return [replace(one, decided_ns=one.end_ns + round(after_s * S)) for one in found]

    assert chosen([1.5, 0.3, 0.8], [own], answers) == 0.3
    assert chosen([1.5, 0.3], [own], lambda after_s, each: answers(after_s, each)[: 9 if after_s > 1 else 1]) == 1.5


def test_an_untrained_action_is_answered_where_a_false_detection_belongs_to_it() -> None:
    truths = [Truth("a", 1, 0, 10 * S, "kick"), Truth("a", 1, 20 * S, 30 * S, "lift")]
    inside = Detection("a", 1, 2 * S, 6 * S, 7 * S, "lift", 0.9)
    beside = Detection("a", 1, 9 * S, 19 * S, 20 * S, "lift", 0.9)
    right = Detection("a", 1, 20 * S, 30 * S, 31 * S, "lift", 0.9)
    assert answered([inside, right], truths, ["kick"]) == 1
    assert answered([beside, right], truths, ["kick"]) == 0
    assert answered([replace(inside, agent=2)], truths, ["kick"]) == 0


def test_an_unlabelled_action_is_still_done(own: Stream, tmp_path: Path) -> None:
    (without,) = unlabelled([own], ["lift"], tmp_path / "without")
    assert [truth.label for truth in without.truths] == ["push", "swing"] * 3
    np.testing.assert_array_equal(without.camera_m, own.camera_m)
    assert without.person == own.person


@pytest.mark.long
def test_an_absent_gesture_is_not_even_done(tmp_path: Path) -> None:
    """Streams are composed anew of the training people's other gestures."""
    for person in (1, 3):
        names = [f"P3_1_{gesture}_p{person:02d}" for gesture in range(1, 13)]
        written(tmp_path, {name: lifting(6) for name in names}, person)
    import_msrc12_composed(tmp_path, tmp_path / "out", lambda done, total: None)
    of_one, of_other = (
        [stream_of(recording) for recording in select([tmp_path / "out"], [person])] for person in ("1", "3")
    )
    learnt = absent(tmp_path, Fold(tuple(of_one), tuple(of_other)), GESTURES[:4], tmp_path / "absent")
    assert {each.person for each in learnt} == {1}
    assert {truth.label for each in learnt for truth in each.truths} == set(GESTURES[4:])
    assert sum(len(each.stamps_ns) for each in learnt) < 0.8 * sum(len(each.stamps_ns) for each in of_one)
