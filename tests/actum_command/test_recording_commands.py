"""`actum record` and `actum play` tell what they did, and what they could not."""

import json
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import msgpack
import pytest
from mcap.writer import Writer

from actum import codec, keys
from actum.messages import CUT, MANUAL, SIMULATOR, Message, Segment
from actum.recorder import Recorder, StoredRecorder
from actum.recording import Recording
from actum.runtime import Received
from actum_command import streaming
from actum_command.commands import play_command, recording_commands
from actum_examples.cutting import counting
from actum_model_trainer.sample_reading import select
from command_lines import invoke, refused, written
from empty_messages import image, mark, skeleton, status
from people import FRAME_NS
from repeating import Stream, five_waves, rest
from sensor_gateway.recording_source import RecordingSource


class Live:
    """A client that hears what it is given, then that the recording is to stop, and keeps what is put."""

    sensor, run = "kinect0", "now"

    def __init__(self, stop: threading.Event) -> None:
        self._stop = stop
        self._coming: list[Received] = []
        self.heard: list[Message] = []

    def __enter__(self) -> "Live":
        return self

    def __exit__(self, *_: object) -> None: ...

    def listen_back(self, _pattern: str, _history_s: float) -> "Live":
        return self

    def wait_for_subscriber(self, _topic: keys.Topic, _wait_s: float) -> bool:
        return True

    def comes(self, *messages: Message) -> None:
        self._coming += [Received(keys.key_of(message), message, None, 0) for message in messages]

    def comes_garbage(self) -> None:
        self._coming.append(Received("actum/kinect0/skeleton", None, codec.DecodeError("not_msgpack", "no"), 1))

    def stop_at_once(self) -> None:
        self._stop.set()

    def put(self, message: Message) -> None:
        self.heard.append(message)

    def receive(self) -> Received | None:
        if self._coming:
            return self._coming.pop(0)
        self._stop.set()
        return None


@pytest.fixture
def live(monkeypatch: pytest.MonkeyPatch) -> Live:
    stop = threading.Event()
    client = Live(stop)
    for command in (recording_commands, play_command):
        monkeypatch.setattr(command, "connect", lambda: client)
        monkeypatch.setattr(command, "stop_on_signals", lambda: stop)
    monkeypatch.setattr(streaming, "LEAD_IN_S", 0.0)
    monkeypatch.setattr(streaming, "ON_ITS_WAY_S", 0.0)
    return client


def test_only_what_is_stored_is_counted(live: Live, tmp_path: Path) -> None:
    live.comes(status(), skeleton(1), image(1), skeleton(2), mark("start", 2))
    recorded = invoke("record", tmp_path / "a.mcap")
    assert f"3 messages, 1 marked actions, written to {tmp_path / 'a.mcap'}" in recorded.stdout
    assert len(list(Recording(tmp_path / "a.mcap").messages())) == 3
    assert "not stored" not in recorded.stdout
    assert "not decodable" not in recorded.stdout


def test_whose_actions_are_stored_and_whose_are_not_is_told(live: Live, tmp_path: Path) -> None:
    scene = [mark("start", 2, "s1", origin=SIMULATOR), mark("end", 3, "s1", origin=SIMULATOR)]
    own = [mark("start", 4, "mine", origin=MANUAL), mark("end", 5, "mine", origin=MANUAL), mark("start", 6, "robot")]
    live.comes(skeleton(1), *scene, *own)
    told = invoke("record", tmp_path / "a.mcap", "--label", "push").stdout
    assert "2 marked by manual, labelled 'push'" in told
    assert "1 marked by simulator not stored: to store them, use --marks simulator or --marks all" in told
    assert "marked without an end, so training does not use them: robot" in told
    live.comes(skeleton(1), *scene, *own)
    told = invoke("record", tmp_path / "b.mcap", "--marks", "manual, simulator").stdout
    assert "3 marked actions" in told
    assert "1 marked by simulator, without a label" in told
    assert "not stored" not in told


