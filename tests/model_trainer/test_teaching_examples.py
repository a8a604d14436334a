"""Sets and examples: names, listing, films, mending; and what is refused."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum import keys
from actum.commands import Refusal
from actum.messages import Skeleton
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_examples import edits
from actum_examples.take import read_take
from actum_model_trainer.sample_reading import samples_from, select
from model_trainer.names import checked_name
from teaching import GOGGLINGS, WAVES, Teacher


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which two actions were taught."""
    teacher = Teacher(tmp_path_factory.mktemp("taught"))
    teacher.ask("create_set", set="kitchen")
    teacher.teach("wave", WAVES)
    teacher.teach("goggles", GOGGLINGS, person="bert")
    return teacher.folder


def acting_hand(joints: np.ndarray) -> str:
    """Return the hand that rises by more than 0.5 m while the other one stays."""
    risen = {hand: np.ptp(joints[:, INDEX[f"{hand}_hand"], 1]) for hand in ("left", "right")}
    assert max(risen.values()) > 0.5 and min(risen.values()) < 0.1
    return max(risen, key=lambda hand: risen[hand])


def first(teacher: Teacher) -> dict:
    return teacher.examples()[0]


@pytest.mark.parametrize("name", ["kitchen 2", "Küche", "a", "3.5_b-c", "台所", "x" * 64])
def test_names_of_letters_digits_and_some_signs_are_taken(name: str) -> None:
    assert checked_name(name) == name


TRICKS = (
    "",
    ".",
    "..",
    "../x",
    "a/b",
    "a\\b",
    "/etc",
    " a",
    "a ",
    "a.",
    ".hidden",
    "-rf",
    "a\0b",
    "a\nb",
    "<b>",
    "a:b",
)
TOO_LONG = ("x" * 65, "台" * 70, "a" * 10_000_000)


