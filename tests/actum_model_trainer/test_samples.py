"""Training sees exactly the frames that the classifier would have used."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from actum.messages import Posture, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum.recording import Recording
from actum_model_trainer.sample_reading import samples_from, select
from people import FRAME_NS, skeleton
from performers import FRAMES, PAUSE_FRAMES, mark, performance
from pose_preprocessor.node import PosePreprocessor
from pose_preprocessor.settings import Settings as PoseSettings

Record = Callable[..., Recording]


def on_sensor(sensor: str, *messages: Skeleton | Segment) -> list[Skeleton | Segment]:
    return [message.model_copy(update={"sensor": sensor}) for message in messages]


def test_a_labelled_segment_is_a_sample_of_its_frames(record: Record) -> None:
    skeletons, marks = performance(["lift", "push"])
    recording = record("two", *skeletons, *marks, person="7")
    samples = samples_from([recording])
    assert [(s.label, s.segment_id, s.person) for s in samples.usable] == [("lift", "0", "7"), ("push", "1", "7")]
    assert {s.file for s in samples.usable} == {str(recording.path)}
    assert [s.joints.shape for s in samples.usable] == [(FRAMES, 15, 3)] * 2
    assert samples.unusable == []


def test_a_samples_frames_are_the_preprocessors(record: Record) -> None:
    skeletons, marks = performance(["lift", "push"])
    node = PosePreprocessor(PoseSettings.defaults())
    postures = [p for frame in skeletons for p in node.handle(frame) if isinstance(p, Posture)]
    first = FRAMES + PAUSE_FRAMES
    expected = postures[first : first + FRAMES]
    sample = samples_from([record("two", *skeletons, *marks)]).usable[1]
    assert sample.joints.tolist() == [posture.joints for posture in expected]
    assert sample.motion.tolist() == [posture.motion for posture in expected]


def test_a_sample_says_whether_its_distances_are_inferred(record: Record) -> None:
    skeletons, marks = performance(["lift"])
    inferred = [
        frame.model_copy(update={"agents": [one.model_copy(update={"depth_std_m": 0.1}) for one in frame.agents]})
        for frame in skeletons
    ]
    both = [record("measured", *skeletons, *marks), record("inferred", *inferred, *marks)]
    assert [sample.depth_inferred for sample in samples_from(both).usable] == [False, True]


def test_segments_without_a_label_are_no_samples(record: Record) -> None:
    skeletons, marks = performance(["lift"])
    unlabelled = [m.model_copy(update={"label": None}) for m in marks]
    samples = samples_from([record("unlabelled", *skeletons, *unlabelled)])
    assert (samples.usable, samples.unusable) == ([], [])


def test_unusable_frames_are_left_out(record: Record) -> None:
    skeletons, marks = performance(["lift"])
    for lost in (4, 5, 11):
        skeletons[lost] = skeleton(lost * FRAME_NS)
    assert len(samples_from([record("gaps", *skeletons, *marks)]).usable[0].joints) == FRAMES - 3


def test_unusable_segments_are_named_with_their_reason(record: Record) -> None:
    skeletons, _ = performance(["lift"])
    short = [mark("start", 2 * FRAME_NS, "short", "lift"), mark("end", 3 * FRAME_NS, "short")]
    empty = [mark("start", 0, "empty", "lift"), mark("end", 3 * FRAME_NS, "empty")]
    nobody = [skeleton(i * FRAME_NS) for i in range(10)]
    recordings = [record("short", *skeletons, *short), record("empty", *nobody, *empty)]
    unusable = samples_from(recordings).unusable
    assert [(u.segment_id, Path(u.file).name) for u in unusable] == [("short", "short.mcap"), ("empty", "empty.mcap")]
    assert [u.reason for u in unusable] == ["2 usable frames, at least 3 are needed", "no person"]


def test_every_sensor_of_a_recording_is_read(record: Record) -> None:
    first, second = (performance([action], seed=seed) for seed, action in enumerate(("lift", "push")))
    messages = [*on_sensor("left", *first[0], *first[1]), *on_sensor("right", *second[0], *second[1])]
    both = samples_from([record("both", *messages)]).usable
    alone = samples_from([record("alone", *second[0], *second[1])]).usable
    assert [sample.label for sample in both] == ["lift", "push"]
    np.testing.assert_array_equal(both[1].joints, alone[0].joints)


def test_progress_is_told_per_recording(three_people: list[Recording]) -> None:
    told: list[tuple[str, int, int]] = []
    samples_from(three_people, lambda *done: told.append(done))
    assert told == [("reading recordings", done, 3) for done in range(4)]


def test_recordings_are_selected_by_person_and_exclusion(tmp_path: Path) -> None:
    for name, person, fields in (("a", "1", {}), ("b", "2", {}), ("c", "1", {"excluded": "true"})):
        with Recorder(tmp_path / "deep" / f"{name}.mcap", person=person, source="test", **fields):
            pass

    def names(recordings: list[Recording]) -> list[str]:
        return [recording.path.stem for recording in recordings]

    assert names(select([tmp_path])) == ["a", "b"]
    assert names(select([tmp_path], people={"1"})) == ["a"]
    assert names(select([tmp_path], people={"1"}, with_excluded=True)) == ["a", "c"]
    assert names(select([tmp_path / "deep" / "b.mcap"])) == ["b"]


def test_a_recording_that_is_named_twice_counts_once(record: Record, tmp_path: Path) -> None:
    skeletons, marks = performance(["lift"])
    path = record("one", *skeletons, *marks).path
    assert [recording.path for recording in select([path, tmp_path, path])] == [path]


def test_a_recording_without_marks_is_background(record: Record) -> None:
    skeletons, _ = performance(["lift"])
    samples = samples_from([record("idle", *skeletons)])
    assert samples.segments == []
    assert [(len(stream.stamps_ns) > 0, stream.segments) for stream in samples.streams] == [(True, ())]


def test_an_absence_of_more_than_a_second_parts_a_stream(record: Record) -> None:
    skeletons, _ = performance(["lift", "push"])
    away = [frame for n, frame in enumerate(skeletons) if not 5 <= n < 5 + SECOND_NS // FRAME_NS + 2]
    (stream,) = samples_from([record("away", *away)]).streams
    (first, last), (back, end) = stream.runs_ns
    assert (first, end) == (skeletons[0].stamp_ns, skeletons[-1].stamp_ns)
    assert (last, back - last > SECOND_NS) == (skeletons[4].stamp_ns, True)