def test_what_is_done_five_times_is_counted_cut_and_shown(live: Live, tmp_path: Path) -> None:
    stream = five_waves().then(rest(6))
    live.comes(*stream.skeletons(), mark("start", 2, "mine", origin=MANUAL))
    told = invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 5, "--person", "anna").stdout
    assert "do 'wave' 5 times" in told
    assert "5 of 5" in told
    assert "that was the last: stopping" in told
    assert "5 marked by cut, labelled 'wave'" in told
    assert "  sure: " in told
    recording = Recording(tmp_path / "a.mcap")
    marks = [message for message in recording.messages((keys.SEGMENT,)) if isinstance(message, Segment)]
    assert recording.person == "anna"
    assert [(each.segment_id, each.kind, each.origin) for each in marks] == [
        (f"cut-{number}", kind, CUT) for number in range(1, 6) for kind in ("start", "end")
    ]
    near_ns = [first * FRAME_NS for first, _ in stream.truths]
    assert [each.stamp_ns for each in marks[::2]] == pytest.approx(near_ns, abs=4e8)


@pytest.mark.parametrize("times", [(), ("--times", 5)])
@pytest.mark.parametrize("label", ["", "x" * 201])
def test_a_label_that_no_mark_can_hold_is_refused_before_the_recording(
    live: Live, tmp_path: Path, label: str, times: tuple[object, ...]
) -> None:
    live.comes(*five_waves().then(rest(6)).skeletons(), mark("start", 2, "mine", origin=MANUAL))
    refusal = refused("record", tmp_path / "a.mcap", "--label", label, *times)
    assert f"the label has {len(label)} characters: use 1 to 200 characters" in refusal
    assert not list(tmp_path.iterdir())


def test_what_is_repeated_with_nobody_there_is_told(live: Live, tmp_path: Path) -> None:
    live.comes(skeleton(1))
    assert "nobody was in view" in invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 5).stdout


def test_standing_still_is_no_example(live: Live, tmp_path: Path) -> None:
    live.comes(*Stream().then(rest(12)).skeletons(noise_m=0.008))
    told = invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 3, "--seconds", 3).stdout
    assert "no repetition was found in the recording: the movement was no larger than the noise" in told
    assert "marked by cut" not in told


def test_a_recording_that_lacks_repetitions_is_left_out_of_training(live: Live, tmp_path: Path) -> None:
    live.comes(*five_waves().skeletons())
    told = invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 12, "--seconds", 3).stdout
    assert "of 12 repetitions found: record " in told
    assert "training leaves this recording out" in told
    assert Recording(tmp_path / "a.mcap").metadata["excluded"] == "true"


def test_a_recording_that_lacks_repetitions_and_cannot_be_left_out_of_training_is_told(
    live: Live, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recording_commands, "rewrite", full)
    live.comes(*five_waves().skeletons())
    refusal = refused("record", tmp_path / "a.mcap", "--label", "wave", "--times", 12, "--seconds", 3)
    assert "could not be marked as excluded (No space left on device)" in refusal


def test_marks_by_hand_are_stored_beside_the_cuts_where_they_are_asked_for(live: Live, tmp_path: Path) -> None:
    live.comes(*five_waves().skeletons(), mark("start", 2, "mine", origin=MANUAL), mark("end", 3, "mine"))
    told = invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 5, "--marks", "manual").stdout
    assert "1 marked by manual" in told
    assert "5 marked by cut" in told


def test_a_kill_before_the_end_leaves_no_recording_of_that_name(live: Live, tmp_path: Path) -> None:
    live.comes(*five_waves().skeletons())
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(counting, "cut", lambda *_: sys.exit("killed"))
        invoke("record", tmp_path / "a.mcap", "--label", "wave", "--times", 5)
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap.part"]
    assert list(Recording(tmp_path / "a.mcap.part").messages())


