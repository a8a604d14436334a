"""Two trainers may share a folder: neither removes what the other is recording, nor overwrites its takes."""

from itertools import count
from pathlib import Path

import pytest

from actum.messages import segment_marks
from actum.recording import RecordingError
from empty_messages import skeleton
from model_trainer.set_store import MAKING, SetStore, take_number


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


def test_a_newer_take_has_a_higher_number_also_where_one_is_missing_or_the_clock_was_set_back(tmp_path: Path) -> None:
    times = iter([400, 301, 302, 201, 202, 101, 102])
    store = SetStore(tmp_path, lambda: next(times))
    store.create("waves")
    for person in ("anna", "carl", "dora"):
        with store.recorder(person, "action") as recorder:
            recorder.write(skeleton(1))
        if store.add("waves", recorder.path).person == "carl":
            (tmp_path / "waves/take-0001.mcap").unlink()
    takes = store.get("waves").takes
    assert [(take.id, take.person) for take in takes] == [("take-0002", "carl"), ("take-0003", "dora")]
    assert max(takes, key=lambda take: take_number(take.id)).person == "dora"


def test_a_take_with_more_examples_than_can_be_changed_at_once_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("model_trainer.stored_set.MOST_SEGMENTS", 1)
    store = SetStore(tmp_path, lambda: 1)
    store.create("waves")
    with store.recorder("anna", "action") as recorder:
        for message in [skeleton(stamp_ns) for stamp_ns in range(1, 9)]:
            recorder.write(message)
        for number in (1, 2):
            for each in segment_marks(2 * number, 2 * number + 1, "kinect0", f"wave-{number}", "wave"):
                recorder.write(each)
    with pytest.raises(
        RecordingError, match="the recording has 2 actions with a start and an end; at most 1 are allowed; delete"
    ):
        store.add("waves", recorder.path)
    assert "2 actions with a start" in store.get("waves").unreadable[0]
