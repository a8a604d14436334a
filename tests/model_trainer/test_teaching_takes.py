"""A take counts along, cuts its examples by itself, and lies in its set afterwards."""

from pathlib import Path

import pytest

from actum import keys
from actum.commands import Refusal, described
from actum.messages import Segment, Skeleton
from actum.recording import Recording
from repeating import FRAME_NS, Stream, rest
from teaching import GOGGLINGS, WAVES, Teacher, mark


@pytest.fixture
def teacher(tmp_path: Path) -> Teacher:
    made = Teacher(tmp_path)
    made.ask("create_set", set="kitchen")
    return made


def test_five_waves_are_counted_along_and_cut_by_themselves(teacher: Teacher) -> None:
    teacher.teach("wave", WAVES)
    examples = teacher.examples()
    assert [(each["label"], each["person"], each["origin"]) for each in examples] == [("wave", "anna", "cut")] * 5
    truths = Stream().repeat(WAVES).truths
    first_ns = Recording(teacher.folder / "sets/kitchen/take-0001.mcap")
    began_ns = next(iter(first_ns.messages((keys.SKELETON,)))).stamp_ns
    for example, (start, end) in zip(examples, truths, strict=True):
        assert abs(example["start_ns"] - began_ns - start * FRAME_NS) < 5e8
        assert abs(example["end_ns"] - began_ns - end * FRAME_NS) < 5e8
    counts = [told.recording.counted for told in teacher.told if told.recording is not None]
    assert sorted(set(counts)) == [0, 1, 2, 3, 4, 5] and counts == sorted(counts)


def test_it_tells_what_the_person_does(teacher: Teacher) -> None:
    teacher.teach("wave", WAVES)
    phases = [told.recording.phase for told in teacher.told if told.recording is not None]
    changes = [phase for phase, before in zip(phases, ["", *phases], strict=False) if phase != before]
    assert changes[0] == "waiting" and changes[-1] == "done"
    assert changes.count("moving") >= 4
    assert teacher.told[-1].recording is not None and teacher.told[-1].recording.people == 1


def test_the_recording_can_be_trained_on_as_any_other(teacher: Teacher) -> None:
    teacher.teach("wave", WAVES)
    recording = Recording(teacher.folder / "sets/kitchen/take-0001.mcap")
    marks = [message for message in recording.messages((keys.SEGMENT,)) if isinstance(message, Segment)]
    assert recording.person == "anna" and [m.kind for m in marks] == ["start", "end"] * 5
    assert {m.label for m in marks if m.kind == "start"} == {"wave"}


