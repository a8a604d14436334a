"""Jobs: training, cross-validation with advice, import of videos, cancelling, dying; models in use, and back."""

import base64
import json
import shutil
import sys
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from actum.commands import Refusal
from actum.node import SECOND_NS, Counters
from actum.recorder import is_being_written
from actum.rewriting import rewrite
from actum_model_trainer import sampling
from live import wait_until
from model_trainer import job
from model_trainer.job import Arguments
from model_trainer.job_process import CLAIM, Ended, JobProcess, Progressing
from model_trainer.job_store import JobStore
from performers import TINY
from recognisers import tiny_model
from repeating import Stream
from som_classifier.model_loading import WatchedModel, load_model
from teaching import GOGGLINGS, WAVES, Teacher


@pytest.fixture(scope="module")
def taught(made_once: Callable[[str, Callable[[Path], None]], Path]) -> Path:
    def teach(folder: Path) -> None:
        teacher = Teacher(folder)
        teacher.ask("create_set", set="kitchen")
        for person in ("anna", "bert"):
            teacher.teach("wave", WAVES, person)
            teacher.teach("goggles", GOGGLINGS, person)

    return made_once("taught-two-actions", teach)


Finish = Callable[[], dict[str, Any]]


@pytest.fixture
def finish(teacher: Teacher, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Finish:
    """Do the newest job in this process, with a small preset; return what became of it."""

    def done_here() -> dict[str, Any]:
        monkeypatch.setattr(sys, "argv", ["job", teacher.jobs[-1].arguments.model_dump_json()])
        monkeypatch.setattr(job, "PRESETS", {"pyramid": TINY, TINY.name: TINY})
        job.main()
        lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        assert all(0 <= line["done"] <= 1 for line in lines[:-1])
        teacher.jobs[-1].news = Ended(lines[-1].get("result"), lines[-1].get("error", ""))
        teacher.tick()
        return teacher.ask("job", job=teacher.told[-1].job.id)

    return done_here


def test_a_set_is_trained_put_into_use_and_undone(teacher: Teacher, finish: Finish) -> None:
    classifier = WatchedModel(teacher.model)
    assert classifier.poll(Counters()) is None
    tiny_model().save(teacher.model)
    first = classifier.poll(Counters())
    assert first is not None and teacher.tick(20).model == first.id, "one that somebody else has put there"
    teacher.ask("train", set="kitchen")
    ended = finish()
    assert (ended["state"], ended["message"]) == ("done", f"model {ended['result']['model']}: 20 examples of 2 actions")
    assert not list((teacher.folder / "jobs").glob("*.work"))
    taught = ended["result"]["model"]
    listed = {each["id"]: each for each in teacher.ask("list")["models"]}
    assert listed[taught]["labels"] == ["goggles", "wave"] and listed[taught]["people"] == ["anna", "bert"]
    assert listed[taught]["set"] == "kitchen" and listed[taught]["scores"]["accuracy_held_out"] == 1.0
    assert listed[first.id]["active"] and not listed[taught]["active"]
    teacher.ask("activate", model=taught)
    second = classifier.poll(Counters())
    assert second is not None and second.id == taught == teacher.tick().model
    assert teacher.tick().can_undo
    film = teacher.ask("film", set="kitchen", example=teacher.examples()[0]["id"])
    assert film["trace"] and len(film["trace"][0]) == 2
    teacher.ask("undo")
    third = classifier.poll(Counters())
    assert third is not None and third.id == first.id
    assert not teacher.tick().can_undo
    with pytest.raises(Refusal, match="there is no model to return to"):
        teacher.ask("undo")


def test_a_set_that_is_renamed_is_still_the_one_that_its_models_were_trained_on(teacher: Teacher) -> None:
    begun = teacher.ask("train", set="kitchen")
    with pytest.raises(Refusal, match="the set kitchen is in use by a training: wait until it ends, or cancel it"):
        teacher.ask("rename_set", set="kitchen", name="Küche")
    tiny_model().save(teacher.jobs[-1].arguments.folder / job.MODEL)
    teacher.jobs[-1].news = Ended({"model": tiny_model().id, "scores": {}})
    teacher.tick()
    assert teacher.ask("job", job=begun["id"])["state"] == "done"
    teacher.ask("activate", model=tiny_model().id)
    teacher.ask("rename_set", set="kitchen", name="Küche")
    assert teacher.tick(20).model_set == "Küche", "where the page keeps corrections"
    teacher.begin()
    assert teacher.tick().model_set == "Küche"
    assert [each["set"] for each in teacher.ask("list")["models"]] == ["Küche"]


def test_how_postures_go_on_is_learnt_on_request(teacher: Teacher, finish: Finish) -> None:
    for continued in (False, True):
        teacher.ask("train", set="kitchen", continued=continued)
        teacher.ask("activate", model=finish()["result"]["model"])
        assert (load_model(teacher.model).continuation is not None) == continued


def test_a_job_says_how_much_is_used_where_not_all_fits(
    teacher: Teacher, finish: Finish, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sampling, "MOST_SEGMENTS", 12)
    teacher.ask("train", set="kitchen")
    result = finish()["result"]
    assert result["examples"] == 12
    assert result["advice"][0].startswith("Training uses 12 of 20 labelled segments")


def test_models_are_compared_and_deleted_but_not_the_one_in_use(teacher: Teacher) -> None:
    tiny_model().save(teacher.model)
    teacher.tick(20)
    used = teacher.tick().model
    with pytest.raises(Refusal, match="is in use: use another model first"):
        teacher.ask("delete_model", model=used)
    compared = teacher.ask("compare", model=used, **{"with": used})
    assert compared["added"] == compared["missing"] == []
    assert compared["sentence"].startswith(f"{used}, compared with {used}: 6 examples by 2 people, instead of 6 by 2")
    shutil.copy(teacher.model, teacher.folder / "models" / "from elsewhere.npz")
    assert [each["id"] for each in teacher.ask("list")["models"]] == [used], "the same, by another name"
    for command in ("activate", "delete_model", "compare"):
        with pytest.raises(Refusal, match="there is no model '../x'"):
            teacher.ask(command, model="../x")


@pytest.mark.thorough
def test_a_set_of_two_people_is_tested_by_people(teacher: Teacher, finish: Finish) -> None:
    teacher.ask("evaluate", set="kitchen")
    result = finish()["result"]
    assert (result["by"], result["labels"], result["confusion"]) == ("people", ["goggles", "wave"], [[10, 0], [0, 10]])
    assert (result["accuracy"], result["n"]) == (1.0, 20)
    assert result["false_alarms_per_min"] is not None
    assert any("background" in sentence for sentence in result["advice"])


@pytest.mark.long
def test_a_set_of_one_person_is_tested_by_examples(teacher: Teacher, finish: Finish) -> None:
    for example in [each["id"] for each in teacher.examples() if each["person"] == "bert"]:
        teacher.ask("delete", set="kitchen", example=example)
    teacher.ask("evaluate", set="kitchen")
    result = finish()["result"]
    assert (result["by"], result["n"], result["accuracy"]) == ("examples", 10, 1.0)
    assert any(
        "All examples show the same person, anna: record 5 examples of each action, performed by a second person." in it
        for it in result["advice"]
    )


ONE_ACTION = (
    "a model needs examples of at least two actions, but the recordings contain examples of only one action, "
    "'goggles': record more actions"
)


def test_what_cannot_be_trained_fails_with_the_reason(teacher: Teacher, finish: Finish) -> None:
    teacher.ask("delete_action", set="kitchen", label="wave")
    for command in ("train", "evaluate"):
        teacher.ask(command, set="kitchen")
        ended = finish()
        assert ended["state"] == "failed" and ended["result"] is None
        assert ended["message"] == ONE_ACTION
    with pytest.raises(Refusal, match="no preset 'none': use one of"):
        teacher.ask("train", set="kitchen", preset="none")


def test_a_test_for_which_an_action_has_too_few_examples_says_which(teacher: Teacher, finish: Finish) -> None:
    for each in [each for each in teacher.examples() if each["label"] == "wave"][1:]:
        teacher.ask("delete", set="kitchen", example=each["id"])
    teacher.ask("evaluate", set="kitchen")
    assert finish()["message"].endswith(
        "which can be all that there are of 'wave': record at least two examples of each action"
    )


def test_a_damaged_take_is_named_where_it_lies(teacher: Teacher, finish: Finish) -> None:
    damaged = teacher.folder / "sets/kitchen/take-0001.mcap"
    damaged.write_bytes(b"no recording")
    teacher.ask("train", set="kitchen")
    assert finish()["message"].startswith(f"{damaged}: the file is not an MCAP file")


def test_an_example_that_cannot_be_used_is_named_with_its_take(teacher: Teacher, finish: Finish) -> None:
    example = teacher.examples()[-1]
    path = teacher.folder / f"sets/kitchen/{example['take']}.mcap"
    rewrite(path, lambda stored: None if example["start_ns"] < stored.publish_ns < example["end_ns"] else stored)
    teacher.ask("train", set="kitchen")
    (left_out,) = finish()["result"]["left_out"]
    assert left_out.startswith(f"{example['id']}: ")


def test_an_update_changes_what_the_model_says_of_the_segments_that_it_finds_as_before(
    teacher: Teacher, finish: Finish
) -> None:
    teacher.ask("train", set="kitchen")
    before = load_model(teacher.folder / f"models/{finish()['result']['model']}.npz")
    span = {"agent": 1, "start_ns": SECOND_NS, "end_ns": 3 * SECOND_NS}
    teacher.act(Stream().repeat(WAVES))
    teacher.ask("correct", set="kitchen", label="wave", person="cleo", **span)
    teacher.ask("train", set="kitchen", update=before.id)
    ended = finish()
    after = load_model(teacher.folder / f"models/{ended['result']['model']}.npz")
    assert ended["result"]["examples"] == 21
    assert after.id != before.id and np.array_equal(
        after.arrays["completeness_axes"], before.arrays["completeness_axes"]
    )
    assert not np.array_equal(after.arrays["verifier_axes"], before.arrays["verifier_axes"])
    with pytest.raises(Refusal, match="there is no model 'none'"):
        teacher.ask("train", set="kitchen", update="none")


def test_one_job_runs_at_a_time_and_tells_how_far_it_is(teacher: Teacher) -> None:
    begun = teacher.ask("train", set="kitchen")
    teacher.jobs[-1].news = Progressing("training the maps", 0.25)
    state = teacher.tick(4).job
    assert state is not None and (state.stage, state.done, state.state) == ("training the maps", 0.25, "running")
    with pytest.raises(Refusal, match=rf"the job {begun['id']} \(a training\) is still running"):
        teacher.ask("evaluate", set="kitchen")
    assert teacher.ask("cancel", job=begun["id"])["state"] == "cancelled"
    assert teacher.jobs[-1].ended
    with pytest.raises(Refusal, match="cannot be cancelled, because its state is cancelled"):
        teacher.ask("cancel", job=begun["id"])
    assert not list((teacher.folder / "jobs").glob("*.work"))


def test_a_new_job_never_has_the_id_of_one_whose_file_cannot_be_read(tmp_path: Path) -> None:
    damaged = tmp_path / "job-7.json"
    damaged.write_bytes(b"")
    assert JobStore(tmp_path).new_id() == "job-8"


def test_a_job_that_the_service_did_not_outlive_counts_as_cancelled(teacher: Teacher) -> None:
    begun = teacher.ask("train", set="kitchen")
    teacher.begin()
    found = teacher.ask("job", job=begun["id"])
    assert (found["state"], found["message"]) == (
        "cancelled",
        "the service ended while this job ran: start the job again",
    )
    assert teacher.tick().job.state == "cancelled"


def wait_for_end(running: JobProcess) -> Ended:
    news: list[Any] = []

    def ended() -> bool:
        news.append(running.look())
        return isinstance(news[-1], Ended)

    wait_until(ended, "the job ends", 60)
    return news[-1]


@pytest.mark.system
@pytest.mark.parametrize("end", [lambda running: running.end(), lambda running: running._process.kill()])
def test_a_process_that_is_ended_says_how(teacher: Teacher, tmp_path: Path, end: Callable[[JobProcess], None]) -> None:
    takes = teacher.folder / "sets/kitchen"
    running = JobProcess(Arguments(kind="train", folder=tmp_path, takes=takes, preset="pyramid"))
    wait_until(lambda: isinstance(running.look(), Progressing), "it has begun", 60)
    assert is_being_written(tmp_path / CLAIM)
    end(running)
    ended = wait_for_end(running)
    assert not is_being_written(tmp_path / CLAIM)
    assert ended.result is None and "its process ended unexpectedly (signal" in ended.error


@pytest.mark.system
def test_a_process_that_fails_is_told_with_its_last_words(tmp_path: Path) -> None:
    running = JobProcess(Arguments(kind="no such kind", folder=tmp_path))
    ended = wait_for_end(running)
    assert ended.result is None
    assert "its process ended unexpectedly (exit code 1)" in ended.error and "KeyError: 'no such kind'" in ended.error


@pytest.mark.system
def test_a_process_whose_folder_has_vanished_is_told(tmp_path: Path) -> None:
    folder = tmp_path / "job-1.work"
    folder.mkdir()
    running = JobProcess(Arguments(kind="no such kind", folder=folder))
    shutil.rmtree(folder)
    assert "what it printed cannot be read (No such file" in wait_for_end(running).error


@pytest.mark.parametrize("line", [b"5", b'"text"', b'{"stage": "x"}', b'{"a": 1}', b"[" * 100_000, b"no JSON"])
def test_what_a_library_prints_is_no_news(line: bytes, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    class Printing:
        returncode = 1

        def __init__(self, *_: Any, **__: Any) -> None:
            self.stdout = BytesIO(b'{"stage": "training", "done": 0.5}\n' + line + b"\n")

        def poll(self) -> int | None:
            return None

    monkeypatch.setattr("subprocess.Popen", Printing)
    running = JobProcess(Arguments(kind="train", folder=tmp_path))
    running._reading.join()
    assert running.look() == Progressing("training", 0.5)


def test_a_file_comes_in_pieces_that_follow_one_another(teacher: Teacher) -> None:
    def send(offset: int, data: bytes, last: bool = False) -> dict[str, Any]:
        text = base64.b64encode(data).decode()
        return teacher.ask("upload", name="clip.mp4", offset=offset, data=text, last=last)

    assert send(0, b"abc")["size"] == 3
    with pytest.raises(Refusal, match="has the offset 5, but 3 bytes of the file have arrived: continue at offset 3"):
        send(5, b"x")
    with pytest.raises(Refusal, match="the file 'clip.mp4' was not uploaded completely"):
        teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="wave")
    assert send(3, b"def", last=True) == {"upload": "clip.mp4", "size": 6}
    (sent,) = teacher.folder.glob("uploads/.sent/*/clip.mp4")
    assert sent.read_bytes() == b"abcdef"
    with pytest.raises(Refusal, match="base64"):
        teacher.ask("upload", name="clip.mp4", offset=0, data="no base64!", last=True)


@pytest.mark.parametrize("pose_model", [None, "none.task"])
def test_a_video_that_is_none_or_without_a_pose_model_fails_with_the_reason(
    teacher: Teacher, finish: Finish, monkeypatch: pytest.MonkeyPatch, pose_model: str | None
) -> None:
    if pose_model is not None:
        monkeypatch.setenv("ACTUM_POSE_MODEL", pose_model)
    teacher.ask("upload", name="clip.mp4", offset=0, data=base64.b64encode(b"no video").decode(), last=True)
    teacher.ask("import_video", set="kitchen", upload="clip.mp4", label="wave", person="anna")
    ended = finish()
    assert ended["state"] == "failed"
    assert any(word in ended["message"] for word in ("not a video", "pose model", "MediaPipe", "none.task"))
    assert len(teacher.examples()) == 20


@pytest.mark.data
@pytest.mark.pose_model
def test_examples_are_cut_out_of_a_video(teacher: Teacher, data: Path, finish: Finish) -> None:
    video = next(path for path in sorted((data / "florence3d_rgb").rglob("*")) if path.suffix in (".avi", ".mp4"))
    teacher.ask("upload", name="clip.avi", offset=0, data=base64.b64encode(video.read_bytes()).decode(), last=True)
    teacher.ask("import_video", set="kitchen", upload="clip.avi", label="drink", person="carl", count=1)
    ended = finish()
    assert (ended["state"], ended["message"]) == ("done", "1 example cut out of the video")
    (example,) = [each for each in teacher.examples() if each["person"] == "carl"]
    assert (example["label"], example["origin"], example["take"]) == ("drink", "cut", ended["result"]["take"])
    assert not [*teacher.folder.glob("uploads/.sent/*/clip.avi")]
    assert teacher.ask("film", set="kitchen", example=example["id"])["joints"]
