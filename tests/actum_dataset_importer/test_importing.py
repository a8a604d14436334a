"""Importing writes one recording per file of a set, and reports what it found."""

from pathlib import Path

import pytest

from actum import keys
from actum.messages import Segment, Skeleton
from actum.recording import Recording
from actum_dataset_importer.importing import import_msr_action3d, import_msrc12, import_utkinect
from actum_dataset_importer.takes import DatasetError
from sensor_gateway.recording_source import RecordingSource

Calls = list[tuple[int, int]]


def msr_sequence(folder: Path, name: str, frames: str) -> None:
    """One letter a frame: x has a skeleton, 0 has none."""
    rows = ["0 0 0 0\n" * 20 if letter == "0" else "0.1 0.2 2 1\n" * 20 for letter in frames]
    (folder / f"{name}_skeleton3D.txt").write_text("".join(rows))


def test_msr_sequences_become_one_recording_each(tmp_path: Path) -> None:
    msr_sequence(tmp_path, "a01_s02_e03", "x0x")
    msr_sequence(tmp_path, "a13_s09_e02", "00")
    calls: Calls = []
    report = import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: calls.append((done, total)))

    assert sorted(file.name for file in (tmp_path / "out").iterdir()) == ["a01_s02_e03.mcap", "a13_s09_e02.mcap"]
    assert calls == [(1, 2), (2, 2)]
    assert (report.files, report.frames, report.invalid_frames, report.segments, report.excluded) == (2, 5, 3, 2, 1)
    recording = Recording(tmp_path / "out" / "a01_s02_e03.mcap")
    assert recording.metadata == {"person": "2", "source": "msr-action3d", "action": "a01", "execution": "3"}
    assert recording.topics == {keys.SKELETON, keys.SEGMENT}
    messages = list(recording.messages())
    assert [message.valid for message in messages if not isinstance(message, Segment)] == [True, False, True]
    assert isinstance(messages[0], Segment)
    assert messages[0].label == "high arm wave"
    assert isinstance(messages[-1], Segment)
    assert Recording(tmp_path / "out" / "a13_s09_e02.mcap").metadata["excluded"] == "true"


def test_what_was_imported_and_mended_since_is_not_imported_over(tmp_path: Path) -> None:
    msr_sequence(tmp_path, "a01_s02_e03", "x0x")
    import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: None)
    (tmp_path / "out" / "a01_s02_e03.mcap").write_bytes(b"mended")
    with pytest.raises(FileExistsError, match="already exists: name another file, or remove the existing file"):
        import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: None)
    assert (tmp_path / "out" / "a01_s02_e03.mcap").read_bytes() == b"mended"


def test_an_import_that_is_broken_off_leaves_no_half_recording(tmp_path: Path) -> None:
    msr_sequence(tmp_path, "a01_s02_e03", "x0x")

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr("actum.recorder.Recorder.write", stop)
        import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: None)
    assert list((tmp_path / "out").iterdir()) == []


def test_an_imported_set_is_played_in_order_with_a_pause_between_sequences(tmp_path: Path) -> None:
    msr_sequence(tmp_path, "a01_s01_e01", "x0")
    msr_sequence(tmp_path, "a02_s01_e01", "xx")
    import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: None)
    frames = [frame for instant in RecordingSource(tmp_path / "out", "door").frames() for frame in instant]
    assert [frame.stamp_ns for frame in frames] == [0, 66_666_667, 1_066_666_667, 1_133_333_334]
    assert [frame.session_id for frame in frames if isinstance(frame, Skeleton)] == ["a01_s01_e01"] * 2 + [
        "a02_s01_e01"
    ] * 2
    assert {frame.sensor for frame in frames} == {"door"}


def test_utkinect_recordings_keep_their_segments(tmp_path: Path) -> None:
    images = (30, 60, 60, 90)
    (tmp_path / "joints_s03_e02.txt").write_text("".join(f"{image} " + "0.5 " * 60 + "\n" for image in images))
    (tmp_path / "actionLabel_modified.txt").write_text("s03_e02\npush: 30 60\npull: 60 90\ncarry: NaN NaN\n")
    calls: Calls = []
    report = import_utkinect(tmp_path, tmp_path / "out", lambda done, total: calls.append((done, total)))

    assert calls == [(1, 1)]
    assert report.lines() == [
        "1 recordings, 3 frames, 2 labelled segments",
        "2 actions: pull, push; 1 persons: 3",
        "0 frames without a skeleton, kept without people",
        "1 segments without bounds skipped: s03_e02 carry",
        "1 duplicate rows removed",
        "1 pairs of overlapping segments, both kept",
    ]
    recording = Recording(tmp_path / "out" / "s03_e02.mcap")
    assert (recording.person, recording.source) == ("3", "utkinect")
    order = [
        message.kind if isinstance(message, Segment) else message.stamp_ns // 10**9 for message in recording.messages()
    ]
    assert order == ["start", 1, "start", 2, "end", 3, "end"]


def test_segments_outside_of_the_frames_are_skipped_and_named(tmp_path: Path) -> None:
    (tmp_path / "joints_s03_e02.txt").write_text("".join(f"{image} " + "0.5 " * 60 + "\n" for image in (30, 60, 90)))
    (tmp_path / "actionLabel_modified.txt").write_text("s03_e02\npush: 30 60\npull: 60 99000000\n")
    report = import_utkinect(tmp_path, tmp_path / "out", lambda done, total: None)
    assert report.segments == 1 and "1 segments outside of the frames skipped: s03_e02" in str(report)
    marks = [m for m in Recording(tmp_path / "out/s03_e02.mcap").messages() if isinstance(m, Segment)]
    assert {mark.label for mark in marks if mark.kind == "start"} == {"push"}


def test_a_damaged_file_stops_the_import_and_is_named(tmp_path: Path) -> None:
    msr_sequence(tmp_path, "a01_s01_e01", "x")
    (tmp_path / "a01_s01_e02_skeleton3D.txt").write_text("1 2 3\n")
    with pytest.raises(DatasetError, match="a01_s01_e02"):
        import_msr_action3d(tmp_path, tmp_path / "out", lambda done, total: None)
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["a01_s01_e01.mcap"]


@pytest.mark.data
@pytest.mark.timeout(300)  # it writes 600 recordings
@pytest.mark.long
def test_the_real_sets_are_imported_whole(tmp_path: Path, data: Path) -> None:
    msr = import_msr_action3d(data / "msr_action3d", tmp_path / "msr", lambda done, total: None)
    assert (msr.files, msr.frames, msr.invalid_frames, msr.excluded) == (567, 23478, 1113, 10)
    assert len(list((tmp_path / "msr").glob("a??_s??_e??.mcap"))) == 567

    utkinect = import_utkinect(data / "utkinect", tmp_path / "ut", lambda done, total: None)
    assert (utkinect.files, utkinect.frames, utkinect.segments) == (20, 15318, 199)
    assert utkinect.oddities == {"duplicate_row": 542, "overlapping_pair": 7}
    assert utkinect.skipped == ["s10_e02 carry"]
    assert sum(len(list(Recording(f).messages())) for f in (tmp_path / "ut").iterdir()) == 15318 + 2 * 199

    msrc12 = import_msrc12(data / "msrc12", tmp_path / "msrc12", lambda done, total: None)
    assert (msrc12.files, msrc12.frames, msrc12.invalid_frames, msrc12.segments) == (298, 343362, 11957, 3115)
    assert (len(msrc12.actions), len(msrc12.persons), msrc12.skipped) == (12, 15, [])
