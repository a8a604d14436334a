"""The journal gives back what was written, whatever happened to the file in between."""

import errno
import shutil
import zlib
from collections.abc import Sequence
from contextlib import closing
from pathlib import Path
from typing import BinaryIO, NoReturn

import msgpack
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum import keys
from actum.codec import Frame
from actum.messages import Message
from actum.node import Counters
from actum.runtime import journal as journals
from actum.runtime.journal import Journal
from actum.runtime.resuming import Resumption
from actum.settings import RememberingSettings

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
@given(answers=st.lists(frames, min_size=1, max_size=8), later=st.lists(frames, max_size=4), data=st.data())
def test_a_file_torn_anywhere_gives_a_beginning_of_what_was_added_and_takes_more(
    answers: list[Frame], later: list[Frame], data: st.DataObject, tmp_path: Path
) -> None:
    path = tmp_path / "a.journal"
    content = written(path, answers)
    cut = data.draw(st.integers(0, len(content)))
    path.write_bytes(content[:cut])
    found = read(path)
    assert found == answers[: len(found)]
    add(path, later)
    assert read(path) == found + later
    whole = [len(written(path, answers[:n])) for n in range(len(answers) + 1)]
    assert len(found) == max((n for n, size in enumerate(whole) if size <= cut), default=0)


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


def frame(number: int) -> Frame:
    return Frame("actum/kinect0/event/1", bytes(100), "application/msgpack;actum.event/1", str(number).encode())


class Remembers:
    answers, is_busy = keys.EVENT, False

    def remember(self, answers: Sequence[Message]) -> None:
        pass


def resumption(path: Path) -> tuple[Resumption, Counters]:
    counters = Counters()
    return Resumption(Remembers(), Journal(path), counters), counters


def failing(*_: object, **__: object) -> NoReturn:
    raise OSError(errno.ENOSPC, "No space left on device", "the disk")


class Torn:
    """A file of which the disk takes the first bytes of a record and no more, or that fails when it is closed."""

    broken = True

    def __init__(self, file: BinaryIO, step: str) -> None:
        self._file, self._step = file, step

    def __getattr__(self, name: str) -> object:
        return getattr(self._file, name)

    def write(self, record: bytes) -> int:
        if self._step != "write" or not self.broken:
            return self._file.write(record)
        if len(record) <= 5:
            failing()
        return self._file.write(record[:5])

    def close(self) -> None:
        self._file.close()
        if self._step == "close" and self.broken:
            failing()


def break_step(patch: pytest.MonkeyPatch, step: str, path: Path) -> None:
    """Have one step fail of all that writing an answer or setting a full file aside consists of."""
    opened = Path.open
    if step == "replace":
        patch.setattr(Path, "replace", failing)
    elif step == "open":
        patch.setattr(Path, "open", failing)
    elif step in ("write", "close"):
        patch.setattr(Path, "open", lambda file, *args, **more: Torn(opened(file, *args, **more), step))
    elif step == "sync":
        patch.setattr(journals.os, "fsync", failing)
    else:
        shutil.rmtree(path.parent)
        if step == "folder and its parent":
            path.parent.parent.rmdir()
            path.parent.parent.write_bytes(b"")


def open_files() -> int:
    return len(list(Path("/proc/self/fd").iterdir()))


STEPS = ("replace", "open", "write", "close", "sync", "folder", "folder and its parent")


@pytest.mark.parametrize("full", [True, False], ids=["full", "with room"])
@pytest.mark.parametrize("step", STEPS)
def test_whatever_step_fails_answers_go_on_the_failure_is_counted_and_it_writes_again(
    step: str, full: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "parent" / "state" / "a.journal"
    kept, counters = resumption(path)
    kept._keep(frame(0))
    handles = open_files()
    with monkeypatch.context() as patch:
        patch.setattr(journals, "FULL_BYTES", 0 if full else 8_000_000)
        if step in ("open", "write", "close") and not full:
            kept.close()
        break_step(patch, step, path)
        for number in range(1, 20):
            kept._keep(frame(number))
            try:
                kept.store()
            except OSError as error:
                kept.report(error)
    monkeypatch.setattr(Torn, "broken", False)
    if step == "folder and its parent":
        path.parent.parent.unlink()
    if full or step not in ("replace", "close"):
        assert counters.rejects["unwritable_state"] > 0, "what is not on the disk is counted"
    kept.store()
    for number in range(20, 23):
        kept._keep(frame(number))
    assert open_files() <= handles + 1, "no file is left open"
    kept.close()
    found = [int(frame.attachment) for frame in read(path)]
    assert found[-3:] == [20, 21, 22] and found == sorted(found)
    if step in ("replace", "sync"):
        assert found[0] == 0 or full


def test_nothing_that_stands_in_the_file_goes_with_a_disk_that_is_full(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.journal"
    kept, counters = resumption(path)
    kept._keep(frame(0))
    kept.close()
    with monkeypatch.context() as patch:
        break_step(patch, "write", path)
        kept._keep(frame(1))
    kept._keep(frame(2))
    kept.close()
    assert counters.rejects == {"unwritable_state": 1}
    assert [int(frame.attachment) for frame in read(path)] == [0, 2]


def test_a_full_file_that_cannot_be_set_aside_keeps_every_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(journals, "FULL_BYTES", 0)
    path = tmp_path / "a.journal"
    kept, counters = resumption(path)
    with monkeypatch.context() as patch:
        break_step(patch, "replace", path)
        for number in range(5):
            kept._keep(frame(number))
    kept.close()
    assert counters.rejects == {"unwritable_state": 5}
    assert [int(frame.attachment) for frame in read(path)] == [0, 1, 2, 3, 4]


def test_what_is_written_is_stored_once_a_second_and_not_beside_every_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    synced: list[int] = []
    monkeypatch.setattr(journals.os, "fsync", synced.append)
    kept, _ = resumption(tmp_path / "a.journal")
    kept.store()
    synced.clear()
    for number in range(5):
        kept._keep(frame(number))
    assert not synced
    kept.store()
    assert synced
    synced.clear()
    kept.store()
    assert not synced, "nothing is new"
    kept.close()


def test_a_file_that_cannot_be_read_is_counted_and_written_again_once_that_is_possible(tmp_path: Path) -> None:
    counters = Counters()
    path = tmp_path / "kinect0-fusion.journal"
    path.mkdir()
    kept = Resumption.of(Remembers(), "fusion", RememberingSettings(state=tmp_path), counters)
    assert kept is not None and counters.rejects == {"unwritable_state": 1}
    path.rmdir()
    kept._keep(frame(1))
    kept.close()
    assert counters.rejects == {"unwritable_state": 1} and read(path) == [frame(1)]


def test_answers_of_another_form_are_left_out(tmp_path: Path) -> None:
    path = tmp_path / "a.journal"
    bodies = [["soon", "key", b"", "", b""], [None], [1, 2, 3, 4, 5], "text", [2**63, "key", b"", "", b""]]
    written(path, [])
    with path.open("ab") as file:
        for body in map(msgpack.packb, bodies):
            file.write(journals.HEAD.pack(journals.MAGIC, len(body), zlib.crc32(body)) + body)
    add(path, [frame(1)])
    assert read(path) == [frame(1)]
