"""A play is the recordings in a row as one live session, and tells no answers."""

import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from unittest.mock import Mock

import pytest

from actum import keys
from actum.joining import PAUSE_NS
from actum.messages import AUTO, REPLAY, Image, Message, Objects, Posture, Segment, Skeleton
from actum.recorder import write_recording
from actum.recording import Recording
from actum_command.streaming import playable_topics, put_all, schedule
from empty_messages import action, image, mark, skeleton

Record = Callable[..., Recording]


@pytest.fixture
def record(tmp_path: Path) -> Record:
    def write(name: str, *messages: Message) -> Recording:
        path = tmp_path / f"{name}.mcap"
        write_recording(path, messages, person="1", source="test")
        return Recording(path)

    return write


def posture(stamp_ns: int) -> Posture:
    return Posture(
        stamp_ns=stamp_ns,
        sensor="kinect0",
        agent=1,
        joints_m=None,
        joints=None,
        ego_from_camera=None,
        motion=None,
        session_id="then",
    )


def objects(stamp_ns: int) -> Objects:
    return Objects(stamp_ns=stamp_ns, sensor="kinect0", objects=[], session_id="then")


def play(*recordings: Recording, start_ns: int = 0, sensor: str = "kinect0") -> list[Message]:
    return list(schedule(recordings, "play", start_ns, sensor))


def marks_of(played: Sequence[Message]) -> list[Segment]:
    return [message for message in played if isinstance(message, Segment)]


def test_each_recording_is_shifted_whole_and_marks_move_with_their_frames(record: Record) -> None:
    first = record("first", mark("start", 100), skeleton(100), skeleton(133), mark("end", 133))
    second = record("second", skeleton(7), mark("start", 9, "two"), skeleton(40), mark("end", 40, "two"))
    played = play(first, second, start_ns=1000)
    begin = 1033 + PAUSE_NS
    assert [(type(message), message.stamp_ns) for message in played] == [
        (Segment, 1000),
        (Skeleton, 1000),
        (Skeleton, 1033),
        (Segment, 1033),
        (Skeleton, begin),
        (Segment, begin + 2),
        (Skeleton, begin + 33),
        (Segment, begin + 33),
    ]


def test_numbers_keep_their_gaps_and_go_on_between_recordings(record: Record) -> None:
    first = record("first", skeleton(1, 3), skeleton(2, 5), image(2))
    second = record("second", image(3), skeleton(3, 50), skeleton(4, 51))
    played = play(first, second)
    assert [m.seq for m in played if isinstance(m, Skeleton)] == [3, 5, 6, 7]
    assert [m.seq for m in played if isinstance(m, Image)] == [0, 1]


@pytest.mark.parametrize(("numbers", "before"), [((4205, 4206), 4204), ((0, 1), 0), ((), None)])
def test_no_frame_counts_as_lost_between_the_empty_one_and_the_first(
    numbers: Sequence[int], before: int | None, record: Record
) -> None:
    recording = record("late", mark("start", 1), *(skeleton(n + 1, number) for n, number in enumerate(numbers)))
    client, stopped = Mock(sensor="kinect0", run="run"), threading.Event()
    stopped.set()
    put_all(client, [recording], 1.0, stopped)
    assert [call.args[0].seq for call in client.put.call_args_list] == [before]


def test_streams_carry_the_plays_session_and_a_restart_stays_visible(record: Record) -> None:
    first = record("first", skeleton(1, session_id="a"), skeleton(2, session_id="b"))
    second = record("second", skeleton(1, session_id="b"))
    played = play(first, second)
    assert [m.session_id for m in played if isinstance(m, Skeleton)] == ["play", "play.2", "play"]


def test_one_session_of_all_streams_is_the_plays_own(record: Record) -> None:
    played = play(record("first", skeleton(1), image(1), objects(2)))
    assert {getattr(message, "session_id", None) for message in played} == {"play"}


def test_no_result_is_played_and_marks_lose_label_number_and_origin(record: Record) -> None:
    marked = mark("start", 1, label="push"), mark("end", 2, origin="manual")
    played = play(record("first", marked[0], skeleton(1), marked[1], action(0, 2)))
    assert [type(message) for message in played] == [Segment, Skeleton, Segment]
    assert [(each.label, each.seq, each.origin) for each in marks_of(played)] == [(None, None, REPLAY)] * 2


def test_segment_ids_stay_unless_an_earlier_recording_used_them(record: Record) -> None:
    takes = [record(f"take{i}", mark("start", 1), mark("end", 2), mark("start", 3, f"own{i}")) for i in range(3)]
    takes.append(record("last", mark("start", 1, "one#2")))
    ids = [message.segment_id for message in marks_of(play(*takes))]
    assert ids == ["one", "one", "own0", "one#2", "one#2", "own1", "one#3", "one#3", "own2", "one#2#2"]


def test_a_repeated_mark_inside_a_recording_stays_a_repetition(record: Record) -> None:
    played = play(record("first", mark("start", 1), mark("start", 1), mark("end", 2)))
    assert {message.segment_id for message in marks_of(played)} == {"one"}


def test_derived_streams_are_played_only_where_their_source_is_missing(record: Record) -> None:
    derived = (posture(1), objects(1), mark("start", 1))
    assert playable_topics(record("bare", *derived)) == {keys.POSTURE, keys.OBJECTS, keys.SEGMENT}
    assert playable_topics(record("body", *derived, skeleton(1))) == {keys.SKELETON, keys.OBJECTS, keys.SEGMENT}
    assert playable_topics(record("view", *derived, image(1))) == {keys.POSTURE, keys.COLOR, keys.SEGMENT}


def test_the_viewpoint_can_be_renamed(record: Record) -> None:
    played = play(record("first", skeleton(1), mark("start", 1)), sensor="door")
    assert [keys.key_of(message) for message in played] == ["actum/door/segment", "actum/door/skeleton"]


def test_what_a_classifier_has_found_is_left_to_be_found_again(record: Record) -> None:
    found = [mark("start", 1, "auto-1", origin=AUTO), mark("end", 2, "auto-1", origin=AUTO)]
    played = play(record("first", skeleton(1), mark("start", 1), *found, skeleton(2), mark("end", 2)))
    assert [m.segment_id for m in marks_of(played)] == ["one", "one"]


def test_segments_of_two_sensors_stay_two_where_both_are_played_as_one(record: Record) -> None:
    other = [each.model_copy(update={"sensor": "kinect1"}) for each in (mark("start", 5), mark("end", 6))]
    played = play(record("both", mark("start", 1), mark("end", 2), *other), sensor="door")
    assert [m.segment_id for m in marks_of(played)] == ["one", "one", "one#2", "one#2"]
