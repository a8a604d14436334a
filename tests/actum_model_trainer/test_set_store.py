"""Two trainers may share a folder: neither removes what the other is recording, nor overwrites its takes."""

from itertools import count
from pathlib import Path

from actum_model_trainer.teaching.set_store import MAKING, SetStore
from empty_messages import skeleton


def test_a_trainer_that_starts_leaves_the_take_that_another_is_recording(tmp_path: Path) -> None:
    times = count(1)
    first = SetStore(tmp_path, lambda: next(times))
    first.create("waves")
    recorder = first.recorder("anna", "action")
    recorder.write(skeleton(1))
    killed = first.recorder("carl", "action")
    killed.abandon()
    second = SetStore(tmp_path, lambda: next(times))
    assert [file.name for file in (tmp_path / MAKING).iterdir()] == [f"{recorder.path.name}.part"]
    recorder.close()
    assert first.add("waves", recorder.path).person == "anna"
    SetStore(tmp_path, lambda: next(times))
    assert not (tmp_path / MAKING).exists()
    assert [take.person for take in second.get("waves").takes] == ["anna"]


def test_a_take_of_a_set_is_not_overwritten(tmp_path: Path) -> None:
    times = count(1)
    store = SetStore(tmp_path, lambda: next(times))
    store.create("waves")
    for person in ("anna", "carl"):
        with store.recorder(person, "action") as recorder:
            recorder.write(skeleton(1))
        store.add("waves", recorder.path)
    assert [(take.id, take.person) for take in store.get("waves").takes] == [
        ("take-0001", "anna"),
        ("take-0002", "carl"),
    ]