def test_stop_ends_a_take_and_says_that_some_are_missing(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", label="wave", person="anna", count=5)
    teacher.act(Stream().repeat(WAVES[:3]))
    reply = teacher.ask("stop")
    assert reply["examples"] == 3 and reply["doubts"] == ["3 of 5 repetitions found: record 2 more"]
    assert teacher.tick().recording.doubts == ["3 of 5 repetitions found: record 2 more"]


def test_a_discarded_take_leaves_nothing(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    teacher.act(Stream().repeat(WAVES[:2]))
    teacher.ask("discard")
    assert teacher.examples() == [] and teacher.tick().recording is None
    assert not list(teacher.folder.rglob("*.mcap*"))


@pytest.mark.parametrize(
    ("stream", "why"),
    [
        (Stream(), "nobody was in view: stand where"),
        (Stream().then(rest(30)), "the movement was no larger than the noise of standing still: move further"),
        (Stream().then(rest(4)).repeat(WAVES[:1]), "no two movements were alike, so the 5 repetitions were not found"),
    ],
    ids=["nobody", "still", "one movement"],
)
def test_a_take_of_nothing_is_not_kept_and_says_why(teacher: Teacher, stream: Stream, why: str) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    if stream.parts:
        teacher.see(stream.skeletons(noise_m=0.008, first_ns=1))
    reply = teacher.ask("stop")
    assert reply["take"] is None and why in reply["doubts"][0]
    assert not list(teacher.folder.rglob("*.mcap*"))


def test_background_is_recorded_without_examples(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", kind="background", person="anna")
    teacher.act(Stream().repeat(GOGGLINGS).then(rest(6)))
    assert teacher.tick().recording.asked == 0
    assert teacher.ask("stop")["examples"] == 0
    listed = teacher.ask("list")["sets"][0]
    assert listed["actions"] == {} and listed["takes"][0]["kind"] == "background"
    assert listed["background_s"] == pytest.approx(listed["takes"][0]["duration_s"])


def test_marks_by_the_switch_win_over_what_is_cut(teacher: Teacher) -> None:
    stream = Stream().repeat(WAVES)
    skeletons = stream.skeletons(first_ns=10**9)
    (a, b), (c, d) = stream.truths[:2]
    teacher.ask("record", set="kitchen", label="wave", count=2)
    for index, skeleton in enumerate(skeletons):
        teacher.see([skeleton])
        teacher.see([mark("start", "one")] * (index == a) + [mark("end", "one")] * (index == b))
        teacher.see([mark("start", "two", skeletons[c].stamp_ns)] * (index == d) + [mark("end", "two")] * (index == d))
    assert [(each["origin"], each["start_ns"], each["end_ns"]) for each in teacher.examples()] == [
        ("manual", skeletons[a].stamp_ns, skeletons[b].stamp_ns),
        ("manual", skeletons[c].stamp_ns, skeletons[d].stamp_ns),
    ]


@pytest.mark.parametrize("origin", ["auto", "simulator", "replay"])
def test_marks_that_nobody_put_by_hand_do_not_count(teacher: Teacher, origin: str) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=5)
    skeletons = Stream().repeat(WAVES).then(rest(4)).skeletons(first_ns=10**9)
    teacher.see([*skeletons[:30], mark("start", "theirs", origin=origin), *skeletons[30:60]])
    teacher.see([mark("end", "theirs", origin=origin), *skeletons[60:]])
    assert [each["origin"] for each in teacher.examples()] == ["cut"] * 5


def test_redo_records_the_newest_take_anew_and_drops_the_old_one_then(teacher: Teacher) -> None:
    teacher.teach("goggles", GOGGLINGS)
    teacher.teach("wave", WAVES)
    before = [each["id"] for each in teacher.examples()]
    teacher.ask("redo_last", set="kitchen")
    assert [each["id"] for each in teacher.examples()] == before, "until the new one is there"
    teacher.act(Stream().repeat(WAVES).then(rest(4)))
    after = teacher.examples()
    assert [each["id"] for each in after[:5]] == before[:5]
    assert not {each["id"] for each in after[5:]} & set(before[5:])
    assert [(each["label"], each["person"]) for each in after[5:]] == [("wave", "anna")] * 5


@pytest.mark.parametrize("asked", [1, 5])
def test_a_late_start_after_stillness_is_no_example_and_the_take_ends_by_itself(teacher: Teacher, asked: int) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=asked)
    stream = Stream().then(rest(25)).repeat(WAVES[:asked])
    first_ns = 10**9
    teacher.see(stream.then(rest(4)).skeletons(noise_m=0.008, first_ns=first_ns))
    told = teacher.tick().recording
    assert told is not None and (told.phase, told.counted) == ("done", asked)
    for example, (start, _) in zip(teacher.examples(), stream.truths, strict=True):
        assert abs(example["start_ns"] - first_ns - start * FRAME_NS) < 5e8


def test_uncut_repetitions_of_a_take_that_was_stopped_are_no_background(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", label="wave", count=9)
    stream = Stream().repeat(WAVES[:3]).repeat(GOGGLINGS[:1])
    teacher.see(stream.skeletons(first_ns=10**9))
    assert teacher.ask("stop")["doubts"]
    bounds = [(each["start_ns"], each["end_ns"]) for each in teacher.examples()]
    assert 2 <= len(bounds) < 9
    frames = Recording(teacher.folder / "sets/kitchen/take-0001.mcap").messages((keys.SKELETON,))
    seen_ns = [frame.stamp_ns for frame in frames if isinstance(frame, Skeleton) and frame.agents]
    for first, last in stream.truths:
        middle_ns = 10**9 + (first + last) // 2 * FRAME_NS
        is_example = any(start <= middle_ns <= end for start, end in bounds)
        assert is_example or not any(abs(at_ns - middle_ns) < 4e8 for at_ns in seen_ns)


@pytest.mark.parametrize("end", ["discard", "stop"])
def test_an_example_that_is_not_recorded_anew_stays(teacher: Teacher, end: str) -> None:
    teacher.teach("wave", WAVES)
    before = teacher.examples()
    teacher.ask("redo_last", set="kitchen")
    teacher.ask(end)
    assert teacher.examples() == before


def test_one_thing_is_recorded_at_a_time(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    for command in ("record", "redo_last"):
        with pytest.raises(Refusal, match="a recording into the set kitchen is running: stop or discard this"):
            teacher.ask(command, set="kitchen", **({"label": "nod"} if command == "record" else {}))
    with pytest.raises(Refusal, match="a recording into the set kitchen is running"):
        teacher.ask("delete_set", set="kitchen")
    teacher.ask("discard")
    for command in ("stop", "discard"):
        with pytest.raises(Refusal, match="no recording is running: start a recording first"):
            teacher.ask(command)
    teacher.ask("delete_set", set="kitchen")


def test_what_is_recorded_needs_a_name_and_a_set(teacher: Teacher) -> None:
    with pytest.raises(Refusal, match="the action has no name"):
        teacher.ask("record", set="kitchen")
    with pytest.raises(Refusal, match=r"no set 'garden': use an existing set \(kitchen\)"):
        teacher.ask("record", set="garden", label="wave")
    with pytest.raises(Refusal, match="contains no recording of an action yet"):
        teacher.ask("redo_last", set="kitchen")


def test_the_state_is_told_with_each_change_but_not_too_often(teacher: Teacher) -> None:
    teacher.told.clear()
    teacher.tick(100)
    assert 9 <= len(teacher.told) <= 11, "each second"
    teacher.told.clear()
    teacher.ask("create_set", set="garden")
    teacher.tick(3)
    assert teacher.told and teacher.told[0].revision > 0
    teacher.told.clear()
    teacher.teach("wave", WAVES)
    assert len(teacher.told) < 5.5 * teacher.told[-1].recording.seconds


def test_a_take_is_lost_where_the_sensor_begins_anew_and_says_so(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", label="wave")
    frames = Stream().repeat(WAVES[:2]).skeletons(first_ns=10**12)
    teacher.see(frames)
    teacher.see([frames[0].model_copy(update={"session_id": "another", "stamp_ns": 5})])
    told = teacher.tick()
    assert told.recording is not None and told.recording.phase == "done"
    assert "restarted during the recording" in told.recording.doubts[0]
    assert teacher.trainer.counters.rejects["lost_take"] == 1
    assert teacher.examples() == [] and not list(teacher.folder.rglob("*.mcap*"))


def test_frames_that_come_late_or_twice_are_left_out(teacher: Teacher) -> None:
    teacher.ask("record", set="kitchen", kind="background")
    frames = Stream().repeat(WAVES[:2]).skeletons(first_ns=10**9)
    teacher.see([*frames[:50], frames[20], frames[49], *frames[50:]])
    teacher.ask("stop")
    stored = Recording(teacher.folder / "sets/kitchen/take-0001.mcap").messages((keys.SKELETON,))
    assert [each.stamp_ns for each in stored] == [each.stamp_ns for each in frames]


def test_every_command_says_what_it_does_and_what_each_of_its_fields_is(teacher: Teacher) -> None:
    for command in described(teacher.trainer.commands).commands:
        assert command.description.endswith("."), command.name
        for schema in (command.request, command.reply):
            for name, field in schema.get("properties", {}).items():
                assert field.get("description"), (command.name, name)


def test_a_take_of_too_many_frames_or_marks_ends_by_itself(teacher: Teacher, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("actum_examples.take_in_progress.MOST_FRAMES", 100)
    monkeypatch.setattr("actum_examples.take_in_progress.MOST_MARKED", 5)
    teacher.ask("record", set="kitchen", label="wave", person="anna", count=5)
    teacher.act(Stream().repeat(WAVES))
    assert teacher.tick().recording.phase == "done"
    teacher.ask("record", set="kitchen", label="wave", person="anna", count=5)
    teacher.act(Stream().then(rest(1)))
    teacher.see(mark("start", f"m{i}") for i in range(5))
    assert teacher.tick().recording.phase == "done"
