import msgpack
import pytest

from actum import codec, schemas
from actum.messages import MESSAGES, Action, Segment, Skeleton
from people import STANDING, skeleton

KEY = "actum/kinect0/skeleton"


def test_a_message_survives_the_wire() -> None:
    message = skeleton(7, STANDING, seq=3)
    frame = codec.encode(message)
    assert frame.key == KEY
    assert frame.encoding == "application/msgpack;actum.skeleton/1"
    assert codec.decode(frame.key, frame.payload, frame.encoding) == message
    assert msgpack.unpackb(frame.attachment) == [1, 3, 7]


def test_what_is_packed_is_what_the_models_dump_is() -> None:
    """The parts of a message, too, however deep; a message that cannot be packed leaves nothing for the next one."""
    frame = skeleton(1, STANDING, STANDING)
    action = Action.model_construct(sensor="kinect0", agent=1, stamp_ns=1, seq=None, maps={"postures": object()})
    for _ in range(2):
        with pytest.raises(TypeError, match="object"):
            codec.encode(action)
        assert codec.encode(frame, seq=7).payload == msgpack.packb(frame.model_dump() | {"seq": 7})


def test_a_field_that_is_left_out_of_an_unchecked_message_is_found_when_it_is_packed() -> None:
    with pytest.raises(TypeError):
        codec.encode(Segment.of_checked(sensor="kinect0", kind="start"))


def test_a_mark_needs_only_kind_and_segment_id() -> None:
    mark = codec.decode("actum/kinect0/segment", msgpack.packb({"kind": "start", "segment_id": "a"}))
    assert mark == Segment(sensor="kinect0", kind="start", segment_id="a")


def test_a_missing_joint_is_null() -> None:
    joints = [None, *STANDING[1:].tolist()]
    fields = {"stamp_ns": 1, "agents": [{"agent": 1, "joints": joints, "confidence": [1.0] * 15}]}
    decoded = codec.decode(KEY, msgpack.packb(fields))
    assert isinstance(decoded, Skeleton)
    assert decoded.agents[0].joints[0] is None


def test_a_plain_clients_encoding_means_version_one() -> None:
    payload = msgpack.packb({"stamp_ns": 1, "agents": []})
    for encoding in ("", "zenoh/bytes", "application/octet-stream"):
        assert codec.decode(KEY, payload, encoding).stamp_ns == 1


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.SCHEMA)
def test_the_committed_schema_is_the_generated_one(message: type) -> None:
    name = schemas.file_name(message)
    assert schemas.committed(name) == schemas.generated()[name], "run python -m actum.schemas"


def test_who_put_a_message_stands_in_its_attachment_where_that_is_told() -> None:
    frame = codec.encode(skeleton(7, STANDING, seq=3), "a1b2")
    assert msgpack.unpackb(frame.attachment) == [1, 3, 7, "a1b2"]
    assert codec.origin_of(frame.attachment) == "a1b2"


@pytest.mark.parametrize(
    "attachment", [b"", b"\xc1", b"\x91" * 5000, *map(msgpack.packb, (7, [1, 3, 7], [1, 3, 7, 9]))]
)
def test_who_put_a_message_is_not_known_where_the_attachment_does_not_say_so(attachment: bytes) -> None:
    assert codec.origin_of(attachment) == ""
