"""MSRC-12 streams become skeletons in the camera frame, with a labelled segment about each action point."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer.msrc12 import GESTURES, REACH_US, read_stream, spans_about, stream_names
from actum_dataset_importer.takes import DatasetError, Take
from kinect_takes import SOURCE_JOINTS, facing, times

NAME = "P3_1_10A_p01"
S = 1_000_000


def person(folder: Path, names: list[str], **parts: object) -> Path:
    """Joint j of frame i lies at (j, 10 i, 2) m, but nobody is in frame 2; a frame every second from 5 s on."""
    j, i = np.meshgrid(np.arange(20), np.arange(10))
    xyz_mm = 1000 * np.stack([j, 10 * i, np.full_like(i, 2)], axis=-1)
    xyz_mm[2] = 0
    usual: dict[str, object] = {"xyz_mm": xyz_mm, "t_us": np.arange(5, 15) * S, "tags_us": np.array([6, 8, 12]) * S}
    path = folder / "p01.npz"
    np.savez(path, **{f"{name}.{part}": np.asarray(v) for name in names for part, v in (usual | parts).items()})
    return path


def take(folder: Path, name: str = NAME, **parts: object) -> Take:
    return read_stream(person(folder, [name], **parts), name, "door")


def test_every_joint_is_found_by_its_name_in_the_camera_frame(tmp_path: Path) -> None:
    agent = take(tmp_path).frames[1].agents[0]
    for name in JOINTS:
        assert agent.joints[INDEX[name]] == [-SOURCE_JOINTS.index(name), -10, 2], name
    assert (agent.agent, agent.confidence) == (1, [1.0] * 15)


def test_a_stream_tells_whose_it_is_and_keeps_its_stamps(tmp_path: Path) -> None:
    read = take(tmp_path)
    assert (read.name, read.person, read.metadata) == (NAME, "1", {"instruction": "3", "set": "1", "gesture": "10A"})
    assert [frame.stamp_ns for frame in read.frames] == [1000 * S * second for second in range(5, 15)]
    assert {(frame.sensor, frame.session_id) for frame in read.frames} == {("door", NAME)}


def test_a_frame_of_zeros_had_no_skeleton(tmp_path: Path) -> None:
    frames = take(tmp_path).frames
    assert [i for i, frame in enumerate(frames) if not frame.valid] == [2]
    assert (frames[2].agents, frames[2].reason) == ([], "no skeleton in the source")


def test_segments_become_marks_named_with_the_gesture(tmp_path: Path) -> None:
    assert times(take(tmp_path).marks) == [
        ("start", f"{NAME}-01", 5_000_000_000, "change weapon"),
        ("end", f"{NAME}-01", 7_000_000_000, None),
        ("start", f"{NAME}-02", 7_000_000_000, "change weapon"),
        ("end", f"{NAME}-02", 9_500_000_000, None),
        ("start", f"{NAME}-03", 10_500_000_000, "change weapon"),
        ("end", f"{NAME}-03", 13_500_000_000, None),
    ]


def test_a_point_that_the_stream_does_not_reach_is_skipped_and_named(tmp_path: Path) -> None:
    read = take(tmp_path, tags_us=[2 * S, 6 * S, 30 * S])
    assert {mark.segment_id for mark in read.marks} == {f"{NAME}-02"}
    assert read.skipped == [f"{NAME}-01", f"{NAME}-03"]


def test_a_stream_without_points_has_no_segments(tmp_path: Path) -> None:
    assert take(tmp_path, tags_us=np.array([], dtype=np.int64)).marks == []


@given(st.lists(st.integers(0, 60 * S), unique=True).map(sorted))
def test_segments_hold_their_points_and_do_not_overlap(points_us: list[int]) -> None:
    spans = [span for span in spans_about(np.array(points_us, dtype=np.int64), -1, 60 * S + 1) if span]
    assert len(spans) == len(points_us)
    for (start, end), point in zip(spans, points_us, strict=True):
        assert point - REACH_US <= start <= point <= end <= point + REACH_US
    assert all(before[1] <= after[0] for before, after in pairwise(spans))


def test_streams_are_listed_by_person_and_name(tmp_path: Path) -> None:
    path = person(tmp_path, ["P3_1_2_p01", "P1_1_2_p01"])
    assert stream_names(tmp_path) == [(path, "P1_1_2_p01"), (path, "P3_1_2_p01")]


def test_a_folder_without_the_set_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"contains no file named p\*\.npz"):
        stream_names(tmp_path)


@pytest.mark.parametrize("content", [b"", b"nothing of the kind", b"PK\x03\x04 broken off"])
def test_a_file_that_holds_no_arrays_is_an_error_that_names_it(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "p01.npz").write_bytes(content)
    with pytest.raises(DatasetError, match=r"p01\.npz cannot be read as a file of MSRC-12 streams: download"):
        stream_names(tmp_path)


@pytest.mark.parametrize("at", [0.2, 0.5, 0.8])
def test_a_damaged_stream_is_an_error_that_names_it(tmp_path: Path, at: float) -> None:
    path = person(tmp_path, [NAME], xyz_mm=np.random.default_rng(0).integers(1, 999, (10, 20, 3)))
    with np.load(path) as arrays:
        np.savez_compressed(path, **arrays)
    content = bytearray(path.read_bytes())
    middle = int(at * content.index(b".t_us"))
    content[middle : middle + 20] = bytes(20)
    path.write_bytes(content)
    with pytest.raises(DatasetError, match=rf"p01\.npz: the stream {NAME} is incomplete"):
        read_stream(path, NAME, "kinect0")


@pytest.mark.parametrize("name", ["P3_1_13_p01", "P3_1_0_p01", "wave"])
def test_a_stream_of_another_name_is_an_error(tmp_path: Path, name: str) -> None:
    with pytest.raises(DatasetError, match=f"'{name}' is not named like"):
        take(tmp_path, name)


@pytest.mark.parametrize(
    "parts",
    [
        {"t_us": np.arange(9)},
        {"t_us": np.zeros(10, dtype=int)},
        {"xyz_mm": np.zeros((10, 15, 3), dtype=int)},
        {"xyz_mm": np.zeros((0, 20, 3), dtype=int), "t_us": np.array([], dtype=int)},
        {"tags_us": [8 * S, 6 * S]},
    ],
)
def test_a_stream_of_another_form_is_an_error_that_names_it(tmp_path: Path, parts: dict[str, object]) -> None:
    with pytest.raises(DatasetError, match=f"{NAME} does not consist of frames"):
        take(tmp_path, **parts)


def test_a_stream_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="P3_1_2_p01 is incomplete"):
        read_stream(person(tmp_path, [NAME]), "P3_1_2_p01", "kinect0")


@pytest.mark.data
def test_the_real_set_has_its_known_size_and_faces_the_camera(data: Path) -> None:
    streams = stream_names(data / "msrc12")
    assert len(streams) == 298
    first_of_each = {name.split("_")[2].rstrip("A"): (file, name) for file, name in reversed(streams)}
    takes = [read_stream(file, name, "kinect0") for file, name in first_of_each.values()]
    assert {mark.label for read in takes for mark in read.marks if mark.label} == set(GESTURES)
    for read in takes:
        assert facing(read) > 0.8, read.name