def test_what_a_crash_left_is_not_recorded_over_but_finished(live: Live, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    with pytest.raises(KeyError), Recorder(path, person="anna", source="kinect0") as recorder:
        recorder.write(skeleton(1))
        raise KeyError("a crash")
    left = (tmp_path / "a.mcap.part").read_bytes()
    live.comes(skeleton(2))
    told = refused("record", path)
    assert "a.mcap.part is an unfinished recording (0.0 MB, last written 2" in told
    assert f"actum record {path} --finish" in told
    assert (tmp_path / "a.mcap.part").read_bytes() == left
    assert live.receive() is not None, "nobody has listened"
    assert (
        f"1 messages, all that are complete in the unfinished file, written to {path}"
        in invoke("record", path, "--finish").stdout
    )
    assert [message.stamp_ns for message in Recording(path).messages()] == [1]
    assert f"{path} already exists" in refused("record", path)
    assert "add --label" in refused("record", tmp_path / "b.mcap", "--times", 5)
    assert "there is no unfinished recording" in refused("record", path, "--finish")


def test_what_cannot_be_finished_is_told_and_left(tmp_path: Path) -> None:
    (tmp_path / "a.mcap.part").write_bytes(b"torn")
    told = refused("record", tmp_path / "a.mcap", "--finish")
    assert (
        "a.mcap.part cannot be turned into a recording (the file is not an MCAP file) and was not changed: move or "
        "delete" in told
    )
    assert (tmp_path / "a.mcap.part").read_bytes() == b"torn"


@pytest.mark.parametrize("named", ["a.mcap", "a.mcap.part"])
def test_what_is_finished_may_be_named_as_it_lies_there(tmp_path: Path, named: str) -> None:
    written(tmp_path / "a.mcap", skeleton(1)).rename(tmp_path / "a.mcap.part")
    assert "1 messages" in invoke("record", tmp_path / named, "--finish").stdout
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]


def test_a_full_disk_is_told_with_what_to_do(live: Live, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    live.comes(skeleton(1))
    monkeypatch.setattr("mcap.writer.Writer.add_message", full)
    told = refused("record", tmp_path / "a.mcap")
    left = f"the messages stored before this error are in {tmp_path / 'a.mcap.part'}"
    assert f"cannot be written (No space left on device); {left}" in told
    assert f"actum record {tmp_path / 'a.mcap'} --finish" in told


@pytest.mark.parametrize("named", ["a.mcap", "a.mcap.part"])
def test_no_command_writes_over_a_recording_or_what_is_left_of_one(tmp_path: Path, named: str) -> None:
    source = written(tmp_path / "source.mcap", skeleton(1))
    (tmp_path / named).write_bytes(b"mine")
    for command in (["simulate", tmp_path / "a.mcap"], ["export", source, tmp_path / "a.mcap", "--foxglove"]):
        assert named in refused(*command)
    assert (tmp_path / named).read_bytes() == b"mine"


def test_what_came_before_the_stop_is_stored(live: Live, tmp_path: Path) -> None:
    live.comes(skeleton(1), skeleton(2), mark("end", 2))
    live.stop_at_once()
    assert "3 messages" in invoke("record", tmp_path / "a.mcap").stdout


def test_marks_and_payloads_that_are_lost_are_told(live: Live, tmp_path: Path) -> None:
    live.comes(mark("start"), mark("end"))
    live.comes_garbage()
    recorded = invoke("record", tmp_path / "a.mcap")
    assert "0 messages" in recorded.stdout
    assert "not stored: mark_without_stamp 2" in recorded.stdout
    assert "not decodable: 1 (not_msgpack 1)" in recorded.stdout


def test_a_recording_of_nothing_is_warned_of(live: Live, tmp_path: Path) -> None:
    live.comes(status())
    assert "nothing was stored" in invoke("record", tmp_path / "a.mcap").stdout


@pytest.mark.parametrize(("named", "told"), [("takes", "takes is a folder"), ("file/a.mcap", "cannot be written")])
def test_where_nothing_can_be_written_nothing_is_recorded(named: str, told: str, live: Live, tmp_path: Path) -> None:
    (tmp_path / "takes").mkdir()
    (tmp_path / "file").touch()
    live.comes(skeleton(1))
    assert told in refused("record", tmp_path / named)
    assert live.receive() is not None, "nobody has listened"
    assert {path.name for path in tmp_path.iterdir()} == {"takes", "file"}


def cut(path: Path) -> Path:
    """Break a recording off right behind its last message."""
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - 1])
    return path


@pytest.mark.parametrize(("marks", "told"), [([], True), ([mark("start", 2), mark("end", 3)], False)])
def test_a_label_that_nothing_got_is_told(marks: list[Message], told: bool, live: Live, tmp_path: Path) -> None:
    live.comes(skeleton(1), *marks)
    recorded = invoke("record", tmp_path / "a.mcap", "--label", "push")
    assert ("nothing is labelled 'push'" in recorded.stdout) == told


