"""A recogniser that only the tables know is trained, tested, tuned, drawn, put into use and run as any other."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from actum.commands import Refusal
from actum.messages import Action, Message
from actum_command.__main__ import app
from chain import replayed
from nearest_recogniser import NEAREST, TABLES
from som_classifier.model_loading import ModelError, load_model
from som_classifier.node import SomClassifier
from teaching import Teacher
from unmarked import bounds_ns, postures, recorded, scene

TAUGHT = [scene(seed=seed, height=height) for seed, height in ((1, 0.95), (2, 1.1))]
TESTED = scene(seed=3)


@pytest.fixture(scope="module", autouse=True)
def known() -> Iterator[None]:
    """Register it in the tables, and nowhere else."""
    with pytest.MonkeyPatch.context() as patch:
        for table, own in TABLES:
            patch.setitem(table, NEAREST.kind, own)
        yield


@pytest.fixture(scope="module")
def folder(known: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Recordings of two people, a third person's, and the model of the two."""
    made = tmp_path_factory.mktemp("nearest")
    for name, each in zip(("one", "two", "three"), (*TAUGHT, TESTED), strict=True):
        recorded(made, name, [*each.skeletons(), *each.marks()], name)
    said = told(made, "train", "one.mcap", "two.mcap", "-o", "model.npz", "--preset", "nearest")
    assert "12 samples of 3 actions, preset nearest" in said
    return made


def told(folder: Path, command: str, *words: str, code: int = 0) -> str:
    """What a command prints; words that name files lie in the folder."""
    given = [str(folder / word) if "." in word or word == "pictures" else word for word in words]
    done = CliRunner().invoke(app, [command, *given])
    assert done.exit_code == code, done.output
    return " ".join(done.output.split())


def answers(folder: Path, messages: list[Message]) -> list[Action]:
    node = SomClassifier(load_model(folder / "model.npz"), publish_maps=True)
    arrivals = [(message.stamp_ns, message) for message in sorted(messages, key=lambda each: each.stamp_ns or 0)]
    return [message for _, message in replayed(node, arrivals) if isinstance(message, Action)]


def test_it_knows_a_third_person_s_marked_actions_and_finds_unmarked_ones(folder: Path) -> None:
    assert "accuracy 100.0%" in told(folder, "evaluate", "model.npz", "three.mcap")
    assert "6 of 6 actions found, 0 false" in told(folder, "evaluate", "--continuous", "model.npz", "three.mcap")


def test_people_are_left_out_in_turn(folder: Path) -> None:
    words = "--leave-one-person-out", "one.mcap", "two.mcap", "--preset", "nearest"
    assert "accuracy 100.0%" in told(folder, "evaluate", *words)


def test_a_marked_action_gets_early_answers_and_a_final_one(folder: Path) -> None:
    marks = [mark for mark in TESTED.marks() if mark.segment_id == "0"]
    given = answers(folder, [*marks, *postures(TESTED.skeletons())])
    of_mark = [each for each in given if each.segment_id == "0"]
    assert [each.action for each in of_mark if each.final] == [TESTED.acts[0].action]
    assert len([each for each in of_mark if not each.final]) > 10
    assert of_mark[-1].maps == {}


def test_unmarked_actions_are_found_where_they_were_done(folder: Path) -> None:
    given = answers(folder, list(postures(TESTED.skeletons())))
    finals = [each for each in given if each.final]
    assert [each.action for each in finals] == [act.action for act in TESTED.acts]
    for found, (start_ns, end_ns, _) in zip(finals, bounds_ns(TESTED.acts), strict=True):
        assert found.end_ns is not None
        assert min(found.end_ns, end_ns) - max(found.start_ns, start_ns) > 0.5 * (end_ns - start_ns)
    assert any(each.completeness is not None for each in given if not each.final)


def test_the_page_puts_it_into_use(folder: Path, tmp_path: Path) -> None:
    teacher, model = Teacher(tmp_path), load_model(folder / "model.npz")
    model.save(tmp_path / "models" / "taught.npz")
    assert [each["id"] for each in teacher.ask("list")["models"]] == [model.id]
    teacher.ask("activate", model=model.id)
    assert load_model(teacher.model).id == model.id
    assert teacher.ask("state")["model"] == model.id


def test_its_search_is_tuned(folder: Path) -> None:
    said = told(folder, "tune", "model.npz", "three.mcap")
    assert "6 actions, " in said and "the model works best with its own values" in said


def test_it_is_drawn_as_far_as_it_goes_without_maps(folder: Path) -> None:
    lack = "the model has no maps: models of kind 'nearest' contain none"
    assert f"{lack}: give recordings in addition to the model" in told(
        folder, "inspect", "model.npz", "-o", "pictures", code=1
    )
    told(folder, "inspect", "model.npz", "three.mcap", "-o", "pictures", "--format", "svg")
    drawn = {path.stem for path in (folder / "pictures").glob("*.svg")}
    assert {"confusion", "time-lift"} <= drawn and not any("map" in name or "trace" in name for name in drawn)
    assert lack.replace("'", "&#x27;") in (folder / "pictures" / "index.html").read_text()
    commands = {each.name: each for each in SomClassifier(load_model(folder / "model.npz")).commands}
    with pytest.raises(Refusal, match=lack):
        commands["maps"].obey({})


def test_it_has_no_settings_to_change(folder: Path) -> None:
    words = "one.mcap", "-o", "other.npz", "--preset", "nearest", "--set", "origin=hips"
    assert "preset nearest has no settings" in told(folder, "train", *words, code=1)


def test_a_file_that_another_version_made_otherwise_is_refused_by_that_version_s_name(folder: Path) -> None:
    with np.load(folder / "model.npz") as file:
        arrays = {**file, "examples": file["examples"][..., :-3]}
    arrays["metadata"] = np.array(str(arrays["metadata"]).replace('"actum_version": "', '"actum_version": "9'))
    np.savez(folder / "old.npz", **arrays)
    with pytest.raises(
        ModelError,
        match=r"actum 9.* made the model, .*its examples are of shape.*train a new model from the same recordings",
    ):
        load_model(folder / "old.npz")