@pytest.mark.parametrize("name", [*TRICKS, "a*", "~", "$HOME", *TOO_LONG], ids=lambda name: repr(name[:8]))
def test_path_tricks_markup_and_long_names_are_refused(name: str, tmp_path: Path) -> None:
    teacher = Teacher(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    for command, fields in (("create_set", {}), ("delete_set", {}), ("examples", {}), ("train", {})):
        with pytest.raises(Refusal):
            teacher.ask(command, set=name, **fields)
    with pytest.raises(Refusal):
        teacher.ask("upload", name=name, offset=0, data="", last=True)
    assert sorted(tmp_path.rglob("*")) == before


@given(st.text(max_size=70))
def test_whatever_is_taken_is_a_file_name_and_nothing_more(name: str) -> None:
    try:
        taken = checked_name(name)
    except ValueError:
        return
    assert Path(taken).name == taken and (Path("/folder") / taken).parent == Path("/folder")


def test_everything_is_listed_with_dates_and_people(teacher: Teacher) -> None:
    listed = teacher.ask("list")
    (kitchen,) = listed["sets"]
    assert kitchen["actions"] == {"goggles": 5, "wave": 5} and kitchen["people"] == ["anna", "bert"]
    assert kitchen["created"] == kitchen["takes"][0]["created"] == "2023-11-14T22:13:20Z"
    assert [take["examples"] for take in kitchen["takes"]] == [5, 5]
    assert kitchen["background_s"] > 5
    assert listed["models"] == [] and listed["active"] is None and listed["presets"][0] == "pyramid"


@pytest.mark.parametrize("name", ["con", "NUL", "com1.old", "Aux"])
def test_a_set_is_not_called_as_a_device_of_windows_but_an_action_may_be(teacher: Teacher, name: str) -> None:
    with pytest.raises(Refusal, match="is reserved for a device on Windows"):
        teacher.ask("create_set", set=name)
    with pytest.raises(Refusal, match="is reserved for a device on Windows"):
        teacher.ask("rename_set", set="kitchen", name=name)
    teacher.ask("relabel", set="kitchen", example=teacher.examples()[0]["id"], label=name)
    assert name in teacher.ask("list")["sets"][0]["actions"]


@pytest.mark.parametrize(
    ("label", "why"),
    [
        ("idle", "'idle' cannot be the name of an action, because the model would report it whenever"),
        ("Background", "'Background' cannot be the name of an action"),
        ("none", "'none' cannot be the name of an action, because it labels what looks like an action and is"),
        ("unknown", "'unknown' cannot be the name of an action"),
    ],
)
def test_no_action_is_called_as_what_is_none(teacher: Teacher, label: str, why: str) -> None:
    example = teacher.examples()[0]["id"]
    with pytest.raises(Refusal, match=f"^{why}"):
        teacher.ask("record", set="kitchen", label=label)
    with pytest.raises(
        Refusal, match=r"use another name\. To record people who do none of the actions, record background instead$"
    ):
        teacher.ask("relabel", set="kitchen", example=example, label=label)
    with pytest.raises(Refusal, match=f"^{why}"):
        teacher.ask("import_video", set="kitchen", upload="clip", label=label)
    teacher.ask("record", set="kitchen", kind="background")
    teacher.ask("discard")


def test_a_name_that_is_refused_is_refused_in_a_sentence_without_the_command_or_the_field(teacher: Teacher) -> None:
    rule = "use letters, digits, spaces, '_', '-' and '.', begin with a letter or digit"
    for name in ("../x", "a/b", "<b>", ".hidden", "end "):
        with pytest.raises(Refusal, match=f"^{re.escape(repr(name))} cannot be a name: {rule}"):
            teacher.ask("create_set", set=name)
    with pytest.raises(Refusal, match="^the name is empty: enter a name$"):
        teacher.ask("create_set", set="")
    with pytest.raises(
        Refusal, match=r"^the name has 65 characters \(65 bytes in UTF-8\): use at most 64 characters and 200 bytes$"
    ):
        teacher.ask("create_set", set="x" * 65)


def test_a_set_is_a_folder_that_can_be_copied_renamed_and_deleted(teacher: Teacher) -> None:
    shutil.copytree(teacher.folder / "sets" / "kitchen", teacher.folder / "sets" / "garden")
    assert [each["name"] for each in teacher.ask("list")["sets"]] == ["garden", "kitchen"]
    with pytest.raises(Refusal, match="there is already a set 'garden'"):
        teacher.ask("rename_set", set="kitchen", name="garden")
    with pytest.raises(Refusal, match="there is already a set 'garden'"):
        teacher.ask("create_set", set="GARDEN")
    teacher.ask("delete_set", set="garden")
    teacher.ask("rename_set", set="kitchen", name="Kitchen")
    teacher.ask("rename_set", set="Kitchen", name="Küche")
    assert [each["name"] for each in teacher.ask("list")["sets"]] == ["Küche"]
    assert len(teacher.examples("Küche")) == 10


@pytest.mark.parametrize("name", ["kitchen (copy)", "Ku\u0308che", "my sets' best!"])
def test_a_copied_set_can_be_used_and_renamed_whatever_its_folder_is_called(teacher: Teacher, name: str) -> None:
    shutil.copytree(teacher.folder / "sets" / "kitchen", teacher.folder / "sets" / name)
    (listed,) = [each["name"] for each in teacher.ask("list")["sets"] if each["name"] != "kitchen"]
    assert len(teacher.examples(listed)) == 10
    teacher.teach("nod", WAVES[:2], name=listed)
    assert teacher.ask("train", set=listed)["set"] == listed
    teacher.ask("cancel", job="job-1")
    teacher.ask("rename_set", set=listed, name="garden")
    assert len(teacher.examples("garden")) == 12
    teacher.ask("delete_set", set="garden")
    assert [each["name"] for each in teacher.ask("list")["sets"]] == ["kitchen"]


def test_an_action_that_another_program_named_is_deleted_whatever_it_is_called(teacher: Teacher) -> None:
    take = teacher.folder / "sets/kitchen/take-0001.mcap"
    edits.relabel(taken := read_take(Recording(take)), taken.examples[0], "pick & place/left")
    teacher.ask("delete_action", set="kitchen", label="pick & place/left")
    assert len(teacher.examples()) == 9


def test_a_damaged_file_in_a_set_is_named_and_the_others_are_there(teacher: Teacher) -> None:
    (teacher.folder / "sets/kitchen/take-0001.mcap").write_bytes(b"no recording")
    (kitchen,) = teacher.ask("list")["sets"]
    assert "take-0001.mcap: the file is not an MCAP file" in kitchen["unreadable"][0]
    assert kitchen["actions"] == {"goggles": 5}


def test_a_take_that_breaks_off_is_told_because_its_examples_may_be_lost(teacher: Teacher) -> None:
    take = teacher.folder / "sets/kitchen/take-0001.mcap"
    take.write_bytes(take.read_bytes()[: -(take.stat().st_size // 2)])
    (kitchen,) = teacher.ask("list")["sets"]
    assert kitchen["actions"] == {"goggles": 5}
    assert kitchen["unreadable"] == [
        f"{take}: the recording breaks off, and its examples may be lost; record or import the recording again"
    ]


def test_a_film_shows_fifteen_bodies_a_second(teacher: Teacher) -> None:
    example = first(teacher)
    film = teacher.ask("film", set="kitchen", example=example["id"])
    stamps_ns = np.array(film["stamps_ns"])
    assert (np.diff(stamps_ns) > 6e7).all() and (stamps_ns >= example["start_ns"]).all()
    joints = np.array(film["joints"])
    assert joints.shape == (len(stamps_ns), 15, 3)
    assert acting_hand(joints) == "right"
    assert film["trace"] is None


def test_a_mirrored_example_is_done_by_the_other_hand_and_twice_is_as_before(teacher: Teacher) -> None:
    example = first(teacher)["id"]
    before = np.array(teacher.ask("film", set="kitchen", example=example)["joints"])
    teacher.ask("mirror", set="kitchen", example=example)
    assert [each["mirrored"] for each in teacher.examples()][:2] == [True, False]
    mirrored = np.array(teacher.ask("film", set="kitchen", example=example)["joints"])
    assert acting_hand(mirrored) == "left"
    teacher.ask("mirror", set="kitchen", example=example)
    after = np.array(teacher.ask("film", set="kitchen", example=example)["joints"])
    assert np.allclose(before, after, atol=2e-3) and not first(teacher)["mirrored"]


def test_relabelled_and_trimmed_examples_are_stored_so(teacher: Teacher) -> None:
    example = first(teacher)
    teacher.ask("relabel", set="kitchen", example=example["id"], label="greet")
    start_ns, end_ns = example["start_ns"] + 10**8, example["end_ns"] - 10**8
    teacher.ask("trim", set="kitchen", example=example["id"], start_ns=start_ns, end_ns=end_ns)
    changed = first(teacher)
    assert (changed["label"], changed["start_ns"], changed["end_ns"]) == ("greet", start_ns, end_ns)
    assert changed["id"] == example["id"] and len(teacher.examples()) == 10
    samples = samples_from(select([teacher.folder / "sets"])).usable
    assert sorted({sample.label for sample in samples}) == ["goggles", "greet", "wave"]


def test_bounds_that_cannot_be_are_refused(teacher: Teacher) -> None:
    one, two = teacher.examples()[:2]

    def trim(start_ns: int, end_ns: int) -> None:
        teacher.ask("trim", set="kitchen", example=one["id"], start_ns=start_ns, end_ns=end_ns)

    with pytest.raises(Refusal, match=r"at least 0\.1 s"):
        trim(one["end_ns"], one["start_ns"])
    with pytest.raises(Refusal, match="overlap the segment cut-2"):
        trim(one["start_ns"], two["start_ns"] + 1)
    with pytest.raises(Refusal, match="the recording has frames only from 0 to"):
        trim(0, one["end_ns"])
    assert first(teacher) == one


def test_a_deleted_example_is_not_learnt_as_background(teacher: Teacher) -> None:
    example = first(teacher)
    teacher.ask("delete", set="kitchen", example=example["id"])
    assert len(teacher.examples()) == 9
    recording = Recording(teacher.folder / "sets/kitchen/take-0001.mcap")
    within = [
        message
        for message in recording.messages((keys.SKELETON,))
        if isinstance(message, Skeleton) and example["start_ns"] <= message.stamp_ns <= example["end_ns"]
    ]
    assert within and not any(skeleton.agents for skeleton in within)


def test_an_action_is_deleted_with_the_takes_that_hold_nothing_else(teacher: Teacher) -> None:
    teacher.ask("delete_action", set="kitchen", label="wave")
    assert {each["label"] for each in teacher.examples()} == {"goggles"}
    assert [path.name for path in (teacher.folder / "sets/kitchen").glob("*.mcap")] == ["take-0002.mcap"]
    with pytest.raises(Refusal, match="no example of 'wave'"):
        teacher.ask("delete_action", set="kitchen", label="wave")


def test_of_an_action_that_cannot_be_deleted_whole_it_is_told_how_much_is_left(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    last = teacher.examples()[-1]
    teacher.ask("relabel", set="kitchen", example=last["id"], label="wave")
    before = teacher.tick(20).revision

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(Refusal, match="No space left on device; the examples in 1 of 2 recordings were not deleted"):
        teacher.ask("delete_action", set="kitchen", label="wave")
    assert [each["id"] for each in teacher.examples() if each["label"] == "wave"] == [last["id"]]
    assert teacher.tick(20).revision > before, "or pages go on showing what is deleted"


@pytest.mark.parametrize("example", ["take-0001/none", "nothing", "../take-0001/cut-1", "x" * 401])
def test_examples_that_are_not_there_are_refused(teacher: Teacher, example: str) -> None:
    for command in ("film", "delete", "mirror"):
        with pytest.raises(Refusal):
            teacher.ask(command, set="kitchen", example=example)


def test_the_revision_rises_with_each_change_and_stays_with_each_refusal(teacher: Teacher) -> None:
    before = teacher.tick().revision
    with pytest.raises(Refusal):
        teacher.ask("delete", set="kitchen", example="none")
    teacher.ask("film", set="kitchen", example=first(teacher)["id"])
    assert teacher.tick(20).revision == before
    teacher.ask("relabel", set="kitchen", example=first(teacher)["id"], label="greet")
    assert teacher.tick().revision == before + 1


def test_the_revision_rises_where_another_program_has_changed_a_set(teacher: Teacher) -> None:
    before = teacher.tick(20).revision
    assert teacher.tick(20).revision == before
    take = read_take(Recording(teacher.folder / "sets/kitchen/take-0001.mcap"))
    edits.relabel(take, take.examples[0], "greet")
    relabelled = teacher.tick(20).revision
    assert relabelled > before, "or pages go on showing what was there"
    shutil.copytree(teacher.folder / "sets" / "kitchen", teacher.folder / "sets" / "garden")
    assert teacher.tick(20).revision > relabelled


def test_a_file_that_cannot_be_written_changes_nothing(teacher: Teacher, monkeypatch: pytest.MonkeyPatch) -> None:
    example = first(teacher)

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(Refusal, match="No space left on device; nothing was changed"):
        teacher.ask("relabel", set="kitchen", example=example["id"], label="greet")
    monkeypatch.undo()
    assert first(teacher) == example
    assert not list(teacher.folder.rglob("*.part"))
