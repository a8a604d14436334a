"""Takes of two hands and objects become postures without a body, objects, and marks that do not tell the object."""

import json
from pathlib import Path

import pytest

from actum import keys
from actum.geometry import from_flat, invert
from actum.messages import Objects, Posture, Segment, Truth
from actum.recording import Recording
from actum.skeletons import INDEX
from actum_dataset_importer.bimacs import camera_from_world, read_take, take_files
from actum_dataset_importer.importing import import_bimacs
from actum_dataset_importer.takes import DatasetError

BODIES = ("HandRight", "HandLeft", "Whisk", "Bottle", "Bowl")
FIELDS = ("x", "y", "z", "qx", "qy", "qz", "qw", "err", "valid")
PLACES = {
    "HandRight": (0.1, 0.2, 0.7),
    "HandLeft": (-0.3, 0.2, 0.6),
    "Whisk": (0.1, 0.3, 0.5),
    "Bottle": (1.0, 2.0, 3.0),
}
RIGHT = [0, [0, None, None], 2, [1, 4, "whisk_2"], 4, [3, 4, "whisk_4"], 3, [10, 0, "bowl_3"], 5]
LEFT = [0, [5, 0, "bowl_3"], 5]


def take(folder: Path, name: str = "subject0_take0", frames: int = 6, lost: tuple[str, int] = ("", -1)) -> Path:
    """Write a take in which everything rises by a decimetre a frame."""
    columns = [f"{body}_{field}" for body in BODIES for field in FIELDS]
    lines = [",".join(["frame", "stamp", "rec_time", *columns])]
    for i in range(frames):
        cells = [str(i), f"{1726141371.312375 + i / 60:.6f}", "0"]
        for body in BODIES:
            x, y, z = PLACES.get(body, (0.0, 0.0, 0.5))
            cells += [str(x), str(y), str(round(z + i / 10, 6)), "0", "0", "0", "1", "0", str(int(lost != (body, i)))]
        lines.append(",".join(cells))
    path = folder / f"{name}.csv"
    path.write_text("\n".join(lines) + "\n")
    person, number = name.removeprefix("subject").split("_take")
    labels = folder / f"labels_subject_{person}" / "task_1_k_cooking" / f"take_{number}.json"
    labels.parent.mkdir(parents=True, exist_ok=True)
    labels.write_text(json.dumps({"right_hand": RIGHT, "left_hand": LEFT}))
    return path


def test_the_worlds_up_is_the_cameras_up() -> None:
    assert camera_from_world([1.0, 2.0, 3.0]) == [1.0, -3.0, 2.0]


def test_hands_are_where_they_were_in_the_cameras_frame_and_nothing_else_is_known(tmp_path: Path) -> None:
    posture = read_take(take(tmp_path), "kinect0").postures[0]
    assert (posture.frame, posture.valid, posture.joints, posture.agent) == ("world", True, None, 1)
    assert posture.joints_m is not None and posture.ego_from_camera is not None
    known = {name: i for name, i in INDEX.items() if posture.joints_m[i] is not None}
    assert set(known) == {"left_hand", "right_hand"}
    camera_from_ego = invert(from_flat(posture.ego_from_camera))
    hand = posture.joints_m[INDEX["right_hand"]]
    assert (camera_from_ego[:3, :3] @ hand).tolist() == pytest.approx(camera_from_world(PLACES["HandRight"]))


def test_stamps_are_those_of_the_table_to_the_microsecond(tmp_path: Path) -> None:
    read = read_take(take(tmp_path), "kinect0")
    assert read.postures[0].stamp_ns == 1726141371_312375000
    assert [m.stamp_ns for m in read.postures] == [m.stamp_ns for m in read.objects]


def test_what_the_cameras_lost_is_not_seen_and_a_lost_hand_is_missing(tmp_path: Path) -> None:
    read = read_take(take(tmp_path, lost=("Whisk", 3)), "kinect0")
    seen = [{o.name: o.seen for o in message.objects}["whisk"] for message in read.objects]
    assert seen == [True, True, True, False, True, True]
    before, at = read.objects[2].objects, read.objects[3].objects
    assert {o.name: o.position_m for o in before}["whisk"] == {o.name: o.position_m for o in at}["whisk"]
    handless = read_take(take(tmp_path, lost=("HandLeft", 2)), "kinect0").postures[2]
    assert handless.joints_m is not None and handless.joints_m[INDEX["left_hand"]] is None


