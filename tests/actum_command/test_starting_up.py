"""What `actum up` starts, which model it uses, and what it prints about both."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from actum.run_folder import CLAIM
from actum_command import processes
from actum_command.__main__ import app
from actum_command.model_in_use import REMINDER_S, ModelInUse, Reminder, model_in_use
from actum_command.simulated_model import SIMULATED_MODEL
from actum_command.supervising import Program
from recognisers import tiny_model
from som_classifier.model_loading import load_model


def printed_by(*arguments: str, code: int = 0) -> str:
    done = CliRunner().invoke(app, ["up", *arguments], env={"ACTUM_MODEL": None})
    assert done.exit_code == code, done.output
    return " ".join((done.stdout + done.stderr).split())


@pytest.mark.parametrize(
    ("arguments", "beside", "told"),
    [
        ([], ["scene_simulator"], "actions are found by the model, or marked by you: 'actum segment toggle'"),
        (["--segments", "both"], ["scene_simulator"], "or marked by you: 'actum segment toggle'"),
        (["--segments", "auto"], ["scene_simulator"], "marks are refused, and --segments both takes them as well"),
        (["--segments", "marks"], ["scene_simulator"], "only marked actions are recognised, and nobody marks here"),
        (["--marked"], ["scene_simulator", "scene"], "the simulated scene marks its own actions"),
        (["--marked", "--segments", "marks"], ["scene_simulator", "scene"], "the simulated scene marks its own"),
        (["--source", "camera"], ["sensor_gateway"], "or marked by you: 'actum segment toggle'"),
        (["--source", "none"], [], "or marked by you: 'actum segment toggle'"),
    ],
)
def test_what_runs_beside_the_services_and_how_actions_are_found(
    arguments: list[str], beside: list[str], told: str, started: list[Program]
) -> None:
    assert told in printed_by(*arguments)
    assert [program.name for program in started] == [*processes.SERVICES, "model_trainer", *beside, processes.PAGE]


def test_the_advice_about_marks_follows_the_environment_too(
    started: list[Program], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ACTUM_SEGMENTS", "auto")
    assert "marks are refused" in printed_by()


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--source", "camera", "--marked"], "--marked works only with --source simulator"),
        (["--segments", "auto", "--marked"], "--segments auto ignores the marks that --marked publishes"),
    ],
)
def test_marks_of_the_scene_that_nobody_could_use_are_refused(
    arguments: list[str], reason: str, started: list[Program]
) -> None:
    assert reason in printed_by(*arguments, code=1)
    assert started == []


@pytest.mark.usefixtures("started")
def test_the_simulated_scene_starts_with_the_model_that_ships_until_another_was_put_into_use(tmp_path: Path) -> None:
    assert "model: the one for the simulated scene that ships with actum" in printed_by()
    tiny_model().save(tmp_path / "teaching" / "model.npz")
    assert "model: the one that was put into use last" in printed_by()


@pytest.mark.usefixtures("started")
def test_a_camera_does_not_start_with_the_model_of_the_simulated_scene() -> None:
    printed = printed_by("--source", "camera")
    assert "no model yet, so every action is answered with 'no model'. Teach one on the page; or record" in printed
    assert "simulat" not in printed


@pytest.mark.usefixtures("started")
def test_a_model_that_is_missing_or_cannot_be_used_is_named_with_what_may_be_meant(tmp_path: Path) -> None:
    (tmp_path / "foreign.npz").write_text("nothing of the kind")
    tiny_model().save(tmp_path / "model.npz")
    for name, told in (
        ("nomodel.npz", f"'no model'; is {tmp_path / 'model.npz'} meant?"),
        ("nomodel.npz", f"there is no {tmp_path / 'nomodel.npz'}: until it is there, every action is answered with"),
        ("foreign.npz", "foreign.npz: the file is not a model of actum"),
        ("model.npz", "model.npz finds no actions by itself, since it was trained without continuous recordings"),
    ):
        assert told in printed_by("--model", str(tmp_path / name))


def test_a_model_that_is_missing_is_named_again_until_it_is_there(tmp_path: Path) -> None:
    file = tmp_path / "later.npz"
    reminder = Reminder(ModelInUse(tmp_path / "in-use.npz", file), 0.0)
    assert reminder.lines(REMINDER_S - 1) == []
    assert reminder.lines(REMINDER_S) == reminder.lines(2 * REMINDER_S) != []
    file.touch()
    assert reminder.lines(2 * REMINDER_S + 1) == [f"{file} is there now and is used"]
    assert reminder.lines(4 * REMINDER_S) == []


def test_a_named_model_is_copied_into_the_trainers_folder_for_one_run(tmp_path: Path) -> None:
    named, given = tmp_path / "mine.npz", {"trainer_data": [str(tmp_path / "teaching")]}
    tiny_model().save(named)
    with model_in_use(named, "camera", given) as model, model_in_use(named, "camera", given) as other:
        assert model.original == named
        assert model.file.read_bytes() == named.read_bytes()
        assert model.file.is_relative_to(tmp_path / "teaching")
        assert model.file != other.file, "two systems do not share a model"
    assert list((tmp_path / "teaching").iterdir()) == []


KILLED = """
import os, signal, sys
from pathlib import Path
from actum_command.model_in_use import model_in_use
with model_in_use(Path(sys.argv[1]), "camera", {"trainer_data": [sys.argv[2]]}):
    os.kill(os.getpid(), signal.SIGKILL)
