"""What lies in the trainer's folder: a user's files stay, what cannot be read is told, what vanishes ends nothing."""

import base64
import json
import os
import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum import keys
from actum.atomic_file import claim
from actum.commands import Refusal
from actum.messages import segment_marks
from actum.recorder import Recorder
from actum.recording import Recording
from actum.run_folder import CLAIM
from model_trainer import upload_store
from model_trainer.job_process import Ended, Progressing
from model_trainer.set_store import SetStore
from model_trainer.stored_set import SetReader
from people import FRAME_NS
from performers import TINY_PAPER
from recognisers import tiny_model
from repeating import Stream
from teaching import WAVES, Teacher


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    teacher = Teacher(tmp_path_factory.mktemp("taught"))
    teacher.ask("create_set", set="kitchen")
    teacher.teach("wave", WAVES[:2])
    tiny_model().save(teacher.model)
    teacher.begin()
    return teacher.folder


def send(teacher: Teacher, name: str = "clip.mp4", data: bytes = b"video", offset: int = 0, last: bool = True) -> None:
    teacher.ask("upload", name=name, offset=offset, data=base64.b64encode(data).decode(), last=last)


MINE = [
    "uploads/holiday.mp4",
    "uploads/.hidden",
    "uploads/.clip.mp4.part",
    "uploads/album/one.jpg",
    "jobs/my.work/notes.txt",
    "jobs/.mine.part",
    "jobs/job-x.work/notes.txt",
    "models/.mine.part",
    "models/notes.json",
    "sets/.leaving-soon/notes.txt",
    "sets/kitchen/.mine.part",
    "sets/kitchen/notes.txt",
    "sets/drawer/notes.txt",
    "notes.txt",
]


@pytest.mark.parametrize("name", MINE)
def test_a_users_file_survives_each_start_and_each_command(teacher: Teacher, name: str) -> None:
    mine = teacher.folder / name
    mine.parent.mkdir(parents=True, exist_ok=True)
    mine.write_bytes(b"mine")
    teacher.begin()
    send(teacher)
    teacher.ask("list")
    teacher.ask("delete_action", set="kitchen", label="wave")
    teacher.ask("delete_set", set="kitchen")
    teacher.begin()
    assert mine.read_bytes() == b"mine"
    assert teacher.ask("list")["sets"] == []


def test_what_the_service_left_unfinished_goes_with_the_next_start(teacher: Teacher) -> None:
    send(teacher)
    left = [
        "uploads/.sent/killed/clip.mp4",
        "uploads/.sent/killed/.running",
        "jobs/job-7.work/model.npz",
        "sets/.making/1.mcap.part",
        "sets/.leaving-17/set.json",
        "sets/kitchen/.take-0001.mcap.01234567.part",
        "models/.0123456789ab.npz.89abcdef.part",
    ]
    for name in left:
        (teacher.folder / name).parent.mkdir(parents=True, exist_ok=True)
        (teacher.folder / name).write_bytes(b"left")
    teacher.begin()
    assert [name for name in left if (teacher.folder / name).exists()] == []
    assert not (teacher.folder / "sets/.leaving-17").exists()


def test_a_set_that_is_a_link_loses_the_link_alone(teacher: Teacher, tmp_path: Path) -> None:
    (teacher.folder / "sets/kitchen").rename(tmp_path / "elsewhere")
    (teacher.folder / "sets/kitchen").symlink_to(tmp_path / "elsewhere")
    teacher.ask("delete_set", set="kitchen")
    assert (tmp_path / "elsewhere/take-0001.mcap").exists() and teacher.ask("list")["sets"] == []


def test_a_file_in_the_place_of_the_model_in_use_is_not_overwritten(teacher: Teacher) -> None:
    (model,) = teacher.ask("list")["models"]
    teacher.model.write_text("my notes")
    with pytest.raises(Refusal, match="cannot be read as a model and would be overwritten: move this file"):
        teacher.ask("activate", model=model["id"])
    assert teacher.model.read_text() == "my notes"