def test_marks_name_hand_and_action_and_never_the_object(tmp_path: Path) -> None:
    read = read_take(take(tmp_path), "kinect0")
    starts = [mark for mark in read.marks if mark.kind == "start"]
    assert [(mark.hand, mark.label) for mark in starts] == [
        ("right", "idle"), ("right", "approach"), ("right", "stir"), ("left", "hold"),
    ]  # fmt: skip
    assert len({mark.segment_id for mark in starts}) == len(starts)
    assert read.skipped == ["subject0_take0 right lift"]
    text = "".join(mark.model_dump_json() for mark in read.marks)
    assert not any(name in text for name in ("whisk", "bowl", "bottle"))
    assert [(t.action, t.object_name) for t in read.truths] == [
        ("approach", "whisk"), ("stir", "bowl"), ("hold", "bowl"),
    ]  # fmt: skip


def test_takes_become_one_recording_each(tmp_path: Path) -> None:
    for name in ("subject0_take10", "subject0_take2", "subject1_take0"):
        take(tmp_path, name)
    calls: list[tuple[int, int]] = []
    report = import_bimacs(tmp_path, tmp_path / "out", lambda done, total: calls.append((done, total)))
    assert [file.stem for file in take_files(tmp_path)] == ["subject0_take2", "subject0_take10", "subject1_take0"]
    assert calls == [(1, 3), (2, 3), (3, 3)]
    assert (report.files, report.frames, report.segments) == (3, 18, 12)
    recording = Recording(tmp_path / "out" / "subject1_take0.mcap")
    assert (recording.person, recording.source) == ("1", "bimacs")
    assert recording.topics == {keys.POSTURE, keys.OBJECTS, keys.SEGMENT, keys.TRUTH}
    kinds = {type(message) for message in recording.messages()}
    assert kinds == {Posture, Objects, Segment, Truth}


def test_what_is_no_take_is_named(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="give the folder of the data set"):
        take_files(tmp_path)
    path = take(tmp_path)
    path.write_text(path.read_text().replace("Bowl_x", "Pot_x"))
    with pytest.raises(DatasetError, match="subject0_take0.csv lacks the time stamp or a pose"):
        read_take(path, "kinect0")
    with pytest.raises(DatasetError, match="put the folder labels_subject_"):
        read_take(take(tmp_path).rename(tmp_path / "subject0_take7.csv"), "kinect0")


def test_other_objects_are_read_as_well(tmp_path: Path) -> None:
    path = take(tmp_path)
    path.write_text(path.read_text().replace("Whisk_", "Knife_").replace("Bottle_", "CuttingBoard_"))
    labels = tmp_path / "labels_subject_0" / "task_1_k_cooking" / "take_0.json"
    labels.write_text(json.dumps({"right_hand": [0, [7, 3, "cutting_board_1"], 5], "left_hand": LEFT}))
    read = read_take(path, "kinect0")
    assert {(found.id, found.name) for found in read.objects[0].objects} == {
        (0, "bowl"), (1, "knife"), (3, "cutting board"),
    }  # fmt: skip
    assert [(t.action, t.object_id, t.object_name) for t in read.truths] == [
        ("cut", 3, "cutting board"), ("hold", 0, "bowl"),
    ]  # fmt: skip


def test_an_object_that_the_table_lacks_is_named(tmp_path: Path) -> None:
    path = take(tmp_path)
    path.write_text(path.read_text().replace("Whisk_", "Table_"))
    with pytest.raises(
        DatasetError, match="the object whisk, but the file of positions has no columns for this object"
    ):
        read_take(path, "kinect0")


def test_numbers_of_what_the_cameras_lost_need_not_be_there(tmp_path: Path) -> None:
    path = take(tmp_path, lost=("Bottle", 2))
    path.write_text(path.read_text().replace("1.0,2.0,3.2,0,0,0,1,0,0", ",,,,,,,,0"))
    seen = [{o.name: o.seen for o in message.objects}["bottle"] for message in read_take(path, "kinect0").objects]
    assert seen == [True, True, False, True, True, True]


def test_labels_beyond_the_table_are_no_labels_of_it(tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="lacks the time stamp or a pose"):
        read_take(take(tmp_path, frames=4), "kinect0")
