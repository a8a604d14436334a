"""MSR Action3D files become skeletons in the camera frame and one labelled segment each."""

from pathlib import Path

import numpy as np
import pytest

from actum.node import SECOND_NS
from actum.skeletons import INDEX, JOINTS
from actum_dataset_importer.msr_action3d import (
    CLASSES,
    EXCLUDED,
    read_sequence,
    sequence_files,
)
from actum_dataset_importer.takes import DatasetError, Take
from kinect_takes import facing

SOURCE_ROWS = {
    "head": 20,
    "neck": 3,
    "torso": 4,
    "left_shoulder": 1,
    "left_elbow": 8,
    "left_hand": 12,
    "right_shoulder": 2,
    "right_elbow": 9,
    "right_hand": 13,
    "left_hip": 5,
    "left_knee": 14,
    "left_foot": 18,
    "right_hip": 6,
    "right_knee": 15,
    "right_foot": 19,
}
"""The rows of a frame, from 1: shoulder A B, neck, spine, hip A B, hip centre, elbow A B, wrist A B, hand A B,
knee A B, ankle A B, foot A B, head. The actor's right is B."""


def sequence(folder: Path, name: str = "a01_s02_e03", frames: int = 3, empty: tuple[int, ...] = ()) -> Path:
    """Joint row r (from 1) of frame i lies at (r, 10 i, 2) with confidence r / 32."""
    path = folder / f"{name}_skeleton3D.txt"
    with path.open("w") as file:
        for i in range(frames):
            for row in range(1, 21):
                numbers = (0, 0, 0, 0) if i in empty else (row, 10 * i, 2, row / 32)
                file.write(" ".join(f"{number:.6f}" for number in numbers) + "\n")
    return path


def test_every_joint_is_found_by_its_name_in_the_camera_frame(tmp_path: Path) -> None:
    take = read_sequence(sequence(tmp_path), "kinect0")
    agent = take.frames[2].agents[0]
    for name in JOINTS:
        row = SOURCE_ROWS[name]
        assert agent.joints[INDEX[name]] == [-row, -20, 2], name
        assert agent.confidence[INDEX[name]] == row / 32, name
    assert agent.agent == 1


def test_frames_are_stamped_at_fifteen_a_second(tmp_path: Path) -> None:
    take = read_sequence(sequence(tmp_path, frames=31), "kinect0")
    assert [frame.stamp_ns for frame in take.frames[:4]] == [0, 66_666_667, 133_333_333, 200_000_000]
    assert take.frames[30].stamp_ns == 2 * SECOND_NS


def test_an_empty_frame_stays_as_an_invalid_one(tmp_path: Path) -> None:
    take = read_sequence(sequence(tmp_path, empty=(1,)), "kinect0")
    assert [frame.valid for frame in take.frames] == [True, False, True]
    assert take.frames[1].agents == []
    assert take.frames[1].reason == "no skeleton in the source"


def test_the_whole_sequence_is_one_labelled_segment(tmp_path: Path) -> None:
    take = read_sequence(sequence(tmp_path, "a20_s10_e02", empty=(0,)), "door")
    start, end = take.marks
    assert (start.kind, start.stamp_ns, start.label) == ("start", take.frames[0].stamp_ns, "pickup & throw")
    assert (end.kind, end.stamp_ns, end.label) == ("end", take.frames[-1].stamp_ns, None)
    assert start.segment_id == end.segment_id == "a20_s10_e02"
    assert {message.sensor for message in (*take.frames, *take.marks)} == {"door"}


def test_names_say_action_person_and_execution_and_the_ten_outside_the_usual_protocol_are_excluded(
    tmp_path: Path,
) -> None:
    take = read_sequence(sequence(tmp_path, "a07_s03_e01"), "kinect0")
    assert (take.name, take.person) == ("a07_s03_e01", "3")
    assert take.metadata == {"action": "a07", "execution": "1"}
    assert read_sequence(sequence(tmp_path, "a13_s09_e02"), "kinect0").metadata["excluded"] == "true"
    assert len(EXCLUDED) == 10


@pytest.mark.parametrize(
    "content", ["", "1 2 3 4\n" * 19, "1 2 3\n" * 20, "1 2 3 nan\n" * 20, "1 2 3 much\n" * 20, "1 2 3 4\n1 2\n"]
)
def test_a_file_of_another_form_is_an_error_that_names_it(tmp_path: Path, content: str) -> None:
    path = tmp_path / "a01_s01_e01_skeleton3D.txt"
    path.write_text(content)
    with pytest.raises(DatasetError, match=path.name):
        read_sequence(path, "kinect0")


@pytest.mark.parametrize("name", ["a21_s01_e01", "a00_s01_e01", "b01_s01_e01"])
def test_a_file_of_another_name_is_an_error(tmp_path: Path, name: str) -> None:
    with pytest.raises(DatasetError, match="not named like a01_s01_e01"):
        read_sequence(sequence(tmp_path, name), "kinect0")


def test_a_folder_without_sequences_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match=r"no file named \*_skeleton3D\.txt"):
        sequence_files(tmp_path)


def test_the_set_is_found_in_its_folder_or_in_real3d(tmp_path: Path) -> None:
    real3d = tmp_path / "real3d"
    real3d.mkdir()
    path = sequence(real3d)
    assert sequence_files(tmp_path) == sequence_files(real3d) == sequence_files(path) == [path]


def hand_path_m(take: Take, hand: str) -> float:
    """Length of a hand's path as seen from the torso."""
    joints = np.array([frame.agents[0].joints for frame in take.frames if frame.valid])
    from_torso = joints[:, INDEX[hand]] - joints[:, INDEX["torso"]]
    return float(np.linalg.norm(np.diff(from_torso, axis=0), axis=1).sum())


@pytest.mark.data
def test_the_real_set_has_its_known_size_and_faces_the_camera_and_acts_with_the_right_arm(data: Path) -> None:
    files = sequence_files(data / "msr_action3d")
    takes = [read_sequence(file, "kinect0") for file in files]
    assert len(takes) == 567
    assert sum(len(take.frames) for take in takes) == 23478
    assert sum(not frame.valid for take in takes for frame in take.frames) == 1113
    assert {take.name for take in takes} >= EXCLUDED
    assert {take.marks[0].label for take in takes} == set(CLASSES)
    assert {take.person for take in takes} == {str(person) for person in range(1, 11)}

    seen = [take for take in takes if any(frame.valid for frame in take.frames)]
    assert {take.name for take in takes} - {take.name for take in seen} == {"a13_s09_e02"}
    assert np.mean([facing(take) > 0 for take in seen]) > 0.99
    one_armed = [take for take in seen if take.name < "a06"]
    assert len(one_armed) == 133
    right = [hand_path_m(take, "right_hand") > hand_path_m(take, "left_hand") for take in one_armed]
    assert np.mean(right) > 0.95
