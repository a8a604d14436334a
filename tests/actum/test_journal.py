"""The journal gives back what was written, whatever happened to the file in between."""

from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum.codec import Frame
from actum.runtime import journal as journals
from actum.runtime.journal import Journal

frames = st.builds(
    Frame,
    key=st.sampled_from(["actum/kinect0/event/1", "actum/kinect0/action/2"]),
    payload=st.binary(max_size=200) | st.just(journals.MAGIC * 3),
    encoding=st.just("application/msgpack;actum.event/1"),
    attachment=st.binary(max_size=12),
)
in_one_folder = settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)


def written(path: Path, answers: list[Frame]) -> bytes:
    path.unlink(missing_ok=True)
    add(path, answers)
    return path.read_bytes()


def add(path: Path, answers: list[Frame]) -> None:
    with closing(Journal(path)) as journal:
        for frame in answers:
            journal.add(frame)


def read(path: Path) -> list[Frame]:
    journal = Journal(path)
    journal.close()
    return [answer.frame for answer in journal.answers]


@in_one_folder
@given(answers=st.lists(frames, max_size=8))
def test_what_is_added_is_there_when_it_is_opened_again(answers: list[Frame], tmp_path: Path) -> None:
    path = tmp_path / "state" / "a.journal"
    written(path, answers)
    assert read(path) == answers
    assert read(path) == answers, "opening it changes nothing"


@in_one_folder
@given(answers=st.lists(frames, min_size=1, max_size=8), data=st.data())
def test_a_file_torn_anywhere_gives_a_beginning_of_what_was_added(
    answers: list[Frame], data: st.DataObject, tmp_path: Path
) -> None:
    path = tmp_path / "a.journal"
    content = written(path, answers)
    cut = data.draw(st.integers(0, len(content)))
    path.write_bytes(content[:cut])
    found = read(path)
    assert found == answers[: len(found)]
    whole = [len(written(path, answers[:n])) for n in range(len(answers) + 1)]
    assert len(found) == max((n for n, size in enumerate(whole) if size <= cut), default=0)


@in_one_folder
@given(answers=st.lists(frames, min_size=1, max_size=4), later=st.lists(frames, max_size=4), data=st.data())
def test_what_is_added_behind_a_torn_end_is_read(
    answers: list[Frame], later: list[Frame], data: st.DataObject, tmp_path: Path
) -> None:
    path = tmp_path / "a.journal"
    content = written(path, answers)
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    before = read(path)
    add(path, later)
    assert read(path) == before + later


@in_one_folder
@given(answers=st.lists(frames, min_size=1, max_size=8), data=st.data())
def test_a_flipped_bit_costs_one_record(answers: list[Frame], data: st.DataObject, tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    content = bytearray(written(path, answers))
    bit = data.draw(st.integers(0, 8 * len(content) - 1))
    content[bit // 8] ^= 1 << bit % 8
    path.write_bytes(bytes(content))
    found = read(path)
    assert len(found) >= len(answers) - 1
    remaining = iter(answers)
    assert all(frame in remaining for frame in found), "what is read was added, in that order"


@in_one_folder
@given(garbage=st.binary(max_size=300))
def test_a_file_of_anything_is_read_as_nothing(garbage: bytes, tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    path.write_bytes(garbage)
    assert read(path) == []


def test_old_answers_are_dropped_when_it_is_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.journal"
    written(path, [frame(1)])
    now_ns = journals.time.time_ns() + round((journals.KEPT_S + 1) * 1e9)
    monkeypatch.setattr(journals.time, "time_ns", lambda: now_ns)
    assert read(path) == []


def test_how_long_all_answers_are_known_outlives_the_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.journal"
    written(path, [frame(1)])
    later_ns = journals.time.time_ns() + 30 * 10**9
    monkeypatch.setattr(journals.time, "time_ns", lambda: later_ns)
    with closing(Journal(path)) as old, closing(Journal(tmp_path / "new.journal")) as new:
        assert old.age_s == pytest.approx(30.0, abs=1.0)
        assert new.age_s == 0.0


def test_the_files_stay_bounded_and_keep_the_newest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(journals, "FULL_BYTES", 4000)
    path = tmp_path / "a.journal"
    with closing(Journal(path)) as journal:
        for number in range(500):
            journal.add(frame(number))
            assert sum(file.stat().st_size for file in tmp_path.iterdir()) < 2 * (4000 + 300)
    found = read(path)
    assert found == [frame(n) for n in range(500 - len(found), 500)]
    assert sum(len(f.payload) for f in found) > 2000


def test_a_process_that_is_killed_while_a_full_file_is_set_aside_loses_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    written(path, [frame(1)])
    path.rename(tmp_path / "a.journal.before")
    with closing(Journal(path)) as journal:
        assert not journal.is_new
        journal.add(frame(2))
    assert read(path) == [frame(1), frame(2)]


def test_where_a_full_file_cannot_be_set_aside_answers_are_added_to_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.journal"
    with closing(Journal(path)) as journal:
        (tmp_path / "a.journal.before").mkdir()
        with monkeypatch.context() as patch:
            patch.setattr(journals, "FULL_BYTES", 0)
            with pytest.raises(OSError, match="a.journal"):
                journal.add(frame(1))
        journal.add(frame(2))
    (tmp_path / "a.journal.before").rmdir()
    assert read(path) == [frame(1), frame(2)]


def frame(number: int) -> Frame:
    return Frame("actum/kinect0/event/1", bytes(100), "application/msgpack;actum.event/1", str(number).encode())
