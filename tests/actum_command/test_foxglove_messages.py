"""What Foxglove is given of a message: topics, frames, schemas; read back from a file by MCAP's own libraries."""

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

pytest.importorskip("foxglove", reason="foxglove-sdk is not installed: pip install -e '.[dev]'")
pytest.importorskip("mcap_protobuf", reason="mcap-protobuf-support is not installed: pip install -e '.[dev]'")

from mcap_protobuf.decoder import DecoderFactory

from actum.messages import Action, Event, Intent, Message, Segment, Tensor, Truth
from actum.skeletons import INDEX
from actum.standard_body import BONES
from actum_command.viewers.foxglove_sinks import foxglove_schema, written
from empty_messages import mark
from people import STANDING, lacking, skeleton
from rotation_of import rotation_of
from scenes import action
from shown_messages import STAMP_NS, cup, image, objects

Read = dict[str, list[Any]]


def put(folder: Path, *messages: Message) -> Read:
    """Write messages to a file and read it again: what each topic holds, with the time of each under `log_time`."""
    with written(folder / "a.mcap", {"person": "anna"}) as stream:
        for message in messages:
            stream.show(message)
    found: Read = {}
    with (folder / "a.mcap").open("rb") as file:
        for _, channel, message, decoded in decoded_from(file):
            found.setdefault(channel.topic, []).append((message.log_time, decoded))
    return found


def decoded_from(file: Any) -> Iterator[Any]:
    factory = DecoderFactory()
    for schema, channel, message in make_reader(file).iter_messages():
        decode = json.loads if channel.message_encoding == "json" else factory.decoder_for("protobuf", schema)
        yield schema, channel, message, decode(message.data)


def point(of: Any) -> list[float]:
    return [of.x, of.y, of.z]


def matrix(transform: Any) -> np.ndarray:
    """Return a frame's place as a matrix that maps points of the child's frame to the parent's."""
    parent_from_child = np.eye(4)
    rotation = transform.rotation
    parent_from_child[:3, :3] = rotation_of([rotation.x, rotation.y, rotation.z, rotation.w])
    parent_from_child[:3, 3] = point(transform.translation)
    return parent_from_child


def test_a_bone_ends_at_its_joints_and_a_joint_is_where_the_message_has_it(tmp_path: Path) -> None:
    [(_, update)] = put(tmp_path, skeleton(STAMP_NS, STANDING))["/actum/kinect0/skeleton"]
    [person] = update.entities
    ends = np.array([point(end) for end in person.lines[0].points]).reshape(-1, 2, 3)
    assert np.allclose(ends[:, 0], STANDING[[parent for parent, _, _ in BONES]])
    assert np.allclose(ends[:, 1], STANDING[[child for _, child, _ in BONES]])
    assert np.allclose([point(joint.pose.position) for joint in person.spheres], STANDING)
    assert (person.frame_id, person.id, person.texts[0].text) == ("kinect0", "agent 1", "agent 1")
    assert len(person.lines[0].colors) == len(person.lines[0].points)


def test_a_stamp_is_exact_to_the_nanosecond(tmp_path: Path) -> None:
    [(log_time_ns, update)] = put(tmp_path, skeleton(STAMP_NS, STANDING))["/actum/kinect0/skeleton"]
    time = update.entities[0].timestamp
    assert (log_time_ns, time.seconds, time.nanos) == (STAMP_NS, 1_700_000_000, 123_456_789)


@pytest.mark.parametrize("stamp_ns", [0, 2**62 - 1])
def test_a_stamp_that_foxglove_has_no_number_for_is_shown_as_the_last_it_has(tmp_path: Path, stamp_ns: int) -> None:
    assert put(tmp_path, skeleton(stamp_ns, STANDING))


def test_a_missing_joint_is_not_drawn_nor_are_its_bones(tmp_path: Path) -> None:
    [(_, update)] = put(tmp_path, skeleton(1, lacking(STANDING, "left_elbow")))["/actum/kinect0/skeleton"]
    assert len(update.entities[0].spheres) == 14
    assert len(update.entities[0].lines[0].points) == 2 * (len(BONES) - 2)