def test_a_model_in_use_of_which_no_copy_was_kept_is_copied_before_it_is_replaced(teacher: Teacher) -> None:
    (used,) = (each["id"] for each in teacher.ask("list")["models"])
    tiny_model(TINY_PAPER).save(teacher.folder / "models/other.npz")
    (other,) = (each["id"] for each in teacher.ask("list")["models"] if each["id"] != used)
    (teacher.folder / f"models/{used}.npz").unlink()
    teacher.ask("activate", model=other)
    assert teacher.ask("undo") and teacher.tick(12).model == used


def test_a_model_of_which_no_copy_can_be_kept_is_not_said_to_be_of_the_set_of_the_one_before(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    about = next((teacher.folder / "models").glob("*.json"))
    about.write_text(json.dumps(json.loads(about.read_text()) | {"set": "kitchen"}))
    teacher.begin()
    assert teacher.tick(20).model_set == "kitchen"
    tiny_model(TINY_PAPER).save(teacher.model)
    monkeypatch.setattr("os.fsync", lambda _: (_ for _ in ()).throw(OSError(28, "No space left on device")))
    told = teacher.tick(20)
    assert teacher.trainer.counters.rejects["lost_model"] and told.model_set is None


def test_a_job_names_no_file_but_its_own(teacher: Teacher) -> None:
    teacher.ask("cancel", job=teacher.ask("train", set="kitchen")["id"])
    job = json.loads((teacher.folder / "jobs/job-1.json").read_text())
    forged = job | {"id": "../../mine", "state": "running"}
    (teacher.folder / "jobs/job-2.json").write_text(json.dumps(forged))
    teacher.begin()
    assert not (teacher.folder.parent / "mine.json").exists()
    assert teacher.ask("train", set="kitchen")["id"] == "job-3", "whatever job-2.json is, it stays"
    assert json.loads((teacher.folder / "jobs/job-2.json").read_text()) == forged


DEEP = b"[" * 100_000
NOTHINGS: dict[str, bytes] = {
    "empty": b"",
    "text": b"no JSON",
    "a list": b"[]",
    "a number": b'{"created": 5}',
    "no date": b'{"created": "yesterday"}',
    "null": b'{"created": null}',
    "bytes": b"\xff\xfe\x00",
    "a surrogate": b'{"created": "\\ud800"}',
    "deep": DEEP,
    "huge": b" " * 11_000_000,
    "infinite": b'{"created": 1e999}',
}


PLACED: dict[str, Callable[[Path], object]] = {
    "a directory": Path.mkdir,
    "a loop": lambda path: path.symlink_to(path),
    "a dangling link": lambda path: path.symlink_to(path.parent / "nowhere"),
    "a pipe": os.mkfifo,
    **{name: partial(Path.write_bytes, data=content) for name, content in NOTHINGS.items()},
}
FEW = ("a directory", "a loop", "a dangling link", "a pipe", "empty")


def attempt(teacher: Teacher, command: str, **fields: Any) -> None:
    try:
        teacher.ask(command, **fields)
    except Refusal as refusal:
        assert str(refusal)


def go_on(teacher: Teacher) -> None:
    """Ask for everything that reads the disk: nothing but a refusal may come of it."""
    some = {"set": "kitchen", "label": "wave", "example": "take-0001/cut-1", "model": "0" * 12, "job": "job-1"}
    some |= {"name": "garden", "start_ns": 10**9, "end_ns": 2 * 10**9, "upload": "clip.mp4"}
    names = ["list", "state", "examples", "film", "relabel", "trim", "mirror", "delete", "delete_action", "job", "undo"]
    names += ["train", "cancel", "evaluate", "import_video", "compare", "activate", "delete_model", "redo_last", "stop"]
    names += ["record", "discard", "create_set", "rename_set", "delete_set"]
    for name in names:
        asked = {field: some[field] for field in fields_of(teacher, name) if field in some}
        attempt(teacher, name, **asked)
    teacher.tick(12)


def fields_of(teacher: Teacher, name: str) -> set[str]:
    command = next(each for each in teacher.trainer.commands if each.name == name)
    return set(command.request.model_fields)


@pytest.mark.parametrize("name", PLACED)
def test_a_set_whose_description_cannot_be_read_is_told_with_its_takes(teacher: Teacher, name: str) -> None:
    (teacher.folder / "sets/kitchen/set.json").unlink()
    PLACED[name](teacher.folder / "sets/kitchen/set.json")
    (listed,) = teacher.ask("list")["sets"]
    assert listed["actions"] == {"wave": 2} and "set.json: " in listed["unreadable"][0]
    teacher.ask("list")
    assert teacher.trainer.counters.rejects["unreadable_file"] == 1, "once for as long as it cannot"
    go_on(teacher)
    teacher.begin()


@pytest.mark.parametrize("name", [*FEW, "text"])
@pytest.mark.parametrize("place", ["sets/kitchen/take-0001.mcap", "sets/kitchen/take-0002.mcap", "models/new.npz"])
def test_what_is_no_take_and_no_model_is_told(teacher: Teacher, name: str, place: str) -> None:
    (teacher.folder / place).unlink(missing_ok=True)
    PLACED[name](teacher.folder / place)
    told = teacher.ask("list")
    assert Path(place).name in [*told["unreadable"], *told["sets"][0]["unreadable"]][0]
    assert teacher.trainer.counters.rejects["unreadable_file"] == 1
    go_on(teacher)
    teacher.begin()


@pytest.mark.parametrize(
    "name", [*(pytest.param(few, marks=pytest.mark.thorough) for few in FEW), "a list", "bytes", "deep"]
)
@pytest.mark.parametrize("place", ["jobs/job-1.json", "models/history.json", "models/{model}.json", "jobs/job-9.json"])
def test_what_is_no_job_and_no_description_is_survived(teacher: Teacher, name: str, place: str) -> None:
    (model,) = teacher.ask("list")["models"]
    path = teacher.folder / place.format(model=model["id"])
    path.unlink(missing_ok=True)
    PLACED[name](path)
    teacher.begin()
    told = teacher.ask("list")
    assert bool(told["models"]) != bool(told["unreadable"])
    go_on(teacher)


def test_names_that_are_no_text_are_told(teacher: Teacher) -> None:
    shutil.copytree(teacher.folder / "sets/kitchen", teacher.folder / "sets" / os.fsdecode(b"caf\xe9"))
    shutil.copy(
        teacher.folder / "sets/kitchen/take-0001.mcap", teacher.folder / "sets/kitchen" / os.fsdecode(b"\xff.mcap")
    )
    (teacher.folder / "models" / os.fsdecode(b"\xff.npz")).write_bytes(b"none")
    told = teacher.ask("list")
    json.dumps(told, ensure_ascii=False).encode()
    assert {each["name"] for each in told["sets"]} == {r"caf\udce9", "kitchen"} and told["unreadable"]
    json.dumps(teacher.examples(), ensure_ascii=False).encode()
    go_on(teacher)


GONE = ["sets/kitchen/take-0001.mcap", "sets/kitchen", "sets", "jobs", "models", "uploads", "uploads/.sent", "."]


def remove(path: Path) -> None:
    shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


@pytest.mark.parametrize("place", GONE)
def test_whatever_vanishes_commands_are_refused_and_the_service_goes_on(teacher: Teacher, place: str) -> None:
    send(teacher)
    teacher.ask("train", set="kitchen")
    remove(teacher.folder / place)
    teacher.jobs[-1].news = Progressing("training", 0.5)
    teacher.tick(12)
    teacher.jobs[-1].news = Ended({"scores": {}}, "")
    teacher.tick(12)
    go_on(teacher)


def test_a_take_that_vanishes_between_listing_and_reading_is_told(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    read = SetReader.take

    def vanish(reader: SetReader, path: Path) -> Any:
        path.unlink()
        return read(reader, path)

    monkeypatch.setattr(SetReader, "take", vanish)
    (listed,) = teacher.ask("list")["sets"]
    assert listed["takes"] == [] and "take-0001.mcap" in listed["unreadable"][0]


def test_a_film_of_a_take_that_has_just_vanished_is_refused(teacher: Teacher, monkeypatch: pytest.MonkeyPatch) -> None:
    read = SetStore.get

    def vanish(store: SetStore, name: str) -> Any:
        found = read(store, name)
        for take in found.takes:
            take.path.unlink()
        return found

    monkeypatch.setattr(SetStore, "get", vanish)
    with pytest.raises(Refusal, match="No such file"):
        teacher.ask("film", set="kitchen", example="take-0001/cut-1")


@pytest.mark.parametrize(
    ("place", "end"),
    [(place, "stop") for place in (*GONE, "sets/.making", "sets/kitchen/set.json")]
    + [
        pytest.param(place, end, marks=pytest.mark.thorough)
        for place in (*GONE, "sets/.making", "sets/kitchen/set.json")
        for end in ("discard", "frames")
    ],
)
def test_a_take_whose_folder_vanishes_is_lost_with_the_reason_and_another_can_be_recorded(
    teacher: Teacher, place: str, end: str
) -> None:
    teacher.ask("record", set="kitchen", label="nod", count=2)
    skeletons = Stream().repeat(WAVES[:2]).skeletons(first_ns=10**12)
    teacher.see(skeletons)
    remove(teacher.folder / place)
    if end == "frames":
        teacher.see(each.model_copy(update={"stamp_ns": each.stamp_ns + 10**10}) for each in skeletons)
        teacher.see(skeletons[-1].model_copy(update={"stamp_ns": 10**12 + number * 10**11}) for number in range(1, 9))
    else:
        attempt(teacher, end)
    for again in ("stop", "discard"):
        with pytest.raises(Refusal, match="no recording is running"):
            teacher.ask(again)
    told = teacher.tick().recording
    assert told is None or told.phase == "done"
    attempt(teacher, "create_set", set="garden")
    attempt(teacher, "record", set="garden", label="nod")
    attempt(teacher, "discard")
    go_on(teacher)


def test_a_take_that_cannot_be_begun_leaves_nothing_in_progress(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    (teacher.folder / "sets/.making").write_bytes(b"in the way")
    with pytest.raises(Refusal, match="making"):
        teacher.ask("record", set="kitchen", label="nod")
    assert teacher.tick().recording is None


def test_a_file_of_the_same_name_sent_during_an_import_is_another_one(teacher: Teacher) -> None:
    send(teacher, data=b"first")
    teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="nod")
    video = teacher.jobs[-1].arguments.video
    send(teacher, data=b"second")
    assert video.read_bytes() == b"first"
    teacher.jobs[-1].news = Ended(None, "no video")
    teacher.tick()
    assert not video.exists()
    teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="nod")
    assert teacher.jobs[-1].arguments.video.read_bytes() == b"second"


def test_a_video_whose_job_cannot_be_started_can_be_imported_again(taught: Path, tmp_path: Path) -> None:
    def fail(_: Any) -> Any:
        raise OSError(11, "Resource temporarily unavailable")

    shutil.copytree(taught, tmp_path / "copy")
    teacher = Teacher(tmp_path / "copy", fail)
    send(teacher)
    for _ in range(2):
        with pytest.raises(Refusal, match="temporarily unavailable"):
            teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="nod")
    assert list((teacher.folder / "jobs").iterdir()) == [] and teacher.tick().job is None


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.tuples(st.sampled_from("abc"), st.integers(0, 60), st.booleans(), st.booleans()), max_size=15))
def test_uploads_never_take_more_than_the_total(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pieces: list[tuple[str, int, bool, bool]]
) -> None:
    monkeypatch.setattr(upload_store, "MOST_TOTAL_BYTES", 100)
    monkeypatch.setattr(upload_store, "MOST_BYTES", 80)
    store = upload_store.UploadStore(tmp_path)
    sizes: dict[str, int] = {}
    for name, size, anew, last in pieces:
        offset = 0 if anew else sizes.get(name, 0)
        try:
            sizes[name] = store.add(name, offset, bytes(size), last)
        except Refusal as refusal:
            assert "bytes" in str(refusal)
        sizes = {each: total for each, total in sizes.items() if not (each == name and last)}
        there = sum(file.stat().st_size for file in tmp_path.rglob("*") if file.is_file() and file.name != CLAIM)
        assert there <= 100


