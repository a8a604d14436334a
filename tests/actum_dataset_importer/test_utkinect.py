"""UTKinect recordings become skeletons in the camera frame, with their labelled segments as marks."""

from pathlib import Path

import pytest

from actum.node import SECOND_NS
from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer.takes import DatasetError
from actum_dataset_importer.utkinect import (
    LabelledSegment,
    overlapping_pairs,
    read_labelled,
    read_labels,
    read_recording,
    recording_files,
)
from kinect_takes import SOURCE_JOINTS, facing, times


def recording(folder: Path, images: list[int], name: str = "s01_e01") -> Path:
    """Joint j of row i lies at (j, 10 i, 2)."""
    rows = [[image, *(c for j in range(20) for c in (j, 10 * i, 2))] for i, image in enumerate(images)]
    path = folder / f"joints_{name}.txt"
    path.write_text("".join(" ".join(map(str, row)) + " \n" for row in rows))
    return path


def labels(folder: Path, text: str, name: str = "actionLabel_modified.txt") -> Path:
    (folder / name).write_text(text)
    return folder


def test_every_joint_is_found_by_its_name_in_the_camera_frame(tmp_path: Path) -> None:
    agent = read_recording(recording(tmp_path, [30, 32]), "kinect0").frames[1].agents[0]
    for name in JOINTS:
        assert agent.joints[INDEX[name]] == [-SOURCE_JOINTS.index(name), -10, 2], name
    assert (agent.agent, agent.confidence) == (1, [1.0] * 15)


def test_frames_are_stamped_by_image_number_at_thirty_a_second(tmp_path: Path) -> None:
    take = read_recording(recording(tmp_path, [30, 31, 35]), "door")
    assert [frame.stamp_ns for frame in take.frames] == [SECOND_NS, 1_033_333_333, 1_166_666_667]
    assert {frame.sensor for frame in take.frames} == {"door"}
    assert (take.name, take.person, take.metadata) == ("s01_e01", "1", {"execution": "1"})


def test_of_rows_with_the_same_image_number_the_first_is_kept(tmp_path: Path) -> None:
    take = read_recording(recording(tmp_path, [4, 6, 6, 6, 8]), "kinect0")
    heights = [frame.agents[0].joints[INDEX["head"]] for frame in take.frames]
    assert heights == [[-3, 0, 2], [-3, -10, 2], [-3, -40, 2]]
    assert take.oddities == {"duplicate_row": 2}


def test_labelled_segments_become_marks(tmp_path: Path) -> None:
    labels(tmp_path, "s01_e01\npush: 30 60 \npull:  75 90\n\ns01_e02\nwalk: 1 2\n")
    take = read_labelled(recording(tmp_path, [30, 60]), "kinect0", read_labels(tmp_path))
    assert times(take.marks) == [
        ("start", "s01_e01-push", SECOND_NS, "push"),
        ("end", "s01_e01-push", 2 * SECOND_NS, None),
        ("start", "s01_e01-pull", 2_500_000_000, "pull"),
        ("end", "s01_e01-pull", 3 * SECOND_NS, None),
    ]


def test_a_segment_without_bounds_is_skipped_and_named(tmp_path: Path) -> None:
    labels(tmp_path, "s01_e01\ncarry:  NaN NaN\nthrow: 30 60\n")
    take = read_labelled(recording(tmp_path, [30, 60]), "kinect0", read_labels(tmp_path))
    assert {mark.segment_id for mark in take.marks} == {"s01_e01-throw"}
    assert take.skipped == ["s01_e01 carry"]


@pytest.mark.parametrize(
    ("bounds", "pairs"),
    [
        ([(1, 5), (6, 9)], 0),
        ([(6, 9), (1, 6)], 1),
        ([(1, 9), (3, 4), None], 1),
        ([(1, 9), (3, 7), (6, 8)], 3),
    ],
)
def test_overlaps_are_kept_and_counted(tmp_path: Path, bounds: list[tuple[int, int] | None], pairs: int) -> None:
    segments = [LabelledSegment(f"class{i}", b) for i, b in enumerate(bounds)]
    assert overlapping_pairs(segments) == pairs
    take = read_recording(recording(tmp_path, [1]), "kinect0", segments)
    assert take.oddities["overlapping_pair"] == pairs
    assert len(take.marks) == 2 * sum(b is not None for b in bounds)


def test_the_uncorrected_labels_alone_are_refused(tmp_path: Path) -> None:
    labels(tmp_path, "s01_e01\npush: 2556 3622\n", name="actionLabel.txt")
    with pytest.raises(DatasetError, match=r"some starts and ends in actionLabel\.txt are wrong"):
        read_labels(tmp_path)


def test_missing_labels_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"actionLabel_modified\.txt is missing: put"):
        read_labels(tmp_path)


@pytest.mark.parametrize("text", ["push: 1 2\n", "s01_e01\npush 1 2\n", "s01_e01\npush: 9 3\n", "s01_e01\npush: 1\n"])
def test_a_label_line_of_another_form_is_an_error(tmp_path: Path, text: str) -> None:
    with pytest.raises(DatasetError, match=r"'push.*' does not have the form `action: start end`"):
        read_labels(labels(tmp_path, text))


def test_a_recording_that_the_labels_do_not_name_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="has no entry s01_e01 for"):
        read_labelled(recording(tmp_path, [1]), "kinect0", read_labels(labels(tmp_path, "s02_e01\npush: 1 2\n")))


@pytest.mark.parametrize("content", ["", "1 2 3\n", "x " * 61 + "\n", "inf " * 61 + "\n", "-1 " * 61 + "\n"])
def test_a_file_of_another_form_is_an_error_that_names_it(tmp_path: Path, content: str) -> None:
    path = tmp_path / "joints_s01_e01.txt"
    path.write_text(content)
    with pytest.raises(DatasetError, match="joints_s01_e01"):
        read_recording(path, "kinect0")


def test_image_numbers_that_fall_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="fall"):
        read_recording(recording(tmp_path, [4, 6, 5]), "kinect0")


def test_a_file_of_another_name_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="not named like joints_s01_e01"):
        read_recording(recording(tmp_path, [4], name="s1_e1"), "kinect0")


@pytest.mark.data
def test_the_real_set_has_its_known_size_and_faces_the_camera(data: Path) -> None:
    folder = data / "utkinect"
    label_table = read_labels(folder)
    takes = [read_labelled(file, "kinect0", label_table) for file in recording_files(folder)]
    assert len(takes) == 20
    assert sum(len(take.frames) + take.oddities["duplicate_row"] for take in takes) == 15860
    assert sum(take.oddities["duplicate_row"] for take in takes) == 542
    assert sum(take.oddities["overlapping_pair"] for take in takes) == 7
    assert [name for take in takes for name in take.skipped] == ["s10_e02 carry"]
    assert sum(len(take.marks) for take in takes) == 2 * 199
    assert min(facing(take) for take in takes) > 0.8