def test_who_and_what_has_gone_is_taken_away_once(tmp_path: Path) -> None:
    frames = [skeleton(1, STANDING, STANDING), skeleton(2, STANDING), skeleton(3, STANDING)]
    found = put(tmp_path, *frames, objects(1, cup()), objects(2), objects(3))
    deleted = {
        topic: [[each.id for each in update.deletions] for _, update in found[f"/actum/kinect0/{topic}"]]
        for topic in ("skeleton", "objects")
    }
    assert deleted == {"skeleton": [[], ["agent 2"], []], "objects": [[], ["object 3"], []]}


def test_an_object_is_drawn_in_a_frame_that_lies_where_the_message_has_it(tmp_path: Path) -> None:
    found = put(tmp_path, objects(STAMP_NS, cup()))
    [(_, frames)], [(_, update)] = found["/tf"], found["/actum/kinect0/objects"]
    [frame], [thing] = frames.transforms, update.entities
    assert (frame.parent_frame_id, frame.child_frame_id) == ("kinect0", "kinect0/object/3")
    assert np.allclose(matrix(frame)[:3], [[0, -1, 0, 0.5], [1, 0, 0, -0.25], [0, 0, 1, 2.0]])
    assert (thing.frame_id, thing.texts[0].text) == ("kinect0/object/3", "cup")
    assert np.allclose([point(end) for end in thing.lines[0].points[1::2]], 0.1 * np.eye(3))


@pytest.mark.parametrize("up", [None, [0.0, -2.0, 0.0], [0.1, -0.9, 0.4], [0.0, 0.0, 1.0], [-0.7, -0.1, -0.7]])
def test_the_cameras_frame_lies_in_one_whose_z_is_up(tmp_path: Path, up: list[float] | None) -> None:
    frame = skeleton(1, STANDING).model_copy(update={"up_in_camera": up})
    [(_, frames)] = put(tmp_path, frame)["/tf"]
    [transform] = frames.transforms
    z_up_from_camera = matrix(transform)[:3, :3]
    assert (transform.parent_frame_id, transform.child_frame_id) == ("kinect0/z_up", "kinect0")
    assert np.allclose(z_up_from_camera @ (up or [0, -1, 0]), [0, 0, np.linalg.norm(up or 1.0)])
    assert np.isclose(np.linalg.det(z_up_from_camera), 1.0)


def test_a_level_camera_looks_along_x(tmp_path: Path) -> None:
    [(_, frames)] = put(tmp_path, skeleton(1, STANDING))["/tf"]
    assert np.allclose(matrix(frames.transforms[0])[:3, :3] @ [0, 0, 1], [1, 0, 0])


def test_an_image_comes_with_its_camera_and_where_that_is(tmp_path: Path) -> None:
    found = put(tmp_path, image("jpeg", b"\xff\xd8 no real one", distortion=4))
    [(_, picture)], [(_, frames)] = found["/actum/kinect0/image/color"], found["/tf"]
    [(_, camera)] = found["/actum/kinect0/image/color/calibration"]
    assert (picture.format, picture.data) == ("jpeg", b"\xff\xd8 no real one")
    assert picture.frame_id == camera.frame_id == frames.transforms[0].child_frame_id == "kinect0/image/color"
    assert np.allclose(matrix(frames.transforms[0])[:3], [[0, -1, 0, 0.5], [1, 0, 0, 0.25], [0, 0, 1, 2.0]])
    assert (camera.width, camera.height, camera.distortion_model) == (2, 1, "plumb_bob")
    assert list(camera.K) == [500, 0, 320, 0, 510, 240, 0, 0, 1]
    assert list(camera.P) == [500, 0, 320, 0, 0, 510, 240, 0, 0, 0, 1, 0]
    assert list(camera.D) == [0.1, 0.1, 0.1, 0.1, 0]


@pytest.mark.parametrize(
    ("numbers", "model", "kept"), [(0, "plumb_bob", 5), (5, "plumb_bob", 5), (8, "rational_polynomial", 8), (14, "", 0)]
)
def test_a_distortion_is_named_or_left_out(tmp_path: Path, numbers: int, model: str, kept: int) -> None:
    [(_, camera)] = put(tmp_path, image("jpeg", b"", numbers))["/actum/kinect0/image/color/calibration"]
    assert (camera.distortion_model, len(camera.D)) == (model, kept)


