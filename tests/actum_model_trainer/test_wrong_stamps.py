"""Marks and frames with wrong stamps: refused at the door with the reason, skipped and counted in recordings."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from actum.messages import Segment, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum_examples.cutting.courses import recorded_courses
from actum_examples.take import read_take
from actum_model_trainer.evaluation import segment_labels
from actum_model_trainer.recorded_segments import classifier_input, closed_segments
from actum_model_trainer.sample_reading import samples_from
from actum_model_trainer.spotting.training_windows import training_windows
from model_trainer.film import films_of
from performers import mark as labelled
from performers import performance
from repeating import Stream, rest
from teaching import WAVES, Teacher, mark

NOW_NS = 1_790_000_000 * SECOND_NS
WRONG = (0, 1, 1_790_000_000, 2**62 - 2, NOW_NS - 3600 * SECOND_NS, NOW_NS + 3600 * SECOND_NS)


@pytest.fixture
def teacher(tmp_path: Path) -> Teacher:
    made = Teacher(tmp_path)
    made.ask("create_set", set="kitchen")
    return made


@pytest.fixture
def frames() -> list[Skeleton]:
    return Stream().repeat(WAVES[:2]).then(rest(4)).skeletons(first_ns=NOW_NS)


@pytest.mark.parametrize("stamp_ns", WRONG)
def test_a_mark_outside_of_the_take_is_refused_and_the_teacher_learns_why(
    teacher: Teacher, frames: list[Skeleton], stamp_ns: int
) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=5)
    teacher.see([*frames[:30], mark("start", "wrong", stamp_ns), *frames[30:60], mark("end", "wrong", stamp_ns + 1)])
    teacher.see([mark("start", "one"), *frames[60:90], mark("end", "one"), *frames[90:95]])
    told = teacher.ask("stop")
    counters = teacher.trainer.counters
    assert counters.rejects["refused_mark"] == 2
    assert (
        "marks that were refused: 2. The last one" in told["doubts"][0]
        and told["doubts"] == teacher.tick().recording.doubts
    )
    (example,) = teacher.examples()
    assert (example["start_ns"], example["end_ns"]) == (frames[59].stamp_ns, frames[89].stamp_ns)
    assert teacher.ask("film", set="kitchen", example=example["id"])["stamps_ns"]


def test_a_mark_before_any_frame_and_an_end_that_bounds_nothing_are_refused(
    teacher: Teacher, frames: list[Skeleton]
) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=5)
    teacher.see([mark("start", "early"), *frames[:30], mark("end", "none"), mark("start", "one"), mark("end", "one")])
    assert teacher.trainer.counters.rejects["refused_mark"] == 3
    assert "before any frame" not in (teacher.trainer.counters.last_error or "")
    teacher.see([*frames[30:60], mark("end", "one"), mark("start", "open"), *frames[60:70]])
    doubts = teacher.ask("stop")["doubts"]
    assert any("the take has no end mark for them: 1" in doubt for doubt in doubts)
    assert [each["id"] for each in teacher.examples()] == ["take-0001/one"]


def test_an_end_far_from_its_start_is_refused(teacher: Teacher) -> None:
    frames = Stream().then(rest(70)).skeletons(first_ns=NOW_NS)
    teacher.ask("record", set="kitchen", label="wave", count=5)
    teacher.see([*frames[:1], mark("start", "one"), *frames[1:], mark("end", "one")])
    assert "end it after at most 60 s" in (teacher.trainer.counters.last_error or "")
    teacher.ask("discard")


def test_an_example_lasts_no_longer_than_the_frames(teacher: Teacher, frames: list[Skeleton]) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=5)
    teacher.see(
        [*frames[:10], mark("start", "one"), *frames[10:60], mark("end", "one", frames[59].stamp_ns + SECOND_NS)]
    )
    teacher.ask("stop")
    assert teacher.examples()[0]["end_ns"] == frames[59].stamp_ns


@pytest.mark.parametrize("stamp_ns", [2**62 - 1, NOW_NS + 7200 * SECOND_NS])
def test_a_leap_of_the_sensors_clock_loses_the_take_and_says_so(
    teacher: Teacher, frames: list[Skeleton], stamp_ns: int
) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    teacher.see([*frames[:60], frames[60].model_copy(update={"stamp_ns": stamp_ns})])
    assert "stamps jumped" in teacher.tick().recording.doubts[0]
    assert teacher.trainer.counters.rejects["lost_take"] == 1 and teacher.examples() == []


def test_a_clock_that_runs_backwards_for_long_loses_the_take(teacher: Teacher, frames: list[Skeleton]) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    back = [each.model_copy(update={"stamp_ns": each.stamp_ns - 3600 * SECOND_NS}) for each in frames[60:70]]
    teacher.see([*frames[:60], *back])
    assert "restarted during the recording" in teacher.tick().recording.doubts[0]


@pytest.mark.thorough
@pytest.mark.parametrize("stamp_ns", WRONG)
@pytest.mark.parametrize("kinds", [("start",), ("end",), ("start", "end")])
def test_a_recorded_mark_outside_of_the_frames_is_skipped_and_counted(
    record: Callable[..., Recording], stamp_ns: int, kinds: tuple[str, ...]
) -> None:
    skeletons, marks = performance(["lift", "swing"], 1.0, seed=1)
    skeletons, marks = later(skeletons), later(marks)
    wrong = [labelled(kind, stamp_ns + (kind == "end"), "wrong", "wave") for kind in kinds]
    recording = record("one", *skeletons, *marks, *wrong)
    closed = closed_segments(classifier_input(recording, "kinect0"))
    assert recording.skipped["mark_outside_frames"] == len(kinds)
    assert [each.segment_id for each in closed if each.reason is None] == list(segment_labels(recording, "kinect0"))
    assert set(films_of(recording, None)) == {each.segment_id for each in marks}
    assert len(samples_from([recording]).usable) == 2 and samples_from([recording]).unusable == []
    take = read_take(recording)
    assert "mark_outside_frames" in take.doubts[-1] and take.background_s < 600
    assert recorded_courses(recording, "kinect0")


def test_marks_of_a_recording_without_frames_are_all_there(record: Callable[..., Recording]) -> None:
    recording = record("marks", labelled("start", 0, "one", "wave"), labelled("end", 2**62 - 1, "one"))
    assert len(list(recording.messages())) == 2 and not recording.skipped


@pytest.mark.parametrize("stamp_ns", [0, 2**62 - 1])
def test_a_recorded_frame_with_a_wrong_stamp_costs_neither_time_nor_memory(
    record: Callable[..., Recording], stamp_ns: int
) -> None:
    skeletons, marks = performance(["lift", "swing"], 1.0, seed=1)
    skeletons, marks = later(skeletons), later(marks)
    wrong = skeletons[0].model_copy(update={"stamp_ns": stamp_ns, "seq": None})
    recording = record("one", *([wrong] if not stamp_ns else []), *skeletons, *marks, *([wrong] if stamp_ns else []))
    samples = samples_from([recording])
    assert len(samples.usable) == 2
    for stream in samples.streams:
        windows = training_windows(stream, ["lift"], np.array([1.0, 2.0]), np.random.default_rng(0))
        assert len(windows.frames) < 100 * len(stream.stamps_ns)
    assert Recording(recording.path).truncated is False


def later(messages: list) -> list[Skeleton | Segment]:
    return [each.model_copy(update={"stamp_ns": each.stamp_ns + NOW_NS}) for each in messages]
