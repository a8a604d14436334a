"""Messages reach a viewer at their stamps: a mark without one at that of the newest frame."""

import threading
from pathlib import Path

from actum.codec import DecodeError
from actum.messages import Message
from actum.recorder import write_recording
from actum.recording import Recording
from actum_command.commands.viewed_streams import RecordedStreams, Showing
from actum_command.viewers.contents import Presence, log_line
from empty_messages import mark
from people import STANDING, skeleton
from scenes import action


def test_a_mark_without_a_stamp_gets_that_of_the_newest_frame() -> None:
    shown: list[Message] = []
    showing = Showing(shown.append)
    for message in (skeleton(5, STANDING), mark("start"), skeleton(9, STANDING), mark("end"), mark("end", 7)):
        showing.receive(message)
    assert [message.stamp_ns for message in shown] == [5, 5, 9, 9, 7]


def test_a_mark_before_any_frame_and_what_does_not_decode_are_counted() -> None:
    showing = Showing(lambda _: None)
    showing.receive(mark("start"))
    showing.reject(DecodeError("not_msgpack", "x"))
    assert (showing.shown, dict(showing.not_shown)) == (0, {"mark_without_stamp": 1, "not_msgpack": 1})


def test_a_recording_is_shown_in_order_of_stamp_and_names_its_sensors(tmp_path: Path) -> None:
    write_recording(
        tmp_path / "a.mcap", (skeleton(stamp_ns, STANDING) for stamp_ns in (3, 1, 2)), person="", source="test"
    )
    streams, shown = RecordedStreams(Recording(tmp_path / "a.mcap")), list[Message]()
    streams.give(Showing(shown.append), threading.Event())
    assert streams.sensors == ["kinect0"]
    assert [message.stamp_ns for message in shown] == [1, 2, 3]


def test_a_stop_ends_it_at_once(tmp_path: Path) -> None:
    write_recording(
        tmp_path / "a.mcap", (skeleton(stamp_ns, STANDING) for stamp_ns in (1, 2, 3)), person="", source="test"
    )
    stop, shown = threading.Event(), list[Message]()

    def show(message: Message) -> None:
        shown.append(message)
        stop.set()

    RecordedStreams(Recording(tmp_path / "a.mcap")).give(Showing(show), stop)
    assert len(shown) == 1


def test_those_who_are_named_no_more_have_gone_each_sensor_for_itself() -> None:
    presence = Presence()
    assert presence.departed("one", [1, 2]) == []
    assert presence.departed("other", []) == []
    assert presence.departed("one", [2, 3]) == [1]
    assert presence.departed("one", []) == [2, 3]
    assert presence.departed("one", []) == []


def test_the_log_has_no_line_for_each_frame() -> None:
    assert log_line(skeleton(1, STANDING)) is None
    assert log_line(action("lift", final=False, end_ns=None)) is None
