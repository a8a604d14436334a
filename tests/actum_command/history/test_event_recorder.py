"""The service that keeps events: what is stored, when files are finished, what a killed process leaves."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import events
from actum.limits import MAX_SKEW_NS
from actum.messages import AUTO, MANUAL, Event, Message, Segment
from actum.node import SECOND_NS, SETTLE_NS, Tick
from actum.recording import Recording
from actum_command.history.event_files import HOUR_NS, EventFiles
from actum_command.history.event_recorder import EventRecorder
from actum_command.history.settings import Settings
from actum_examples.unstamped_marks import MOST_ANSWERED, MOST_MARKS
from empty_messages import action, mark, skeleton

START_NS = 1_795_417_800 * SECOND_NS


def event(segment_id: str, start_ns: int, end_ns: int) -> Event:
    stamps = {"stamp_ns": end_ns, "start_ns": start_ns, "end_ns": end_ns}
    return events.event(segment_id, "pushed the cup").model_copy(update=stamps)


def full(*_: object) -> None:
    raise OSError(28, "No space left on device")


class History:
    """A recorder in a folder, whose clocks a test sets."""

    def __init__(self, folder: Path, **settings: Any) -> None:
        self.folder, self.now_ns = folder, 0
        self._files = EventFiles(folder, "kinect0", Settings(**settings))
        self.recorder = EventRecorder(self._files, lambda: START_NS + self.now_ns)
        self.tick()

    def tick(self, passed_s: float = 0.0) -> None:
        self.now_ns += round(passed_s * SECOND_NS)
        self.recorder.handle(Tick(self.now_ns))

    def receive(self, *messages: Message) -> None:
        for message in messages:
            assert self.recorder.handle(message) == []

    @property
    def names(self) -> list[str]:
        return [file.name for file in sorted(self.folder.iterdir())]

    @property
    def numbers(self) -> list[str]:
        return [name.split("-")[2] for name in self.names]

    def said(self) -> list[str]:
        """The segments that are stored, in order."""
        return [message.segment_id for message in self.stored()]  # type: ignore[attr-defined]

    def stored(self) -> list[Message]:
        return [message for name in self.names for message in Recording(self.folder / name).messages()]


@pytest.fixture
def history(tmp_path: Path) -> Iterator[History]:
    made = History(tmp_path)
    yield made
    made.recorder.close()


def marks(history: History) -> list[tuple[str, str, int | None]]:
    return [(m.segment_id, m.kind, m.stamp_ns) for m in history.stored() if isinstance(m, Segment)]


def test_events_final_actions_and_all_marks_are_kept_and_nothing_else(history: History) -> None:
    kept = [mark("start", 7, origin=AUTO), mark("end", 9, origin=MANUAL), action(7, 9), event("one", 7, 9)]
    history.receive(*kept, action(7, None, final=False), skeleton(8))
    history.recorder.close()
    assert sorted(type(message).__name__ for message in history.stored()) == ["Action", "Event", "Segment", "Segment"]
    assert history.names == ["events-kinect0-000001-20261123T071000Z.mcap"]


def test_a_mark_without_a_stamp_has_that_of_its_answer_also_where_it_comes_later(history: History) -> None:
    history.receive(mark("start"), action(11, 31), mark("end"))
    history.recorder.close()
    assert marks(history) == [("one", "start", 11), ("one", "end", 31)]


def test_a_mark_that_nothing_answers_is_counted(history: History) -> None:
    history.receive(mark("start"))
    history.tick(SETTLE_NS / SECOND_NS + 1)
    assert history.recorder.counters.rejects == {"mark_without_stamp": 1}


def test_a_name_that_is_used_again_after_a_restart_gets_the_stamps_of_its_own_answer(history: History) -> None:
    """At once, without its first marks, while marks of before wait, and where the answer of before comes again."""
    before, after = action(11, 31, session_id="a"), action(5, 25, session_id="b")
    history.receive(mark("start"), before, mark("end"), mark("start"), mark("end"), before, after)
    history.receive(action(1, 2, "two", session_id="a"), mark("start", segment_id="two"))
    history.receive(action(8, 9, "two", session_id="b"), mark("end", segment_id="two"))
    history.receive(mark("start", segment_id="lost"), mark("start", segment_id="lost"), mark("end", segment_id="lost"))
    history.receive(action(6, 7, "lost", session_id="b"))
    history.receive(mark("start", 40, "stamped"), mark("end", 50, "stamped"), action(40, 50, "stamped", session_id="a"))
    history.receive(mark("start", segment_id="stamped"), action(60, 70, "stamped", session_id="b"))
    history.recorder.close()
    assert sorted(marks(history)) == sorted(
        [
            *[("one", "start", 11), ("one", "end", 31), ("one", "start", 5), ("one", "end", 25)],
            *[("two", "start", 8), ("two", "end", 9)],
            *[("lost", "start", 6), ("lost", "end", 7)],
            *[("stamped", "start", 40), ("stamped", "end", 50), ("stamped", "start", 60)],
        ]
    )
    assert history.recorder.counters.rejects == {"mark_without_stamp": 1}, "of the one that was lost"


def test_a_name_that_is_used_again_later_is_not_that_of_the_answer_before(history: History) -> None:
    history.receive(action(11, 31))
    history.tick(MAX_SKEW_NS / SECOND_NS + 1)
    history.receive(mark("start"))
    history.tick(SETTLE_NS / SECOND_NS + 1)
    assert history.recorder.counters.rejects == {"mark_without_stamp": 1}
    assert marks(history) == []


def test_a_late_mark_is_stored_once_no_other_answer_follows(history: History) -> None:
    history.receive(mark("start"), action(11, 31), mark("end"))
    history.tick(MAX_SKEW_NS / SECOND_NS + 1)
    history.tick(1.0)
    assert marks(history) == [("one", "start", 11), ("one", "end", 31)]


def test_two_sensors_may_have_segments_of_one_name(history: History) -> None:
    other = mark("start").model_copy(update={"sensor": "kinect1"})
    history.receive(mark("start"), other, action(11, 31).model_copy(update={"sensor": "kinect1"}), action(1, 2))
    history.recorder.close()
    stored = [(m.sensor, m.stamp_ns) for m in history.stored() if isinstance(m, Segment)]
    assert sorted(stored) == [("kinect0", 1), ("kinect1", 11)]


def test_marks_that_cannot_be_stored_are_counted_one_by_one(history: History, monkeypatch: pytest.MonkeyPatch) -> None:
    history.receive(mark("start"), mark("end"))
    monkeypatch.setattr("actum.recorder.Recorder.write", full)
    history.receive(action(11, 31))
    assert history.recorder.counters.rejects == {"unwritable_history": 3}


def test_marks_without_end_do_not_fill_the_memory(history: History) -> None:
    history.receive(*(mark("start", segment_id=f"s{i}") for i in range(MOST_MARKS + 5)))
    assert history.recorder.counters.rejects == {"mark_without_stamp": 5}
    history.receive(*(action(1, 2, f"a{i}") for i in range(MOST_ANSWERED + 5)))
    assert len(history.recorder._marks._answered) == MOST_ANSWERED


def test_where_nothing_happens_there_is_no_file(history: History) -> None:
    history.tick(2 * 24 * 3600)
    assert history.names == []


def test_a_file_is_finished_by_age(history: History) -> None:
    history.receive(event("a", 1, 2))
    history.tick(23.9 * 3600)
    assert history.names == ["events-kinect0-000001-20261123T071000Z.mcap.part"]
    history.tick(0.2 * 3600)
    history.receive(event("b", 3, 4))
    history.tick(1.0)
    assert history.numbers == ["000001", "000002"]
    assert [name.endswith(".part") for name in history.names] == [False, True]
    assert 24 * 3600 * SECOND_NS == 24 * HOUR_NS


def test_files_are_finished_by_size_and_the_oldest_make_room(tmp_path: Path) -> None:
    history = History(tmp_path, history_file_mb=0.05, history_keep_files=3)
    for number in range(600):
        history.receive(event(f"s{number}", number, number + 1))
    history.recorder.close()
    history.tick()
    finished = history.recorder.counters.counts["files"]
    assert finished > 4
    assert history.numbers == [f"{n:06d}" for n in range(finished - 2, finished + 1)]
    assert history.recorder.counters.counts["deleted"] == finished - 3
    assert all(file.stat().st_size < 100_000 for file in tmp_path.iterdir())
    newest = history.said()
    assert newest == [f"s{number}" for number in range(600 - len(newest), 600)], "in order, up to the last"


def test_the_oldest_make_room_by_size(tmp_path: Path) -> None:
    history = History(tmp_path, history_file_mb=0.05, history_keep_mb=0.3)
    for number in range(900):
        history.receive(event(f"s{number}", number, number + 1))
    history.recorder.close()
    assert len(history.names) > 1 and sum(file.stat().st_size for file in tmp_path.iterdir()) <= 300_000


def test_names_stay_in_order_where_the_clock_is_set_back(history: History) -> None:
    history.receive(event("a", 1, 2))
    history.recorder.close()
    history.recorder._received_ns = lambda: START_NS - HOUR_NS
    history.receive(event("b", 3, 4))
    history.recorder.close()
    assert history.said() == ["a", "b"]


def test_what_a_killed_process_left_is_finished_by_the_next(tmp_path: Path) -> None:
    killed = History(tmp_path)
    killed.receive(*(event(f"s{number}", number, number + 1) for number in range(20)))
    killed.tick(1.0)  # what was written a second ago stands on the disk
    killed._files._abandon()
    [part] = tmp_path.iterdir()
    whole = part.read_bytes()
    part.write_bytes(whole[:-100])  # a power cut tears the last message
    after = History(tmp_path)
    assert [file.suffix for file in tmp_path.iterdir()] == [".mcap"]
    assert after.said() == [f"s{number}" for number in range(19)]
    after.receive(event("later", 50, 51))
    assert after.numbers == ["000001", "000002"]
    after.recorder.close()


def test_what_the_process_before_has_stored_is_not_stored_once_more(tmp_path: Path) -> None:
    told = mark("start", 1, "a"), event("a", 1, 2), event("a", 3, 4)
    stored = [message.model_copy(update={"seq": number}) for number, message in enumerate(told)]
    before = History(tmp_path)
    before.receive(*stored)
    before.recorder.close()
    after = History(tmp_path)
    after.receive(*stored[1:], event("a", 5, 6))
    after.recorder.close()
    assert after.said() == ["a", "a", "a", "a"]
    assert len({message.stamp_ns for message in after.stored()}) == 4


def test_what_another_process_is_writing_is_left_to_it(tmp_path: Path) -> None:
    other = History(tmp_path)
    other.receive(event("its", 1, 2))
    after = History(tmp_path)
    assert after.recorder.counters.rejects == {"unreadable_history": 1}
    after.receive(event("ours", 3, 4))
    other.receive(event("its too", 5, 6))
    for each in (other, after):
        each.recorder.close()
    assert after.said() == ["its", "its too", "ours"]


def test_what_is_recovered_is_what_was_left_and_not_what_is_being_written(tmp_path: Path) -> None:
    """Also where the first message comes before the first tick."""
    files = EventFiles(tmp_path, "kinect0", Settings())
    recorder = EventRecorder(files, lambda: START_NS)
    recorder.handle(event("a", 1, 2))
    recorder.handle(Tick(0))
    recorder.handle(event("b", 3, 4))
    recorder.close()
    [file] = tmp_path.iterdir()
    assert [message.segment_id for message in Recording(file).messages()] == ["a", "b"]  # type: ignore[attr-defined]


def test_what_cannot_be_read_is_left_and_counted(tmp_path: Path) -> None:
    (tmp_path / "events-kinect0-000003-20261123T071000Z.mcap.part").write_bytes(b"no recording at all")
    history = History(tmp_path)
    assert history.recorder.counters.rejects == {"unreadable_history": 1}
    history.receive(event("a", 1, 2))
    assert history.numbers == ["000003", "000004"]
    history.recorder.close()


def test_other_sensors_and_other_files_are_left_alone(tmp_path: Path) -> None:
    others = ["events-kinect0-left-000009-20261123T071000Z.mcap.part", "mine.mcap", "events-kinect0-notes.txt"]
    for name in others:
        (tmp_path / name).write_bytes(b"x")
    history = History(tmp_path, history_keep_files=1)
    for name in ("a", "b"):
        history.receive(event(name, 1, 2))
        history.recorder.close()
    assert {*others} < {*history.names}
    assert len(history.names) == len(others) + 1


def test_a_full_disk_is_told_and_survived(history: History, monkeypatch: pytest.MonkeyPatch) -> None:
    history.receive(event("a", 1, 2))
    with monkeypatch.context() as there:
        there.setattr("actum.recorder.Recorder.write", full)
        history.receive(event("lost", 3, 4))
    assert history.recorder.counters.rejects == {"unwritable_history": 1}
    assert history.recorder.counters.state.startswith("history not written: No space left on device")
    history.receive(event("b", 5, 6))
    assert history.recorder.counters.state == "running"
    history.recorder.close()
    assert history.said() == ["a", "b"]
