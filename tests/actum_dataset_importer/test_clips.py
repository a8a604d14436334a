"""Clips named with their action become recordings, through the camera's own code."""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest

from actum import keys
from actum.calibration import Calibration
from actum.messages import Segment, Skeleton
from actum.recording import Recording
from actum_dataset_importer.clips import DEFAULT_PATTERN, Naming, check_names, clip_files, recording_name
from actum_dataset_importer.importing import ImportReport, import_video
from actum_dataset_importer.takes import DatasetError
from camera_bodies import as_seen, standing_at
from camera_videos import write_video
from sensor_gateway.optics import Optics
from sensor_gateway.people.landmarks import Landmarks

FLORENCE = r".*actor(?P<person>\d+)idAction\d+category(?P<action>\d+)"


class Seer:
    """A model that sees one person in every picture but the first, and notes the stamps."""

    def __init__(self) -> None:
        self.stamps_ns: list[int] = []

    def people(self, image_bgr: np.ndarray, stamp_ns: int) -> list[Landmarks]:
        self.stamps_ns.append(stamp_ns)
        return [as_seen(standing_at(stamp_ns / 1e10, 2.5))] if len(self.stamps_ns) > 1 else []


def imported(
    source: Path, out: Path, pattern: str = DEFAULT_PATTERN, names: str = "", optics: Optics | None = None
) -> tuple[ImportReport, list[Seer]]:
    seers: list[Seer] = []

    def opened() -> nullcontext[Seer]:
        seers.append(Seer())
        return nullcontext(seers[-1])

    naming = Naming.of(pattern, names)
    optics = optics or Optics()
    report = import_video(source, out, lambda done, total: None, naming=naming, optics=optics, opened=opened)
    return report, seers


@pytest.mark.parametrize(
    ("name", "pattern", "told"),
    [
        ("wave_anna", DEFAULT_PATTERN, ("wave", "anna")),
        ("answer phone_anna_take 2", DEFAULT_PATTERN, ("answer phone", "anna")),
        ("GestureRecording_Id10actor3idAction10category5", FLORENCE, ("tight lace", "3")),
        ("GestureRecording_Id1actor10idAction1category9", FLORENCE, ("9", "10")),
        ("wave07", r"(?P<action>\D+)\d+", ("wave", "")),
    ],
)
def test_a_name_tells_action_and_person(name: str, pattern: str, told: tuple[str, str]) -> None:
    assert Naming.of(pattern, "5=tight lace, 4=clap").read(Path(f"/clips/{name}.mp4")) == told


@pytest.mark.parametrize(
    ("pattern", "names", "complaint"),
    [
        ("(", "", "not a valid regular expression"),
        (r"(?P<person>.*)", "", "does not say which part"),
        (DEFAULT_PATTERN, "1", "does not have the form NUMBER=NAME,NUMBER=NAME: write for example 1=wave"),
        (DEFAULT_PATTERN, "1=", "does not have the form NUMBER=NAME,NUMBER=NAME: write for example 1=wave"),
    ],
)
def test_options_that_cannot_be_used_are_refused(pattern: str, names: str, complaint: str) -> None:
    with pytest.raises(DatasetError, match=complaint):
        Naming.of(pattern, names)


def test_each_clip_becomes_a_recording_of_which_the_whole_is_one_labelled_segment(tmp_path: Path) -> None:
    write_video(tmp_path / "clips" / "wave_anna.avi")
    write_video(tmp_path / "clips" / "more" / "clap_ben_2.avi", frames=4)
    report, seers = imported(tmp_path / "clips", tmp_path / "out", names="clap=applaud")
    assert (report.files, report.frames, report.segments) == (2, 10, 2)
    assert [file.stem for file in clip_files(tmp_path / "clips")] == ["clap_ben_2", "wave_anna"]
    assert len(seers) == 2, "no clip is seen with the memory of another"
    assert seers[1].stamps_ns == [i * 100_000_000 for i in range(6)]

    recording = Recording(tmp_path / "out" / "clap_ben_2.mcap")
    assert (recording.person, recording.source) == ("ben", "video")
    assert recording.metadata["lens"] == "assumed: 60 degrees along the longer side, not calibrated"
    assert recording.topics == {keys.SKELETON, keys.SEGMENT}, "images are not kept"
    start, *frames, end = recording.messages()
    assert isinstance(start, Segment)
    assert isinstance(end, Segment)
    assert (start.kind, start.label, end.kind) == ("start", "applaud", "end")
    assert (start.stamp_ns, end.stamp_ns) == (frames[0].stamp_ns, frames[-1].stamp_ns) == (0, 300_000_000)
    assert all(isinstance(frame, Skeleton) and frame.valid for frame in frames)
    assert [len(frame.agents) for frame in frames if isinstance(frame, Skeleton)] == [0, 1, 1, 1]


def test_clips_of_another_size_than_was_calibrated_are_told(tmp_path: Path) -> None:
    write_video(tmp_path / "clips" / "wave_anna.avi")
    calibration = Calibration(image_size=(640, 480), K=[600, 0, 320, 0, 600, 240, 0, 0, 1], distortion=[])
    report, _ = imported(tmp_path / "clips", tmp_path / "out", optics=Optics(calibration=calibration))
    assert report.lines()[-2:] == [
        "6 frames without a skeleton, kept without people",
        "6 frames of another size than the calibration's: no people are detected in them",
    ]


def test_a_name_that_does_not_tell_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    write_video(tmp_path / "clips" / "wave_anna.avi")
    write_video(tmp_path / "clips" / "zzz.avi")
    with pytest.raises(DatasetError, match=r"zzz\.avi is not imported, because --pattern "):
        imported(tmp_path / "clips", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_clip_that_was_imported_is_refused_before_any_is_read(tmp_path: Path) -> None:
    write_video(tmp_path / "clips" / "wave_anna.avi")
    imported(tmp_path / "clips", tmp_path / "out")
    write_video(tmp_path / "clips" / "clap_ben.avi")
    with pytest.raises(FileExistsError, match=r"wave_anna\.mcap already exists"):
        imported(tmp_path / "clips", tmp_path / "out")
    assert [file.name for file in (tmp_path / "out").iterdir()] == ["wave_anna.mcap"]


def test_a_broken_clip_and_an_empty_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="contains no video"):
        imported(tmp_path, tmp_path / "out")
    (tmp_path / "wave_anna.mp4").write_text("no video")
    with pytest.raises(DatasetError, match=r"wave_anna\.mp4 is not a video"):
        imported(tmp_path, tmp_path / "out")


def test_names_in_any_script_stay_apart() -> None:
    named = [recording_name(Path(f"{name}.mp4")) for name in ("挥手_张三", "喝水_李四", "marché_ó", "a b/c")]
    assert named == ["挥手_张三", "喝水_李四", "marché_ó", "c"]


@pytest.mark.parametrize(
    "other", ["day2/wave_anna.mp4", "day1/wave_anna.avi", "day1/Wave_Anna.mp4", "day1/wave_an na.mp4"]
)
def test_two_clips_of_one_name_are_refused_before_anything_is_written(other: str) -> None:
    one = Path("day1/wave_an_na.mp4" if " " in other else "day1/wave_anna.mp4")
    check_names([one, Path("day1/drink_anna.mp4")])
    with pytest.raises(DatasetError, match="would both be"):
        check_names([one, Path(other)])


def test_an_action_that_is_not_told_is_refused() -> None:
    with pytest.raises(DatasetError, match="finds no action in this file name"):
        Naming.of(r"(?P<action>[a-z]+)?_.*", "").read(Path("_anna.mp4"))