def test_blanks_between_persons_are_none_of_their_names(live: Live, tmp_path: Path) -> None:
    for person in ("anna", "bert", "cem"):
        written(tmp_path / f"{person}.mcap", skeleton(1), person=person)
    assert "played 2 recordings" in invoke("play", tmp_path, "--person", "anna, cem", "--speed", 100).stdout


def test_a_damaged_recording_ends_a_play_with_one_line(live: Live, tmp_path: Path) -> None:
    path = written(tmp_path / "a.mcap", *(skeleton(i) for i in range(100)))
    content = bytearray(path.read_bytes())
    content[content.index(b"zstd") + 40] ^= 0xFF
    path.write_bytes(content)
    assert f"{path}: the recording is damaged" in refused("play", path)


def test_a_recording_that_breaks_off_is_named(live: Live, tmp_path: Path) -> None:
    path = cut(written(tmp_path / "a.mcap", skeleton(1), skeleton(2)))
    played = invoke("play", path)
    assert played.exit_code == 0
    assert f"{path} is truncated" in played.stdout


def test_what_a_play_passes_over_is_counted(live: Live, tmp_path: Path) -> None:
    path = tmp_path / "foreign.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for key, payload in (("robot/odometry", b"\x80"), ("actum/kinect0/skeleton", msgpack.packb([1]))):
            writer.add_message(writer.register_channel(key, "msgpack", 0), log_time=9, data=payload, publish_time=5)
        writer.finish()
    assert f"{path}: skipped not_a_map 1, unknown_key 1" in invoke("play", path).stdout


class TestUnfinishedInAFolder:
    """A folder holds a finished recording, one that is being written, and what cannot be read."""

    @pytest.fixture
    def folder(self, tmp_path: Path) -> Iterator[Path]:
        written(tmp_path / "a.mcap", mark("start", 1, "done"), mark("end", 2, "done"))
        recorder = StoredRecorder(tmp_path / "b.mcap", person="anna", source="test")
        for message in (mark("start", 3, "newest"), mark("end", 4, "newest")):
            recorder.write(message)
        recorder.store()
        (tmp_path / "c.mcap.part").write_bytes(b"")
        (tmp_path / "a.mcap.part").write_bytes((tmp_path / "a.mcap").read_bytes())
        (tmp_path / ".making").mkdir()
        written(tmp_path / ".making" / "d.mcap", mark("start", 5, "hidden"))
        yield tmp_path
        recorder.close()

    def told_of(self, text: str, folder: Path) -> None:
        assert f"{folder / 'b.mcap.part'} is not finished: its messages so far are read" in text
        assert f"not read: {folder / 'c.mcap.part'}: the file is not an MCAP file" in text
        assert f"{folder / 'a.mcap.part'} is not read, because the finished recording {folder / 'a.mcap'}" in text

    def test_commands_read_them_and_say_so(self, folder: Path) -> None:
        listed = invoke("label", folder).stdout
        assert "done" in listed and "newest" in listed and "hidden" not in listed
        self.told_of(listed, folder)

    def test_watch_reads_them_and_says_so_beside_its_lines(self, folder: Path) -> None:
        watched = invoke("watch", "segment", "--json", "--from", folder)
        assert [json.loads(line)["segment_id"] for line in watched.stdout.splitlines()] == ["done"] * 2 + ["newest"] * 2
        self.told_of(watched.stderr, folder)
        assert f"{folder / 'b.mcap.part'} is truncated" in watched.stderr

    def test_a_file_that_is_named_is_read_or_refused(self, folder: Path) -> None:
        assert "newest" in invoke("watch", "segment", "--from", folder / "b.mcap.part").stdout
        assert "the file is not an MCAP file" in refused("watch", "segment", "--from", folder / "c.mcap.part")

    def test_what_takes_folders_by_itself_logs_it(self, folder: Path, caplog: pytest.LogCaptureFixture) -> None:
        assert [recording.path.name for recording in select([folder])] == ["a.mcap", "b.mcap.part"]
        self.told_of(caplog.text, folder)

    def test_the_gateway_plays_them_and_counts_what_it_cannot(self, folder: Path) -> None:
        source = RecordingSource(folder, "kinect0")
        assert list(source.frames()) == []
        assert source.counters.rejects == {"damaged_recording": 2, "truncated_recording": 1}
