"""A recording written anew holds what it held but for what was changed, and is never left half written."""

import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from actum.codec import encode
from actum.mcap_file import RecordingError
from actum.recorder import Recorder
from actum.recording import Recording
from actum.rewriting import finish, rewrite, unchanged
from empty_messages import image, mark, skeleton

SKELETON = "actum/kinect0/skeleton"


def content(path: Path) -> dict[str, Any]:
    """All that a foreign reader finds in the file."""
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        return {
            "messages": [
                (
                    schema and schema.name,
                    channel.topic,
                    channel.metadata,
                    m.log_time,
                    m.publish_time,
                    m.sequence,
                    m.data,
                )
                for schema, channel, m in reader.iter_messages()
            ],
            "metadata": [(found.name, found.metadata) for found in reader.iter_metadata()],
            "attachments": [(found.name, found.data) for found in reader.iter_attachments()],
        }


@pytest.fixture
def path(tmp_path: Path) -> Path:
    with Recorder(tmp_path / "a.mcap", person="anna", source="test", lens="60") as recorder:
        for message in (
            skeleton(1),
            image(1),
            mark("start", 1),
            *(skeleton(i) for i in range(2, 3000)),
            mark("end", 9),
        ):
            recorder.write(message, log_time_ns=7)
    return tmp_path / "a.mcap"


def beside(path: Path) -> Iterable[str]:
    return [other.name for other in path.parent.iterdir() if other != path]


def test_what_is_not_changed_stays_as_it_is(path: Path) -> None:
    before = content(path)
    rewrite(path, unchanged)
    assert content(path) == before
    assert Recording(path).metadata == {"person": "anna", "source": "test", "lens": "60"}
    assert beside(path) == []


def test_what_others_put_into_the_file_stays(tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_attachment(1, 2, "notes.txt", "text/plain", b"by hand")
        channel = writer.register_channel("robot/odometry", "json", 0)
        writer.add_message(channel, log_time=9, data=b"{}", publish_time=5, sequence=3)
        writer.finish()
    before = content(path)
    rewrite(path, unchanged)
    assert content(path) == before


def test_messages_are_changed_and_left_out(path: Path) -> None:
    rewrite(path, lambda stored: None if stored.key == SKELETON else replace(stored, publish_ns=stored.publish_ns + 1))
    assert sorted(message[4] for message in content(path)["messages"]) == [2, 2, 10]


def test_a_damaged_recording_is_left_as_it_is(path: Path) -> None:
    damaged = bytearray(path.read_bytes())
    damaged[damaged.index(b"zstd") + 40] ^= 0xFF
    path.write_bytes(damaged)
    with pytest.raises(RecordingError, match="damaged"):
        rewrite(path, unchanged)
    assert path.read_bytes() == damaged
    assert beside(path) == []


def test_a_recording_whose_new_one_cannot_be_written_is_left_as_it_is(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_: Writer) -> None:
        raise OSError(28, "No space left on device")

    before = path.read_bytes()
    monkeypatch.setattr(Writer, "finish", full)
    with pytest.raises(OSError, match="No space left"):
        rewrite(path, unchanged)
    assert path.read_bytes() == before
    assert beside(path) == []


def test_a_link_stays_one_and_who_may_read_the_file_stays_so(path: Path) -> None:
    path.chmod(0o640)
    link = path.with_name("link.mcap")
    link.symlink_to(path)
    rewrite(link, lambda _: None)
    assert link.is_symlink()
    assert path.stat().st_mode & 0o777 == 0o640
    assert content(path)["messages"] == []


def test_of_a_recording_that_breaks_off_all_that_can_be_read_is_kept(path: Path) -> None:
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    readable = len(list(Recording(path).messages()))
    rewrite(path, unchanged)
    kept = Recording(path)
    assert len(list(kept.messages())) == readable > 100
    assert not kept.truncated


def foreign(path: Path, schema: int = 0, channel: int = 1, metadata: bool = True) -> Path:
    """A recording as another program may write it, one message long."""
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        if metadata:
            writer.add_metadata("actum.recording", {"person": "anna"})
        writer.register_channel(SKELETON, "msgpack", schema, {"encoding": encode(skeleton(1)).encoding})
        writer.add_message(channel, 1, encode(skeleton(1)).payload, 1)
        writer.finish()
    return path


def test_a_channel_of_a_schema_that_is_not_there_is_copied_without_one(tmp_path: Path) -> None:
    path = foreign(tmp_path / "a.mcap", schema=77)
    rewrite(path, unchanged)
    assert [message.stamp_ns for message in Recording(path).messages()] == [1]


def test_a_message_of_an_unknown_channel_is_told_and_the_file_is_as_it_was(tmp_path: Path) -> None:
    path = foreign(tmp_path / "a.mcap.part", channel=5)
    before = path.read_bytes()
    with pytest.raises(RecordingError, match="channel 5, which the file does not describe"):
        finish(tmp_path / "a.mcap")
    assert [*tmp_path.iterdir()] == [path] and path.read_bytes() == before


def test_what_is_said_of_a_recording_that_says_nothing_of_itself_is_stored(tmp_path: Path) -> None:
    path = foreign(tmp_path / "a.mcap", metadata=False)
    rewrite(path, unchanged)
    assert Recording(path).metadata == {}
    rewrite(path, unchanged, metadata={"mirrored": '["cut-1"]'})
    assert Recording(path).metadata == {"mirrored": '["cut-1"]'}


def test_a_named_pipe_is_no_recording(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.mcap")
    program = "import sys; from actum.recording import *; from pathlib import Path; Recording(Path(sys.argv[1]))"
    ended = subprocess.run(
        [sys.executable, "-c", program, tmp_path / "a.mcap"], capture_output=True, timeout=10, check=False
    )
    assert b"RecordingError" in ended.stderr and b"the path names a device or a pipe, not a file" in ended.stderr