def test_uploads_wait_for_their_import_while_another_trainer_starts_in_the_folder(teacher: Teacher) -> None:
    send(teacher, data=b"mine")
    other = Teacher(teacher.folder)
    send(other, data=b"another of that name")
    teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="nod")
    assert teacher.jobs[-1].arguments.video.read_bytes() == b"mine"


def test_too_many_uploads_are_refused(teacher: Teacher, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(upload_store, "MOST_FILES", 3)
    for number in range(3):
        send(teacher, f"clip{number}")
    with pytest.raises(Refusal, match="Import some of the waiting files first, or restart"):
        send(teacher, "clip3")
    send(teacher, "clip0", b"anew")


def test_a_set_that_vanishes_once_its_take_is_stored_ends_nothing(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    teacher.ask("redo_last", set="kitchen")
    teacher.see(Stream().repeat(WAVES[:2]).skeletons(first_ns=10**12))
    monkeypatch.setattr(SetStore, "get", lambda *_: (_ for _ in ()).throw(PermissionError(13, "Permission denied")))
    reply = teacher.ask("stop")
    assert reply["take"] == "take-0002" and "the old recording take-0001 could not be deleted" in reply["doubts"][-1]
    monkeypatch.undo()
    go_on(teacher)


def test_a_folder_of_models_that_nobody_may_enter_ends_nothing(
    teacher: Teacher, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = teacher.ask("list")["active"]
    tiny_model(TINY_PAPER).save(teacher.folder / "models/mine.npz")
    other = next(each["id"] for each in teacher.ask("list")["models"] if each["id"] != first)
    teacher.ask("activate", model=other)
    stat = os.stat

    def denied(path: Path | str | int, **options: Any) -> os.stat_result:
        if isinstance(path, Path) and path.parent == teacher.folder / "models":
            raise PermissionError(13, "Permission denied", str(path))
        return stat(path, **options)

    monkeypatch.setattr(os, "stat", denied)
    assert not teacher.tick(20).can_undo
    monkeypatch.undo()
    assert teacher.tick(20).can_undo


def test_a_job_that_another_trainer_of_the_folder_runs_is_left_to_it(teacher: Teacher) -> None:
    send(teacher)
    job = teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="nod")["id"]
    video = teacher.jobs[-1].arguments.video
    with (teacher.folder / f"jobs/{job}.work/.running").open("wb") as claimed:
        claim(claimed)
        other = Teacher(teacher.folder)
    assert other.tick().job is None
    assert video.read_bytes() == b"video" and other.ask("job", job=job)["state"] == "running"
    teacher.ask("cancel", job=job)
    assert not video.exists() and other.ask("job", job=job)["state"] == "cancelled"


def test_marks_that_use_an_examples_name_again_are_left_as_they_are(teacher: Teacher) -> None:
    stream = Stream().repeat(WAVES[:2])
    (one, other), later_ns = stream.truths, 10**9
    bounds = [[later_ns + at * FRAME_NS for at in truth] for truth in (one, other)]
    path = teacher.folder / "sets/kitchen/live.mcap"
    with Recorder(path, person="anna", source="test") as recorder:
        for message in stream.skeletons(first_ns=later_ns):
            recorder.write(message)
        for start_ns, end_ns in bounds:
            for each in segment_marks(start_ns, end_ns, "kinect0", "live-1", "nod"):
                recorder.write(each)
    teacher.ask("relabel", set="kitchen", example="live/live-1", label="bow")
    teacher.ask("delete", set="kitchen", example="live/live-1")
    assert [message.stamp_ns for message in Recording(path).messages((keys.SEGMENT,))] == bounds[1]
