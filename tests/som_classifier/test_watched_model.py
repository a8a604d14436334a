"""A model file may not be there yet, may change, and may be anything."""

import errno
from pathlib import Path
from typing import NoReturn

import pytest

from actum.node import Counters
from performers import TINY
from recognisers import tiny_model
from som_classifier.model_loading import WatchedModel


def test_a_file_is_loaded_once_and_again_when_it_changes(tmp_path: Path) -> None:
    path, counters = tmp_path / "model.npz", Counters()
    file = WatchedModel(path)
    assert file.poll(counters) is None
    tiny_model(TINY).save(path)
    loaded = file.poll(counters)
    assert loaded is not None
    assert loaded.id == tiny_model(TINY).id
    assert file.poll(counters) is None
    path.write_bytes(b"no model")
    assert file.poll(counters) is None
    assert counters.rejects == {"bad_model": 1}


def test_a_path_that_cannot_be_looked_at_is_counted(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    counters = Counters()
    assert WatchedModel(tmp_path / "file" / "model.npz").poll(counters) is None
    assert counters.rejects == {"bad_model": 1}


def test_a_file_that_may_be_read_or_is_back_is_loaded_and_the_state_does_not_say_otherwise(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, counters = tmp_path / "folder" / "model.npz", Counters()
    path.parent.mkdir()
    tiny_model(TINY).save(path)
    file = WatchedModel(path)
    monkeypatch.setattr(Path, "open", refuse)  # whoever runs the tests as root may read everything
    assert file.poll(counters) is None
    monkeypatch.undo()
    path.chmod(0o644)
    assert file.poll(counters) is not None
    path.parent.rename(tmp_path / "aside")
    path.parent.touch()
    assert file.poll(counters) is None
    assert counters.state.startswith("model not renewed")
    path.parent.unlink()
    (tmp_path / "aside").rename(path.parent)
    assert file.poll(counters) is not None


def refuse(self: Path, *_: object) -> NoReturn:
    raise PermissionError(errno.EACCES, "Permission denied", str(self))
