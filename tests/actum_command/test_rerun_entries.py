"""What Rerun shows of a message: where, in which frame, at which stamp; read back by Rerun's own reader."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rerun", reason="rerun-sdk is not installed: pip install -e '.[view]'")

from rerun.chunk import RrdReader

from actum.messages import Agent, Message, Skeleton
from actum.skeletons import INDEX
from actum.standard_body import BONES
from actum_command.viewers.rerun_entries import RerunEntries
from actum_command.viewers.rerun_program import saved
from empty_messages import mark
from people import STANDING, lacking, listed, skeleton
from scenes import action, rejected_action
from shown_messages import QUARTER_ABOUT_Z, STAMP_NS, cup, image, objects

Row = dict[str, Any]


def shown(folder: Path, *messages: Message) -> dict[str, list[Row]]:
    """Write messages to a file and read it again: the rows of each entity, in order, with their stamp (ns)."""
    with saved(folder / "a.rrd", ["kinect0"]) as stream:
        for message in messages:
            stream.show(message)
    rows: dict[str, list[Row]] = {}
    for chunk in RrdReader(folder / "a.rrd").stream():
        batch = chunk.to_record_batch()
        if "capture" in batch.schema.names:
            stamps = [stamp.value for stamp in batch.column("capture")]
            # as Python objects, stamps to the nanosecond would need pandas
            timeless = [field.name for field in batch.schema if not str(field.type).startswith("timestamp")]
            for stamp, row in zip(stamps, batch.select(timeless).to_pylist(), strict=True):
                rows.setdefault(chunk.entity_path, []).append({**row, "capture": stamp})
    return {path: sorted(each, key=lambda row: row["capture"]) for path, each in rows.items()}


def test_a_bone_ends_at_its_joints_and_a_joint_is_where_the_message_has_it(tmp_path: Path) -> None:
    rows = shown(tmp_path, skeleton(STAMP_NS, STANDING))
    [bones], [joints] = rows["/kinect0/people/1/bones"], rows["/kinect0/people/1/joints"]
    ends = np.array(bones["LineStrips3D:strips"])
    assert np.allclose(ends[:, 0], STANDING[[parent for parent, _, _ in BONES]])
    assert np.allclose(ends[:, 1], STANDING[[child for _, child, _ in BONES]])
    assert np.allclose(joints["Points3D:positions"], STANDING)
    assert joints["Points3D:labels"] == list(INDEX)
    assert bones["LineStrips3D:labels"] == ["agent 1"]


def test_left_is_blue_and_right_is_red(tmp_path: Path) -> None:
    [joints] = shown(tmp_path, skeleton(STAMP_NS, STANDING))["/kinect0/people/1/joints"]
    colours = [(rgba >> 24 & 255, rgba >> 16 & 255, rgba >> 8 & 255) for rgba in joints["Points3D:colors"]]
    red, _, blue = colours[INDEX["left_hand"]]
    assert blue > red
    red, _, blue = colours[INDEX["right_hand"]]
    assert red > blue


def test_a_stamp_is_exact_to_the_nanosecond(tmp_path: Path) -> None:
    rows = shown(tmp_path, skeleton(STAMP_NS, STANDING), objects(STAMP_NS + 1, cup()))
    assert rows["/kinect0/people/1/bones"][0]["capture"] == STAMP_NS
    assert rows["/kinect0/objects/3"][0]["capture"] == STAMP_NS + 1


def test_what_is_missing_or_not_finite_is_not_drawn_nor_are_its_bones(tmp_path: Path) -> None:
    joints = listed(lacking(STANDING, "left_elbow"))
    joints[INDEX["head"]] = [float("inf"), 0.0, 1.0]
    agent = Agent(agent=1, joints=joints, confidence=[1.0] * 15)
    rows = shown(tmp_path, Skeleton(stamp_ns=1, sensor="kinect0", agents=[agent]))
    assert len(rows["/kinect0/people/1/joints"][0]["Points3D:positions"]) == 13
    assert len(rows["/kinect0/people/1/bones"][0]["LineStrips3D:strips"]) == len(BONES) - 3


def test_nobody_known_is_a_person_without_joints(tmp_path: Path) -> None:
    rows = shown(tmp_path, skeleton(1, np.full((15, 3), np.nan)))
    assert rows["/kinect0/people/1/joints"][0]["Points3D:positions"] == []


def test_who_and_what_has_gone_is_taken_away_once(tmp_path: Path) -> None:
    frames = [skeleton(1, STANDING, STANDING), skeleton(2, STANDING), skeleton(3, STANDING)]
    rows = shown(tmp_path, *frames, objects(1, cup()), objects(2), objects(3))
    assert [row["capture"] for row in rows["/kinect0/people/2"] if row["Clear:is_recursive"] == [True]] == [2]
    assert [row["capture"] for row in rows["/kinect0/objects/3"] if row.get("Clear:is_recursive") == [True]] == [2]
    assert len(rows["/kinect0/people/1/bones"]) == 3
    assert "/kinect0/people/1" not in rows


def test_an_object_stands_where_the_message_has_it_with_its_axes_and_name(tmp_path: Path) -> None:
    [row] = shown(tmp_path, objects(STAMP_NS, cup()))["/kinect0/objects/3"]
    assert row["Transform3D:translation"] == [[0.5, -0.25, 2.0]]
    assert np.allclose(row["Transform3D:quaternion"], [QUARTER_ABOUT_Z])
    assert np.allclose(row["TransformAxes3D:axis_length"], [0.1])
    assert row["Points3D:labels"] == ["cup"]


def test_an_object_that_is_not_seen_is_grey(tmp_path: Path) -> None:
    rows = shown(tmp_path, objects(1, cup()), objects(2, cup(seen=False)))["/kinect0/objects/3"]
    assert rows[0]["Points3D:colors"] != rows[1]["Points3D:colors"]


def test_an_image_hangs_in_its_camera(tmp_path: Path) -> None:
    [row] = shown(tmp_path, image("jpeg", b"\xff\xd8 no real one"))["/kinect0/image/color"]
    assert row["Transform3D:translation"] == [[0.5, 0.25, 2.0]]
    column_major = [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
    assert np.allclose(row["Transform3D:mat3x3"], [column_major])
    assert np.allclose(row["Pinhole:image_from_camera"], [[500, 0, 0, 0, 510, 0, 320, 240, 1]])
    assert row["Pinhole:resolution"] == [[2.0, 1.0]]
    assert bytes(row["EncodedImage:blob"][0]) == b"\xff\xd8 no real one"


def test_raw_colours_keep_their_order_and_depth_its_millimetres(tmp_path: Path) -> None:
    rows = shown(tmp_path, image("bgr8", bytes(range(6))), image("depth16_mm", b"\xe8\x03\x00\x00"))
    [colour], [depth] = rows["/kinect0/image/color"], rows["/kinect0/image/depth"]
    assert bytes(colour["Image:buffer"][0]) == bytes(range(6))
    assert np.frombuffer(bytes(depth["DepthImage:buffer"][0]), "<u2").tolist() == [1000, 0]
    assert depth["DepthImage:meter"] == [1000.0]


def test_an_image_of_too_few_bytes_is_told_of_and_not_shown(tmp_path: Path) -> None:
    rows = shown(tmp_path, image("bgr8", b"123"))
    assert "/kinect0/image/color" not in rows
    [row] = rows["/kinect0/log/image"]
    assert row["TextLog:text"] == ["a bgr8 image of 2x1 has 6 bytes, but this one has 3"]
    assert row["TextLog:level"] == ["WARN"]


def test_partial_actions_are_courses_and_the_final_one_ends_them(tmp_path: Path) -> None:
    partial = {"final": False, "end_ns": None}
    answers = [
        action("lift", **partial, stamp_ns=1, confidence=0.25, completeness=0.5, familiarity=-3.5),
        action("lift", **partial, stamp_ns=2, confidence=0.75),
        action("lift", stamp_ns=3, confidence=1.0),
    ]
    rows = shown(tmp_path, *answers)

    def course(name: str) -> list[tuple[int, float]]:
        return [(row["capture"], *row["Scalars:scalars"]) for row in rows[f"/kinect0/courses/1/{name}"]]

    assert course("probability") == [(1, 0.25), (2, 0.75)]
    assert course("completeness") == [(1, 0.5)]
    assert course("familiarity") == [(1, -3.5)]
    assert [row["capture"] for row in rows["/kinect0/courses/1"]] == [3]


def test_marks_and_answers_are_lines_of_the_log(tmp_path: Path) -> None:
    rows = shown(tmp_path, mark("start", 1), action("lift", stamp_ns=2), rejected_action("no person", stamp_ns=3))
    assert [row["TextLog:text"] for row in rows["/kinect0/log/segment"]] == [["start one"]]
    answers = rows["/kinect0/log/action"]
    assert answers[0]["TextLog:text"] == ["s1 final: lift 0.94, 60 frames"]
    assert [row["TextLog:level"] for row in answers] == [["INFO"], ["WARN"]]
    assert "no person" in answers[1]["TextLog:text"][0]


def test_what_is_not_valid_is_told_of_and_not_drawn(tmp_path: Path) -> None:
    rows = shown(tmp_path, skeleton(1, STANDING).model_copy(update={"valid": False, "reason": "camera lost: [it]"}))
    assert [path for path in rows if "people" in path] == []
    assert rows["/kinect0/log/skeleton"][0]["TextLog:text"] == ["not valid: camera lost: [it]"]


def test_a_sensors_frame_is_declared_once() -> None:
    entries = RerunEntries()
    first, second = (entries.of(skeleton(stamp, STANDING)) for stamp in (1, 2))
    assert [entry.path for entry in first if entry.static] == ["kinect0"]
    assert [entry for entry in second if entry.static] == []
