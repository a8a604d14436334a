"""A model file may not be there yet, may change, and may be anything."""

from pathlib import Path

from actum.node import Counters
from performers import TINY
from recognisers import tiny_model
from som_classifier.watched_model import WatchedModel


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
