"""An event that was told wrongly, or held back, becomes an example or a counterexample by one command."""

from pathlib import Path
from typing import Any

import pytest

from actum.codec import encode
from actum.commands import Refusal
from actum.messages import NONE, Skeleton
from actum.node import SECOND_NS
from actum.recorder import Recorder
from actum.recording import Recording
from actum_model_trainer.baseline import hand_paths
from actum_model_trainer.continuous.watching import found_by
from actum_model_trainer.evaluation import segment_labels
from actum_model_trainer.sample_reading import samples_from
from model_trainer import recent_frames
from model_trainer.folds import folds_of
from model_trainer.job import MODEL
from model_trainer.job_process import Ended
from model_trainer.recent_frames import SLACK_NS, RecentFrames
from recognisers import tiny_model
from repeating import FRAME_NS, Stream
from teaching import WAVES, Teacher
from unmarked import spotting_model


@pytest.fixture
def teacher(tmp_path: Path) -> Teacher:
    made = Teacher(tmp_path)
    made.ask("create_set", set="kitchen")
    made.act(Stream().repeat(WAVES))
    return made


def event(**fields: Any) -> dict[str, Any]:
    """The second of what the person did, two seconds long."""
    start_ns = 8 * SECOND_NS
    return {"set": "kitchen", "agent": 1, "start_ns": start_ns, "end_ns": start_ns + 2 * SECOND_NS} | fields


def take_of(teacher: Teacher, name: str) -> Recording:
    return Recording(teacher.folder / f"sets/kitchen/{name}.mcap")


def test_an_event_becomes_an_example_of_the_action_that_was_done(teacher: Teacher) -> None:
    reply = teacher.ask("correct", **event(label="wave", person="anna"))
    [example] = teacher.examples()
    assert reply["examples"] == 1 and (example["label"], example["person"]) == ("wave", "anna")
    [sample] = samples_from([take_of(teacher, reply["take"])]).usable
    assert sample.label == "wave" and sample.stamps_ns[0] - event()["start_ns"] in range(-SLACK_NS, FRAME_NS)
    assert event()["end_ns"] - sample.stamps_ns[-1] in range(-SLACK_NS, FRAME_NS)


def test_an_event_that_was_none_is_no_example_but_is_learnt_from(teacher: Teacher) -> None:
    reply = teacher.ask("correct", **event())
    samples = samples_from([take_of(teacher, reply["take"])])
    assert samples.usable == samples.unusable == []
    [stream] = samples.streams
    assert [label for *_, label in stream.segments] == [NONE] and stream.marked.truths == []
    [example] = teacher.examples()
    teacher.ask("delete", set="kitchen", example=example["id"])
    assert teacher.examples() == []


def test_only_the_frames_of_the_event_and_of_who_acted_are_stored(teacher: Teacher) -> None:
    reply = teacher.ask("correct", **event())
    frames = [m for m in take_of(teacher, reply["take"]).messages() if isinstance(m, Skeleton)]
    assert {each.agent for frame in frames for each in frame.agents} == {1}
    early_ns, late_ns = event()["start_ns"] - SLACK_NS, event()["end_ns"] + SLACK_NS
    assert all(early_ns <= frame.stamp_ns <= late_ns for frame in frames)
    with pytest.raises(Refusal, match="because only 0 frames of person 2 are still stored"):
        teacher.ask("correct", **event(agent=2))


def test_what_is_too_long_or_ends_before_it_starts_is_refused(teacher: Teacher) -> None:
    for end_ns in (event()["start_ns"], event()["start_ns"] + 61 * SECOND_NS):
        with pytest.raises(Refusal, match="end_ns has to be later than start_ns"):
            teacher.ask("correct", **event(end_ns=end_ns))


def test_a_set_that_is_not_there_is_refused_before_anything_is_written(teacher: Teacher) -> None:
    with pytest.raises(Refusal, match="there is no set 'garden'"):
        teacher.ask("correct", **event(set="garden"))
    assert not list((teacher.folder / "sets").rglob("*.mcap"))


@pytest.mark.parametrize("really", ["", "lift"])
def test_the_last_take_is_redone_though_events_were_corrected_after_it(teacher: Teacher, really: str) -> None:
    teacher.teach("wave", WAVES)
    teacher.ask("correct", **event(label=really))
    teacher.ask("redo_last", set="kitchen")
    recording = teacher.tick().recording
    assert recording is not None and (recording.label, recording.asked) == ("wave", 5)
    teacher.ask("discard")


