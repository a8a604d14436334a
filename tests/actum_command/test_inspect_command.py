import hashlib
import re
from functools import partial
from pathlib import Path

import pytest
from matplotlib.image import imread

from actum.installing import install_command
from actum_model_inspector.folder import LIST
from command_lines import invoke, refused, written
from people import FRAME_NS
from performers import HAND_PATHS, TINY_OF_EACH_KIND, TINY_PAPER, mark, performance
from recognisers import tiny_model
from som_classifier.presets import Preset

inspect, refusal = partial(invoke, "inspect"), partial(refused, "inspect")


@pytest.fixture(params=TINY_OF_EACH_KIND, ids=lambda preset: preset.name)
def model(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    preset: Preset = request.param
    tiny_model(preset).save(tmp_path / "model.npz")
    return tmp_path / "model.npz"


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("actum_model_inspector.style.DOTS_PER_INCH", 30)


def recorded(path: Path, actions: list[str], person: str = "2") -> Path:
    skeletons, marks = performance(actions)
    return written(path, *skeletons, *marks, person=person)


def linked(folder: Path) -> list[Path]:
    return [folder / file for file in re.findall(r'<img src="([^"]+)"', (folder / "index.html").read_text("utf-8"))]


def test_a_model_alone_is_shown_by_its_maps(model: Path, tmp_path: Path) -> None:
    done = inspect(model, "-o", tmp_path / "deep" / "pictures")
    assert done.exit_code == 0, done.output
    assert "index.html" in done.output
    files = linked(tmp_path / "deep" / "pictures")
    assert {file.stem for file in files} >= {"posture-map", "action-map"}
    assert all(imread(file).size for file in files)


def test_a_recording_shows_how_it_is_recognised(tmp_path: Path) -> None:
    model = tmp_path / "model.npz"
    tiny_model().save(model)
    recording = recorded(tmp_path / "a.mcap", ["push"])
    assert inspect(model, recording, "-o", tmp_path / "out").exit_code == 0
    names = {file.stem for file in linked(tmp_path / "out") if file.is_file()}
    assert {"confusion", "trace-push", "time-push"} <= names


def files_of(folder: Path) -> set[Path]:
    return {file for file in folder.iterdir() if file.suffix in {".png", ".svg", ".html"}}


@pytest.mark.thorough
@pytest.mark.parametrize("ending", ["png", "svg"])
def test_pictures_of_an_earlier_run_leave_the_folder(tmp_path: Path, ending: str) -> None:
    """Another model, another recording, another format: every picture that is there belongs to the page."""
    out, pyramid, paper = (tmp_path / name for name in ("out", "pyramid.npz", "paper.npz"))
    tiny_model().save(pyramid)
    tiny_model(TINY_PAPER).save(paper)
    assert inspect(pyramid, recorded(tmp_path / "a.mcap", ["push"]), "-o", out).exit_code == 0
    assert (out / "movement-map.png").exists()
    done = inspect(paper, recorded(tmp_path / "b.mcap", ["lift"]), "-o", out, "--format", ending)
    assert done.exit_code == 0
    assert files_of(out) == {*linked(out), out / "index.html"}


@pytest.mark.parametrize("name", ["index.html", "posture-map.png"])
def test_a_users_file_of_a_wanted_name_is_not_overwritten(tmp_path: Path, name: str) -> None:
    out, model = tmp_path / "out", tmp_path / "model.npz"
    tiny_model(TINY_PAPER).save(model)
    out.mkdir()
    (out / name).write_bytes(b"mine")
    refused = inspect(model, "-o", out)
    assert refused.exit_code == 1 and f"{name} was not written by 'actum inspect'" in refused.output
    assert (out / name).read_bytes() == b"mine" and len(list(out.iterdir())) == 1


def test_what_a_run_has_not_written_stays_whatever_its_name(tmp_path: Path) -> None:
    out, model = tmp_path / "out", tmp_path / "model.npz"
    tiny_model(TINY_PAPER).save(model)
    out.mkdir()
    mine = out / "time-holiday.png"
    mine.write_bytes(b"mine")
    assert inspect(model, recorded(tmp_path / "a.mcap", ["push"]), "-o", out).exit_code == 0
    edited = out / "time-push.png"
    edited.write_bytes(b"drawn upon")
    with (out / LIST).open("a") as listed:
        listed.write(f"{hashlib.sha256(b'far').hexdigest()}  ../far.png\nno line of a list\n")
    (tmp_path / "far.png").write_bytes(b"far")
    assert inspect(model, "-o", out).exit_code == 0
    assert (mine.read_bytes(), edited.read_bytes()) == (b"mine", b"drawn upon")
    assert (tmp_path / "far.png").exists()
    assert files_of(out) == {*linked(out), out / "index.html", mine, edited}


def test_a_run_that_is_refused_leaves_the_earlier_pictures(tmp_path: Path) -> None:
    out, model = tmp_path / "out", tmp_path / "model.npz"
    tiny_model(TINY_PAPER).save(model)
    assert inspect(model, "-o", out).exit_code == 0
    before = files_of(out)
    model.write_bytes(b"no model")
    refusal(model, "-o", out)
    assert files_of(out) == before


def test_only_the_chosen_person_is_shown(tmp_path: Path) -> None:
    model = tmp_path / "model.npz"
    tiny_model(TINY_PAPER).save(model)
    for person, action in zip(("2", "3"), HAND_PATHS, strict=False):
        recorded(tmp_path / f"{person}.mcap", [action], person)
    assert inspect(model, tmp_path, "--person", "3", "--format", "svg", "-o", tmp_path / "out").exit_code == 0
    names = {file.name for file in linked(tmp_path / "out")}
    assert "time-push.svg" in names
    assert "time-lift.svg" not in names


def test_what_is_wrong_is_said(tmp_path: Path) -> None:
    tiny_model().save(tmp_path / "m.npz")
    foreign = tmp_path / "foreign.npz"
    foreign.write_bytes(b"PK not a model")
    assert "actum train" in refusal(foreign, "-o", tmp_path / "out")
    assert "the model file does not exist" in refusal(tmp_path / "none.npz", "-o", tmp_path / "out")
    assert "png, svg" in refusal(tmp_path / "m.npz", "-o", tmp_path / "out", "--format", "bmp")
    assert "no recordings" in refusal(tmp_path / "m.npz", tmp_path, "-o", tmp_path / "out")
    assert "foreign.npz is not a folder" in refusal(tmp_path / "m.npz", "-o", foreign)


def test_a_recording_without_segments_is_refused_with_the_remedy(tmp_path: Path) -> None:
    tiny_model().save(tmp_path / "m.npz")
    written(tmp_path / "a.mcap", *performance(["push"])[0], person="2")
    assert "actum segment" in refusal(tmp_path / "m.npz", tmp_path / "a.mcap", "-o", tmp_path / "out")


def test_a_recording_that_breaks_off_before_any_segment_is_named(tmp_path: Path) -> None:
    tiny_model().save(tmp_path / "m.npz")
    whole = recorded(tmp_path / "a.mcap", ["push"])
    whole.write_bytes(whole.read_bytes()[:400])
    done = inspect(tmp_path / "m.npz", whole, "-o", tmp_path / "out")
    assert done.exit_code == 1
    assert "is truncated" in " ".join(done.output.split())


def test_segments_without_labels_are_shown_by_their_answers(tmp_path: Path) -> None:
    tiny_model().save(tmp_path / "m.npz")
    written(
        tmp_path / "a.mcap",
        *performance(["push"])[0],
        mark("start", 0, "a"),
        mark("end", 19 * FRAME_NS, "a"),
        person="2",
    )
    assert inspect(tmp_path / "m.npz", tmp_path / "a.mcap", "-o", tmp_path / "out").exit_code == 0
    names = {file.stem for file in linked(tmp_path / "out")}
    assert "confusion" not in names
    assert any(name.startswith("trace-") for name in names)


def test_without_matplotlib_the_remedy_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    tiny_model().save(tmp_path / "m.npz")
    monkeypatch.setattr("actum_command.commands.terminal.find_spec", lambda name: None)
    assert install_command("model-inspector") in refusal(tmp_path / "m.npz", "-o", tmp_path / "out")