def test_raw_images_say_how_their_bytes_lie(tmp_path: Path) -> None:
    found = put(tmp_path, image("bgr8", bytes(range(6))), image("depth16_mm", b"\xe8\x03\x00\x00"))
    [(_, colour)], [(_, depth)] = found["/actum/kinect0/image/color"], found["/actum/kinect0/image/depth"]
    assert (colour.encoding, colour.step, colour.data) == ("bgr8", 6, bytes(range(6)))
    assert (depth.encoding, depth.step, depth.data) == ("16UC1", 4, b"\xe8\x03\x00\x00")


def test_an_image_of_too_few_bytes_is_told_of_and_not_shown(tmp_path: Path) -> None:
    found = put(tmp_path, image("bgr8", b"123"))
    [(_, line)] = found["/actum/kinect0/log"]
    assert (set(found), line.message) == ({"/actum/kinect0/log"}, "a bgr8 image of 2x1 has 6 bytes, but this one has 3")


def test_marks_and_answers_are_json_with_every_field_and_lines_of_the_log(tmp_path: Path) -> None:
    partial = action("lift", final=False, end_ns=None, stamp_ns=2, completeness=0.5)
    found = put(tmp_path, mark("start", 1), partial, action("lift", stamp_ns=3))
    assert [Action.model_validate(fields) for _, fields in found["/actum/kinect0/action"]] == [
        partial,
        action("lift", stamp_ns=3),
    ]
    assert [fields["kind"] for _, fields in found["/actum/kinect0/segment"]] == ["start"]
    assert [line.message for _, line in found["/actum/kinect0/log"]] == ["start one", "s1 final: lift 0.94, 60 frames"]


def test_bytes_are_base64(tmp_path: Path) -> None:
    trace = Tensor(dtype="<f4", shape=[1], data=b"\xfb\xff\xbf\x00")
    [(_, fields)] = put(tmp_path, action("lift", stamp_ns=1, trace=trace))["/actum/kinect0/action"]
    assert base64.urlsafe_b64decode(fields["trace"]["data"]) == trace.data


def foxglove_reads(schema: dict[str, Any]) -> bool:
    """Tell whether Foxglove's reader of JSON Schemas takes a schema: plain types, objects with their properties."""
    match schema:
        case {"type": "object", "properties": properties}:
            return all(map(foxglove_reads, properties.values()))
        case {"type": "array", "items": {"type": "array"}}:
            return False
        case {"type": "array", "items": items}:
            return foxglove_reads(items)
        case {"type": "string" | "number" | "integer" | "boolean"}:
            return True
    return False


@pytest.mark.parametrize("kind", [Segment, Action, Event, Intent, Truth])
def test_foxglove_reads_the_schema_and_it_has_every_field(kind: type[Message]) -> None:
    schema = foxglove_schema(kind)
    assert foxglove_reads(schema)
    assert set(schema["properties"]) == set(kind.model_fields)
    assert schema["title"] == f"{kind.SCHEMA}/{kind.VERSION}"


def test_a_schema_goes_into_what_may_be_null() -> None:
    acted_on = foxglove_schema(Event)["properties"]["object"]
    assert acted_on["properties"]["pose"]["properties"]["position_m"]["items"] == {"type": "number"}
    assert foxglove_schema(Action)["properties"]["trace"]["properties"]["data"]["contentEncoding"] == "base64"


def test_the_metadata_of_the_recording_stays(tmp_path: Path) -> None:
    put(tmp_path, skeleton(1, STANDING))
    with (tmp_path / "a.mcap").open("rb") as file:
        assert [record.metadata for record in make_reader(file).iter_metadata()] == [{"person": "anna"}]


def test_left_is_blue_and_right_is_red(tmp_path: Path) -> None:
    [(_, update)] = put(tmp_path, skeleton(1, STANDING))["/actum/kinect0/skeleton"]
    left, right = (update.entities[0].spheres[INDEX[name]].color for name in ("left_hand", "right_hand"))
    assert left.b > left.r
    assert right.r > right.b
