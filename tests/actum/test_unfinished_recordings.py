"""What a process that was killed, or a full disk, has left of a recording is never overwritten, and can be finished."""

import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from actum.recorder import Recorder, StoredRecorder, unfinished
from actum.recording import Recording, RecordingError
from actum.rewriting import finish, rewrite, unchanged
from empty_messages import skeleton

PROGRAM = """
import sys
from pathlib import Path
from actum.messages import Skeleton
from actum.recorder import Recorder
recorder = Recorder(Path(sys.argv[1]), person="anna", source="test")
for stamp_ns in range(5000):
    recorder.write(Skeleton(stamp_ns=stamp_ns, sensor="kinect0", agents=[]))
print("written", flush=True)
sys.stdin.read()
"""
MOST_BYTES = 300_000


@contextmanager
def recording(path: Path) -> Iterator[subprocess.Popen[str]]:
    """A process that has written most of a recording and goes on; it is killed in the end."""
    process = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(path)], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None and process.stdout.readline() == "written\n"
        yield process
    finally:
        process.send_signal(signal.SIGKILL)
        process.communicate()


@contextmanager
def full_disk(free_bytes: int = MOST_BYTES) -> Iterator[None]:
    """No file gets longer than so much."""
    limit, ignored = resource.getrlimit(resource.RLIMIT_FSIZE), signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (free_bytes, limit[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
        signal.signal(signal.SIGXFSZ, ignored)


def killed(path: Path) -> bytes:
    """What a killed process has left of a recording."""
    with recording(path):
        pass
    return unfinished(path).read_bytes()


def stamps(path: Path) -> list[int | None]:
    return [message.stamp_ns for message in Recording(path).messages()]


def recorded(path: Path, *stamps_ns: int) -> None:
    with Recorder(path, person="1", source="test") as recorder:
        for stamp_ns in stamps_ns:
            recorder.write(skeleton(stamp_ns))


def test_what_a_killed_process_left_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    left = killed(path)
    with pytest.raises(FileExistsError, match=r"a\.mcap\.part is an unfinished recording \(0\.\d MB.*--finish"):
        recorded(path, 1)
    assert unfinished(path).read_bytes() == left


def test_a_recording_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    recorded(path, 1)
    with pytest.raises(FileExistsError, match=r"a\.mcap already exists"):
        recorded(path, 2)
    assert stamps(path) == [1]
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]


def test_of_two_processes_that_record_to_one_name_the_second_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with recording(path), pytest.raises(FileExistsError, match="another process is writing it"):
        recorded(path, 1)


def test_a_file_that_somebody_puts_there_meanwhile_is_not_overwritten(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with pytest.raises(FileExistsError), Recorder(path, person="1", source="test") as recorder:
        recorder.write(skeleton(1))
        path.write_bytes(b"mine")
    assert path.read_bytes() == b"mine"
    assert stamps(unfinished(path)) == [1]


def test_where_there_are_no_hard_links_nothing_is_overwritten_either(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(*_: object) -> None:
        raise PermissionError("a file system without hard links")

    monkeypatch.setattr(os, "link", none)
    path = tmp_path / "a.mcap"
    recorded(path, 1)
    assert stamps(path) == [1]
    with pytest.raises(FileExistsError), Recorder(tmp_path / "b.mcap", person="1", source="test") as recorder:
        recorder.write(skeleton(1))
        (tmp_path / "b.mcap").write_bytes(b"mine")
    assert (tmp_path / "b.mcap").read_bytes() == b"mine"


def test_a_take_that_is_dropped_leaves_the_file_of_another(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    recorder = Recorder(path, person="1", source="test")
    path.write_bytes(b"mine")
    recorder.discard()
    assert path.read_bytes() == b"mine"
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]


@pytest.mark.parametrize("kind", [Recorder, StoredRecorder])
@pytest.mark.parametrize("freed", [False, True], ids=["the disk stays full", "somebody makes room meanwhile"])
def test_what_was_stored_before_the_disk_was_full_is_readable(
    tmp_path: Path, kind: type[Recorder], freed: bool
) -> None:
    """Also where the rest of a chunk would find room again: behind a tear nothing can be read."""
    path, count = tmp_path / "a.mcap", 0
    with full_disk(), pytest.raises(OSError), kind(path, person="1", source="test") as recorder:
        try:
            while True:
                recorder.write(skeleton(count))
                count += 1
        except OSError:
            if freed:
                resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
            raise
    found = stamps(unfinished(path))
    assert found == list(range(len(found)))
    assert len(found) > count / 4


def test_where_not_even_its_beginning_can_be_written_nothing_is_left(tmp_path: Path) -> None:
    with full_disk(10), pytest.raises(OSError):
        Recorder(tmp_path / "a.mcap", person="1", source="test")
    assert list(tmp_path.iterdir()) == []
    recorded(tmp_path / "a.mcap", 1)


def test_who_reads_a_recording_that_has_just_begun_finds_one(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="anna", source="test"):
        assert Recording(tmp_path / "a.mcap.part").person == "anna"


def test_what_a_killed_process_left_becomes_a_recording(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    killed(path)
    left = stamps(unfinished(path))
    assert finish(path) == len(left) > 1000
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap"]
    assert stamps(path) == left
    assert not Recording(path).truncated
    assert Recording(path).person == "anna"


def test_what_a_process_is_writing_is_not_finished(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with recording(path):
        with pytest.raises(FileExistsError, match="another process is writing"):
            finish(path)
        assert [file.name for file in tmp_path.iterdir()] == ["a.mcap.part"]


def test_what_cannot_be_finished_stays_as_it_is(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    left = killed(path)
    with full_disk(1000), pytest.raises(OSError):
        finish(path)
    path.write_bytes(b"mine")
    with pytest.raises(FileExistsError, match=r"a\.mcap already exists, so .*a\.mcap\.part cannot be renamed to"):
        finish(path)
    assert path.read_bytes() == b"mine"
    path.unlink()
    unfinished(path).write_bytes(b"")
    with pytest.raises(RecordingError, match="the file is not an MCAP file"):
        finish(path)
    unfinished(path).write_bytes(left)
    finish(path)
    with pytest.raises(FileNotFoundError):
        finish(path)


def test_an_unfinished_recording_is_not_edited_under_the_hands_of_who_writes_it(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with recording(path), pytest.raises(RecordingError, match=r"actum record .*a\.mcap --finish"):
        rewrite(unfinished(path), unchanged)
