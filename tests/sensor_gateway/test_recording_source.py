"""A recording played as a sensor is what the sensor put, under the configured name."""

from itertools import islice
from pathlib import Path

import msgpack
import pytest
from mcap.writer import Writer

from actum.joining import PAUSE_NS
from actum.messages import Message, Objects, Segment
from actum.recorder import write_recording
from actum.recording import RecordingError
from empty_messages import image, skeleton
from sensor_gateway.recording_source import LoopedSource, RecordingSource


def record(path: Path, *messages: Message) -> Path:
    write_recording(path, messages, person="1", source="test")
    return path


def test_skeletons_and_images_come_instant_by_instant_as_the_configured_sensor(tmp_path: Path) -> None:
    mark = Segment(stamp_ns=10, sensor="kinect0", kind="start", segment_id="one")
    objects = Objects(stamp_ns=10, sensor="kinect0", objects=[])
    source = RecordingSource(
        record(tmp_path / "a.mcap", skeleton(10, 4), image(10, 2), mark, objects, skeleton(20, 6)), "door"
    )
    door = {"sensor": "door"}
    assert source.paced
    first, second = source.frames()
    assert sorted(first, key=lambda message: message.SCHEMA) == [
        image(10, 2).model_copy(update=door),
        skeleton(10, 4).model_copy(update=door),
    ]
    assert second == [skeleton(20, 6).model_copy(update=door)]


def test_files_can_be_played_again_and_again_with_a_pause_between(tmp_path: Path) -> None:
    record(tmp_path / "b.mcap", skeleton(5, 0))
    record(tmp_path / "a.mcap", skeleton(100, 7))
    looped = LoopedSource(RecordingSource(tmp_path, "kinect0")).frames()
    frames = [frame for instant in islice(looped, 5) for frame in instant]
    assert [(frame.stamp_ns, frame.seq) for frame in frames] == [(100 + i * PAUSE_NS, 7 + i) for i in range(5)]


def test_what_holds_nothing_ends_also_when_it_is_to_be_played_again(tmp_path: Path) -> None:
    assert list(LoopedSource(RecordingSource(record(tmp_path / "a.mcap"), "kinect0")).frames()) == []


def test_bad_messages_of_a_file_are_counted(tmp_path: Path) -> None:
    with (tmp_path / "a.mcap").open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel("actum/kinect0/skeleton", "msgpack", 0)
        for payload in (b"\xc1", msgpack.packb({"stamp_ns": 3, "agents": []})):
            writer.add_message(channel, log_time=0, data=payload, publish_time=3)
        writer.finish()
    source = RecordingSource(tmp_path / "a.mcap", "kinect0")
    assert [[frame.stamp_ns for frame in instant] for instant in source.frames()] == [[3]]
    assert source.counters.rejects == {"not_msgpack": 1}


def test_a_broken_end_is_counted(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", skeleton(3, 0))
    path.write_bytes(path.read_bytes()[:-20])
    source = RecordingSource(path, "kinect0")
    assert len(list(source.frames())) == 1
    assert source.counters.rejects == {"truncated_recording": 1}


def test_what_is_no_recording_is_refused_at_once(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_text("not this")
    with pytest.raises(RecordingError, match="the file is not an MCAP file"):
        RecordingSource(tmp_path, "kinect0")


def test_a_folder_without_recordings_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"contains no recording"):
        RecordingSource(tmp_path, "kinect0")


def test_a_damaged_file_is_played_up_to_there_and_counted(tmp_path: Path) -> None:
    record(tmp_path / "a.mcap", *[skeleton(stamp, stamp) for stamp in range(1, 400)])
    whole = bytearray((tmp_path / "a.mcap").read_bytes())
    middle = len(whole) // 3
    whole[middle : middle + 200] = bytes(byte ^ 0x55 for byte in whole[middle : middle + 200])
    (tmp_path / "a.mcap").write_bytes(whole)
    record(tmp_path / "b.mcap", skeleton(7, 0), skeleton(12, 1))
    source = RecordingSource(tmp_path, "kinect0")
    *_, [first], [second] = source.frames()
    assert second.stamp_ns - first.stamp_ns == 5
    assert source.counters.rejects == {"damaged_recording": 1}