def test_one_end_of_a_correction_is_trimmed_though_a_browsers_numbers_round_the_other(teacher: Teacher) -> None:
    teacher.ask("correct", **event(label="wave"))
    [example] = teacher.examples()
    rounded_ns, end_ns = example["start_ns"] - 256, example["end_ns"] - SECOND_NS // 2
    teacher.ask("trim", set="kitchen", example=example["id"], start_ns=rounded_ns, end_ns=end_ns)
    [trimmed] = teacher.examples()
    assert (trimmed["start_ns"], trimmed["end_ns"]) == (example["start_ns"], end_ns)


def test_an_event_is_corrected_once(teacher: Teacher) -> None:
    teacher.ask("correct", **event(label="wave"))
    for label in ("wave", ""):
        with pytest.raises(Refusal, match="so it is an example of 'wave' in the set kitchen"):
            teacher.ask("correct", **event(label=label))
    teacher.ask("correct", **event(start_ns=5 * SECOND_NS, end_ns=7 * SECOND_NS))
    assert len(teacher.examples()) == 2


def test_corrections_are_listed_until_a_model_is_in_use_whose_training_began_after_them(teacher: Teacher) -> None:
    def corrections(seconds: int) -> int:
        teacher.passed_ns += seconds * SECOND_NS
        [kitchen] = teacher.ask("list")["sets"]
        return kitchen["corrections"]

    teacher.ask("train", set="kitchen")
    end_training(teacher)
    teacher.teach("wave", WAVES[:2])
    assert corrections(1) == 0
    teacher.ask("correct", **event(label="wave"))
    assert corrections(1) == 1
    teacher.ask("train", set="kitchen")
    assert corrections(1) == 1
    teacher.ask("correct", **event(start_ns=5 * SECOND_NS, end_ns=7 * SECOND_NS))
    end_training(teacher)
    teacher.begin()
    assert corrections(0) == 1, "of the two, the one that was made during the training"


def end_training(teacher: Teacher) -> None:
    """Leave a model where the training leaves it, and put the model into use."""
    tiny_model().save(teacher.jobs[-1].arguments.folder / MODEL)
    teacher.jobs[-1].news = Ended({"model": tiny_model().id, "scores": {}})
    teacher.tick()
    teacher.ask("activate", model=tiny_model().id)


def test_a_correction_that_cannot_be_stored_leaves_nothing(teacher: Teacher, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Recorder, "write", full)
    with pytest.raises(Refusal, match="No space left on device; nothing was changed"):
        teacher.ask("correct", **event())
    assert not [path for path in (teacher.folder / "sets").rglob("*") if ".mcap" in path.name]


def test_what_was_none_is_no_action_for_tests_either(teacher: Teacher) -> None:
    teacher.teach("wave", WAVES)
    recording = take_of(teacher, teacher.ask("correct", **event())["take"])
    assert segment_labels(recording, "kinect0") == {}
    assert list(hand_paths([recording])) == []
    assert found_by(spotting_model(), [recording]).truths == ()


def test_a_counterexample_is_left_out_whole_or_not_at_all(teacher: Teacher) -> None:
    teacher.teach("wave", WAVES)
    recordings = [take_of(teacher, "take-0001"), take_of(teacher, teacher.ask("correct", **event())["take"])]
    samples = samples_from(recordings)
    [clip] = [stream for stream in samples.streams if stream.is_counterexample]
    kept = [len(fold.without(clip).stamps_ns) for fold in folds_of(samples)[1]]
    assert sorted(kept) == [0, len(clip.stamps_ns), len(clip.stamps_ns)]


def frames(count: int, first_ns: int = SECOND_NS, session: str = "one") -> list[Skeleton]:
    stream = Stream().repeat(WAVES)
    return [each.model_copy(update={"session_id": session}) for each in stream.skeletons(first_ns=first_ns)][:count]


def test_frames_are_kept_for_ten_minutes_and_within_their_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    recent, shown = RecentFrames(), frames(3)
    late = [each.model_copy(update={"stamp_ns": each.stamp_ns + 601 * SECOND_NS}) for each in shown]
    for frame in shown:
        recent.receive(frame)
    assert list(recent.of(1, 0, 2**61)) == shown
    for frame in late:
        recent.receive(frame)
    assert list(recent.of(1, 0, 2**61)) == late
    newest = late[-1].model_copy(update={"stamp_ns": late[-1].stamp_ns + 1})
    monkeypatch.setattr(recent_frames, "MOST_BYTES", len(encode(newest).payload))
    recent.receive(newest)
    assert list(recent.of(1, 0, 2**61)) == [newest]


def test_a_restart_of_the_sensor_forgets_what_was_before() -> None:
    recent = RecentFrames()
    for frame in [*frames(5), *(anew := frames(2, session="two"))]:
        recent.receive(frame)
    assert list(recent.of(1, 0, 2**61)) == anew
