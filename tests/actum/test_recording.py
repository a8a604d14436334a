"""A recording gives back what was written, in order of stamp, and says clearly what it cannot read."""

import json
from pathlib import Path

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import Writer

from actum import codec, keys
from actum.messages import Agent, Image, Message, Objects, Segment, Skeleton
from actum.recorder import CHUNK_BYTES, Recorder
from actum.recording import Recording, RecordingError
from empty_messages import image, mark


def skeleton(stamp_ns: int, **fields: object) -> Skeleton:
    agent = Agent(agent=1, joints=[[0.5, j, 2.0] for j in range(14)] + [None], confidence=[1.0] * 15)
    return Skeleton.model_validate({"stamp_ns": stamp_ns, "sensor": "kinect0", "agents": [agent], **fields})


def depth(stamp_ns: int) -> Image:
    return image(stamp_ns).model_copy(update={"format": "depth16_mm"})


def written(path: Path, *messages: Message) -> Recording:
    with Recorder(path, person="1", source="test") as recorder:
        for message in messages:
            recorder.write(message)
    return Recording(path)


def write_foreign(path: Path, key: str, payload: bytes, publish_ns: int = 5, schema: str = "") -> None:
    """A recording as another program may write it."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema_id = writer.register_schema(schema, "jsonschema", b"{}") if schema else 0
        channel = writer.register_channel(key, "msgpack", schema_id)
        writer.add_message(channel, log_time=9, data=payload, publish_time=publish_ns)
        writer.finish()


def test_what_was_written_comes_back_with_its_number(tmp_path: Path) -> None:
    objects = Objects(stamp_ns=3, sensor="kinect0", objects=[])
    messages = [skeleton(1, session_id="s"), image(2), depth(2), objects, mark("start", 4, label="push")]
    read = list(written(tmp_path / "a.mcap", *messages).messages())
    assert read == [message.model_copy(update={"seq": 0}) for message in messages]


def test_a_number_on_a_message_is_kept_and_counted_on_from(tmp_path: Path) -> None:
    recording = written(tmp_path / "a.mcap", skeleton(1), skeleton(2, seq=7), skeleton(3), mark("start", 3))
    assert [(type(message), message.seq) for message in recording.messages()] == [
        (Skeleton, 0),
        (Skeleton, 7),
        (Segment, 0),
        (Skeleton, 8),
    ]


def test_person_source_action_points_and_free_fields_are_metadata(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="3", source="msr-action3d", excluded="true"):
        pass
    recording = Recording(tmp_path / "a.mcap")
    assert (recording.person, recording.source) == ("3", "msr-action3d")
    assert recording.metadata == {"person": "3", "source": "msr-action3d", "excluded": "true"}
    assert recording.action_points_ns == {}
    assert list(recording.messages()) == []
    with Recorder(tmp_path / "b.mcap", person="3", source="test", action_points_ns='{"x-01": 5}'):
        pass
    assert Recording(tmp_path / "b.mcap").action_points_ns == {"x-01": 5}


def test_any_mcap_tool_finds_key_schema_and_times(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="1", source="test") as recorder:
        recorder.write(skeleton(20, seq=4), log_time_ns=23)
        recorder.write(skeleton(30))
    with (tmp_path / "a.mcap").open("rb") as file:
        (schema, channel, first), (_, _, second) = make_reader(file).iter_messages()
    assert (channel.topic, channel.message_encoding) == ("actum/kinect0/skeleton", "msgpack")
    assert channel.metadata == {"encoding": "application/msgpack;actum.skeleton/1"}
    assert schema is not None
    assert (schema.name, schema.encoding) == ("actum.skeleton/1", "jsonschema")
    assert json.loads(schema.data).items() >= Skeleton.model_json_schema().items()
    assert (first.publish_time, first.log_time, first.sequence) == (20, 23, 4)
    assert (second.publish_time, second.log_time, second.sequence) == (30, 30, 5)
    assert msgpack.unpackb(first.data)["stamp_ns"] == 20


@given(order=st.permutations(range(7)))
def test_messages_come_in_order_of_stamp_whatever_order_they_were_written_in(
    tmp_path_factory: pytest.TempPathFactory, order: list[int]
) -> None:
    in_order = [
        skeleton(10, seq=0),
        mark("start", 20, seq=0),
        skeleton(20, seq=1),
        mark("end", 20, "earlier", seq=1),
        mark("start", 30, "later", seq=2),
        skeleton(30, seq=2),
        mark("end", 30, seq=3),
    ]
    path = tmp_path_factory.mktemp("order") / "a.mcap"
    assert list(written(path, *(in_order[i] for i in order)).messages()) == in_order


def test_images_are_merged_into_the_order_of_stamps(tmp_path: Path) -> None:
    recording = written(tmp_path / "a.mcap", image(1), image(3), depth(2), mark("start", 1), skeleton(2))
    assert [(message.stamp_ns, keys.address_of(message).topic.leaf) for message in recording.messages()] == [
        (1, "segment"),
        (1, "image/color"),
        (2, "skeleton"),
        (2, "image/depth"),
        (3, "image/color"),
    ]


def test_only_the_topics_asked_for_are_read(tmp_path: Path) -> None:
    recording = written(tmp_path / "a.mcap", image(1), skeleton(2), mark("start", 3))
    assert recording.topics == {keys.COLOR, keys.SKELETON, keys.SEGMENT}
    assert [type(message) for message in recording.messages({keys.SKELETON, keys.SEGMENT})] == [Skeleton, Segment]
    assert [type(message) for message in recording.messages({keys.COLOR})] == [Image]
    assert recording.skipped == {}


def test_a_mark_must_have_its_stamp_to_be_recorded(tmp_path: Path) -> None:
    with Recorder(tmp_path / "a.mcap", person="1", source="test") as recorder, pytest.raises(ValueError, match="stamp"):
        recorder.write(mark("start", None))


def test_a_foreign_mark_without_a_stamp_has_its_publish_time(tmp_path: Path) -> None:
    payload = msgpack.packb({"kind": "start", "segment_id": "one"})
    write_foreign(tmp_path / "a.mcap", "actum/kinect0/segment", payload, publish_ns=77)
    recording = Recording(tmp_path / "a.mcap")
    assert list(recording.messages()) == [mark("start", 77)]
    assert (recording.person, recording.metadata) == ("", {})


@pytest.mark.parametrize(
    ("key", "payload", "schema", "kind"),
    [
        ("robot/odometry", b"\x80", "", "unknown_key"),
        ("actum/kinect0/skeleton", b"\xc1", "", "not_msgpack"),
        ("actum/kinect0/skeleton", msgpack.packb([1]), "", "not_a_map"),
        ("actum/kinect0/skeleton", msgpack.packb({"stamp_ns": -1, "agents": []}), "", "wrong_fields"),
        ("actum/kinect0/skeleton", codec.encode(skeleton(1)).payload, "actum.skeleton/2", "higher_version"),
        ("actum/kinect0/skeleton", codec.encode(skeleton(1)).payload, "actum.image/1", "wrong_schema"),
    ],
)
def test_foreign_messages_are_skipped_and_counted(
    tmp_path: Path, key: str, payload: bytes, schema: str, kind: str
) -> None:
    write_foreign(tmp_path / "a.mcap", key, payload, schema=schema)
    recording = Recording(tmp_path / "a.mcap")
    for _ in range(2):
        assert list(recording.messages()) == []
        assert recording.skipped == {kind: 1}, "of the newest pass"


def test_a_file_takes_its_name_when_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "new" / "a.mcap"
    with Recorder(path, person="1", source="test") as recorder:
        recorder.write(skeleton(1))
        assert [file.name for file in path.parent.iterdir()] == ["a.mcap.part"]
    assert [file.name for file in path.parent.iterdir()] == ["a.mcap"]


def test_an_exception_leaves_a_readable_part(tmp_path: Path) -> None:
    with (
        pytest.raises(KeyError, match="stop"),
        Recorder(tmp_path / "a.mcap", person="1", source="test") as recorder,
    ):
        recorder.write(skeleton(1))
        raise KeyError("stop")
    assert [file.name for file in tmp_path.iterdir()] == ["a.mcap.part"]
    assert len(list(Recording(tmp_path / "a.mcap.part").messages())) == 1


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("deleted", [False, True])
def test_a_discarded_recording_is_gone_even_where_somebody_else_deleted_it(
    tmp_path: Path, closed: bool, deleted: bool
) -> None:
    recorder = Recorder(tmp_path / "a.mcap", person="1", source="test")
    if closed:
        recorder.close()
    if deleted:
        next(tmp_path.iterdir()).unlink()
    recorder.discard()
    assert list(tmp_path.iterdir()) == []


def test_what_was_written_before_a_crash_is_readable(tmp_path: Path) -> None:
    count = 3 * CHUNK_BYTES // len(codec.encode(skeleton(1)).payload)
    with Recorder(tmp_path / "a.mcap", person="1", source="test") as recorder:
        for i in range(count):
            recorder.write(skeleton(i))
        (tmp_path / "crashed.mcap").write_bytes((tmp_path / "a.mcap.part").read_bytes())
    crashed = Recording(tmp_path / "crashed.mcap")
    stamps = [message.stamp_ns for message in crashed.messages()]
    assert crashed.truncated
    assert crashed.person == "1"
    assert stamps == list(range(len(stamps)))
    assert count / 3 < len(stamps) < count


def test_a_file_that_is_missing_or_no_mcap_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="No such file"):
        Recording(tmp_path / "a.mcap")
    for content in (b"", b"\x89MCAP", b"\x89MCAP1\r\n", b"PK\x03\x04 something else altogether"):
        (tmp_path / "a.mcap").write_bytes(content)
        with pytest.raises(RecordingError, match=r"a\.mcap: the file is not an MCAP file; give a recording"):
            Recording(tmp_path / "a.mcap")


@pytest.mark.parametrize("points", ["", "[1]", '{"x": "soon"}', '{"x": null}'])
def test_action_points_of_another_form_are_an_error_that_names_the_file(tmp_path: Path, points: str) -> None:
    with Recorder(tmp_path / "a.mcap", person="1", source="test", action_points_ns=points):
        pass
    with pytest.raises(RecordingError, match=r"a\.mcap: the metadata field action_points_ns is not a JSON object"):
        _ = Recording(tmp_path / "a.mcap").action_points_ns
