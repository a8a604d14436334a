"""The model file that a user names: it is used, followed, and never written."""

from pathlib import Path

import pytest

from actum_model_trainer.training import train
from performers import TINY, TINY_PAPER
from recognisers import tiny_model, tiny_samples
from som_classifier.model_loading import load_model
from teaching import Teacher

LOOKS = 12
"""Ticks in which the trainer has looked at its files at least once."""


@pytest.fixture
def teacher(tmp_path: Path) -> Teacher:
    """A trainer that was given a file of the user's, and has a model of its own besides."""
    made = Teacher(tmp_path)
    made.original.parent.mkdir()
    tiny_model(TINY_PAPER).save(made.original)
    tiny_model().save(tmp_path / "models" / "taught.npz")
    made.tick(LOOKS)
    return made


def ids(teacher: Teacher) -> tuple[str, str]:
    """The ids of the user's model and of the other one."""
    own = load_model(teacher.original).id
    (other,) = {each["id"] for each in teacher.ask("list")["models"]} - {own}
    return own, other


def test_the_file_is_copied_for_the_classifier_and_named(teacher: Teacher) -> None:
    assert teacher.model.read_bytes() == teacher.original.read_bytes()
    state = teacher.ask("state")
    assert (state["model"], state["model_file"]) == (ids(teacher)[0], str(teacher.original))


def test_putting_models_into_use_and_back_never_writes_the_users_file(teacher: Teacher) -> None:
    before, (own, other) = teacher.original.read_bytes(), ids(teacher)
    teacher.ask("activate", model=other)
    assert teacher.tick(LOOKS).model == load_model(teacher.model).id == other
    assert (teacher.told[-1].model_file, teacher.told[-1].can_undo) == (None, True)
    teacher.ask("undo")
    assert (teacher.tick(LOOKS).model, teacher.told[-1].model_file) == (own, str(teacher.original))
    assert teacher.original.read_bytes() == before


def test_what_is_put_into_use_is_stored_for_the_next_run(teacher: Teacher) -> None:
    lasting = teacher.folder / "model.npz"
    assert not lasting.exists(), "a named file is for one run"
    own, other = ids(teacher)
    teacher.ask("activate", model=other)
    assert load_model(lasting).id == other
    teacher.ask("undo")
    assert load_model(lasting).id == own


def test_a_model_that_was_stored_for_the_next_run_is_kept_before_it_is_replaced(teacher: Teacher) -> None:
    (teacher.folder / "model.npz").write_text("my notes")
    with pytest.raises(Exception, match=r"model.npz cannot be read as a model and would be overwritten"):
        teacher.ask("activate", model=ids(teacher)[1])
    assert (teacher.folder / "model.npz").read_text() == "my notes"


def test_a_changed_file_is_put_into_use_and_can_be_undone(teacher: Teacher) -> None:
    _, other = ids(teacher)
    teacher.ask("activate", model=other)
    train(tiny_samples()[1:], TINY).save(teacher.original)
    changed = load_model(teacher.original).id
    assert (teacher.tick(LOOKS).model, teacher.told[-1].model_file) == (changed, str(teacher.original))
    teacher.ask("undo")
    assert teacher.tick(LOOKS).model == other


def test_a_trainer_that_starts_anew_leaves_the_model_that_was_put_into_use(teacher: Teacher) -> None:
    _, other = ids(teacher)
    teacher.ask("activate", model=other)
    teacher.begin()
    assert teacher.tick(LOOKS).model == other


def test_a_file_that_comes_later_is_put_into_use_then(tmp_path: Path) -> None:
    teacher = Teacher(tmp_path)
    assert teacher.tick(LOOKS).model is None
    assert teacher.trainer.counters.state == f"no model: there is no {teacher.original} yet"
    teacher.original.parent.mkdir()
    tiny_model().save(teacher.original)
    assert teacher.tick(LOOKS).model == load_model(teacher.original).id
    assert teacher.trainer.counters.state == "running"


def test_a_damaged_file_is_counted_once_and_the_model_before_stays(teacher: Teacher) -> None:
    own, _ = ids(teacher)
    teacher.original.write_text("damaged")
    assert teacher.tick(5 * LOOKS).model == own
    assert teacher.trainer.counters.rejects == {"bad_model": 1}
    assert teacher.trainer.counters.state.startswith(
        f"model not renewed: {teacher.original}: the file is not a model of actum"
    )