"""


def test_the_folder_that_a_killed_run_has_left_is_deleted_and_that_of_a_running_one_is_not(tmp_path: Path) -> None:
    named, teaching = tmp_path / "mine.npz", tmp_path / "teaching"
    tiny_model().save(named)
    given = {"trainer_data": [str(teaching)]}
    with model_in_use(named, "camera", given) as running:
        subprocess.run([sys.executable, "-c", KILLED, named, teaching], check=False)
        assert len(list(teaching.iterdir())) == 2
        with model_in_use(named, "camera", given) as model:
            assert {*teaching.iterdir()} == {running.file.parent, model.file.parent}


def test_what_is_no_folder_of_a_killed_run_is_left_alone(tmp_path: Path) -> None:
    named, teaching = tmp_path / "mine.npz", tmp_path / "teaching"
    tiny_model().save(named)
    others = [teaching / "run-notes", teaching / "run-just-begun"]
    for each in others:
        each.mkdir(parents=True)
    (others[1] / CLAIM).touch()
    with model_in_use(named, "camera", {"trainer_data": [str(teaching)]}):
        pass
    assert {*teaching.iterdir()} == {*others}


def test_where_files_cannot_be_locked_no_folder_is_deleted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("actum.run_folder.is_being_written", lambda _file: False)
    named, given = tmp_path / "mine.npz", {"trainer_data": [str(tmp_path / "teaching")]}
    tiny_model().save(named)
    with model_in_use(named, "camera", given) as model, model_in_use(named, "camera", given):
        assert model.file.exists()


def test_the_model_that_ships_is_never_what_a_camera_starts_with(tmp_path: Path) -> None:
    given = {"trainer_data": [str(tmp_path)]}
    (tmp_path / "model.npz").write_bytes(SIMULATED_MODEL.read_bytes())  # as after undoing to it
    with model_in_use(None, "camera", given) as model:
        assert (model.original, model.file.exists()) == (None, False)
    with model_in_use(None, "simulator", given) as model:
        assert model.original == SIMULATED_MODEL
        assert load_model(model.file).id == load_model(SIMULATED_MODEL).id


def test_a_folder_that_cannot_be_used_is_named(tmp_path: Path, started: list[Program]) -> None:
    (tmp_path / "teaching").write_text("a file")
    assert "teaching cannot be used" in printed_by(code=1)
    assert started == []
