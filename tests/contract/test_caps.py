"""What there can be too much of: each service keeps so much and no more, and counts what it lets go."""

import time
import tracemalloc
from collections import Counter
from collections.abc import Iterator

import pytest

from actum import keys
from actum.commands import MAX_REQUEST_BYTES, MSGPACK, Refusal, unpacked
from actum.limits import MOST_FRAMES, MOST_OPEN_SEGMENTS, MOST_STREAMS
from actum.messages import MOST_AGENTS, MOST_OBJECTS, Action, Agent, Message, Objects, Posture, Segment, Skeleton
from actum.node import MOST_KEYS, SECOND_NS, Node, Numbering, Tick
from node_cases import CLASSIFIER, FUSION, NOON_NS, PREPROCESSOR, TRACKER, Case, photograph
from wire import Wire

RING_BYTES = 64_000_000
STARTS = 3000


def first(case: Case, kind: type[Message]) -> Message:
    return next(message for message in case.messages() if isinstance(message, kind))


def changed(message: Message, stamp_ns: int, **fields: object) -> Message:
    return message.model_copy(update={"stamp_ns": stamp_ns, "seq": None, **fields})


def start(number: int, stamp_ns: int = NOON_NS) -> Segment:
    return Segment(stamp_ns=stamp_ns, sensor="kinect0", kind="start", segment_id=f"flood-{number}")


@pytest.fixture
def traced() -> Iterator[None]:
    tracemalloc.start()
    yield
    tracemalloc.stop()


def handled(node: Node, messages: Iterator[Message]) -> list[Message]:
    return [answer for message in messages for answer in node.handle(message)]


def test_a_full_ring_of_every_topic_is_bounded_in_bytes() -> None:
    assert all(topic.ring * topic.max_bytes <= RING_BYTES for topic in keys.TOPICS)


def test_a_chunk_of_a_key_is_no_longer_than_a_name() -> None:
    assert keys.chunk("k" * 64)
    with pytest.raises(keys.InvalidKeyError, match="use 1 to 64"):
        keys.chunk("k" * 65)


def test_numbers_are_kept_of_so_many_keys() -> None:
    numbering = Numbering()
    posture = first(CLASSIFIER, Posture).model_copy(update={"seq": None})
    for agent in range(MOST_KEYS + 1):
        assert numbering.numbered(posture.model_copy(update={"agent": agent})).seq == 0
    assert numbering.numbered(posture.model_copy(update={"agent": MOST_KEYS})).seq == 1
    assert numbering.numbered(posture.model_copy(update={"agent": 0})).seq == 0


@pytest.mark.usefixtures("traced")
@pytest.mark.parametrize(
    ("payload", "encoding"),
    [
        (b"\x81\xa1x\xdd" + (MAX_REQUEST_BYTES - 8).to_bytes(4, "big") + b"\x80" * (MAX_REQUEST_BYTES - 8), MSGPACK),
        (b'{"x": [' + b"[]," * (MAX_REQUEST_BYTES // 4) + b"[]]}", "application/json"),
    ],
    ids=["MessagePack", "JSON"],
)
def test_a_request_that_unpacks_to_many_times_its_size_is_refused(payload: bytes, encoding: str) -> None:
    with pytest.raises(Refusal, match="cannot be decoded"):
        unpacked(payload, encoding)
    assert tracemalloc.get_traced_memory()[1] < 100_000_000


@pytest.mark.usefixtures("traced")
def test_thousands_of_starts_cost_little_and_each_is_answered() -> None:
    node = CLASSIFIER.build()
    begun, began_s = tracemalloc.get_traced_memory()[0], time.process_time()
    answered = Counter((a.segment_id, a.reason) for i in range(STARTS) for a in node.handle(start(i)))  # type: ignore[attr-defined]
    assert time.process_time() - began_s < 30
    assert tracemalloc.get_traced_memory()[0] - begun < 1000 * STARTS
    reason, over = "too many open segments: 32 at the most", STARTS - MOST_OPEN_SEGMENTS
    assert answered == {(f"flood-{i}", reason): 1 for i in range(MOST_OPEN_SEGMENTS, STARTS)}
    assert node.counters.rejects == {"too_many_segments": over, "rejected_segment": over}
    later = [answer for i in range(70) for answer in node.handle(Tick(i * SECOND_NS))]
    assert {a.segment_id for a in later} == {f"flood-{i}" for i in range(MOST_OPEN_SEGMENTS)}  # type: ignore[attr-defined]


def test_what_is_open_is_answered_as_if_there_were_no_flood() -> None:
    flooded, alone = Wire(CLASSIFIER.build()), Wire(CLASSIFIER.build())
    messages = CLASSIFIER.messages()
    at = next(i for i, message in enumerate(messages) if isinstance(message, Segment)) + 1
    never = [start(i, NOON_NS) for i in range(2 * MOST_OPEN_SEGMENTS)]
    disturbed = flooded.send(*messages[:at], *never, *messages[at:])

    def final(answers: list[Message]) -> list[Message]:
        return [a for a in answers if isinstance(a, Action) and a.final and a.segment_id == "task"]

    assert [*final(disturbed)] == [*final(alone.send(*messages))] != []


@pytest.mark.thorough
@pytest.mark.usefixtures("traced")
@pytest.mark.parametrize(("case", "kind"), [(CLASSIFIER, Posture), (FUSION, Posture), (FUSION, Objects)], ids=repr)
def test_frames_a_microsecond_apart_are_let_go_and_counted(
    case: Case, kind: type[Message], monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("som_classifier.streams.MOST_FRAMES", "action_fusion.intake.buffers.MOST_FRAMES"):
        monkeypatch.setattr(module, MOST_FRAMES // 60)
    monkeypatch.setattr("action_fusion.node.MOST_SIGHTINGS", MOST_FRAMES // 60)
    node, sample = case.build(), first(case, kind)
    handled(node, (changed(sample, NOON_NS + i * 1000) for i in range(1000)))
    full = tracemalloc.get_traced_memory()[0]
    handled(node, (changed(sample, NOON_NS + i * 1000) for i in range(1000, 3000)))
    assert tracemalloc.get_traced_memory()[0] - full < 200_000
    assert node.counters.rejects == {"too_many_frames": 2000}


@pytest.mark.parametrize("case", [CLASSIFIER, FUSION], ids=repr)
def test_after_a_flood_nothing_more_is_let_go(case: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("som_classifier.streams.MOST_FRAMES", "action_fusion.intake.buffers.MOST_FRAMES"):
        monkeypatch.setattr(module, 50)
    node, sample = case.build(), first(case, Posture)
    handled(node, (changed(sample, NOON_NS + i * 1000) for i in range(150)))
    assert node.counters.rejects == {"too_many_frames": 100}
    handled(node, (changed(sample, NOON_NS + 1000 * SECOND_NS + i * SECOND_NS // 30) for i in range(40)))
    assert node.counters.rejects == {"too_many_frames": 100}


@pytest.mark.parametrize("case", [CLASSIFIER, FUSION], ids=repr)
def test_people_beyond_those_that_are_kept_are_counted(case: Case) -> None:
    node, sample = case.build(), first(case, Posture)
    people = (changed(sample, NOON_NS + i, agent=i, agents=[i]) for i in range(1, MOST_STREAMS + 11))
    handled(node, people)
    assert node.counters.rejects == {"too_many_people": 10}


def test_the_preprocessor_forgets_people_beyond_those_that_are_kept() -> None:
    node = PREPROCESSOR.build()
    (agent,) = first(PREPROCESSOR, Skeleton).agents  # type: ignore[attr-defined]
    for frame in range(3):
        crowd = [
            Agent(**agent.model_dump() | {"agent": 1 + frame * MOST_AGENTS + i}) for i in range(MOST_AGENTS)
        ]  # fmt: skip
        handled(node, iter([changed(first(PREPROCESSOR, Skeleton), NOON_NS + frame, agents=crowd)]))
    assert node.counters.rejects == {"too_many_people": 2 * MOST_AGENTS}


def test_objects_beyond_those_that_are_kept_are_left_out_and_counted() -> None:
    node, sample = FUSION.build(), first(FUSION, Objects)
    thing = sample.objects[0]  # type: ignore[attr-defined]
    for i in range(MOST_OBJECTS + 5):
        handled(node, iter([changed(sample, NOON_NS + i, objects=[thing.model_copy(update={"id": i})])]))
    assert node.counters.rejects == {"too_many_objects": 5}


def test_actions_beyond_those_that_wait_are_answered_at_once() -> None:
    node, sample = FUSION.build(), first(FUSION, Action)
    waiting = [changed(sample, NOON_NS, segment_id=f"a{i}", end_ns=NOON_NS + 10**12) for i in range(70)]
    events = handled(node, iter(waiting))
    assert [event.segment_id for event in events] == [f"a{i}" for i in range(6)]  # type: ignore[attr-defined]
    assert node.counters.rejects == {"too_many_actions": 6}


def scans(count: int, side: int = 4096) -> bytes:
    """A progressive JPEG whose every scan says in thirty bytes that nothing changes in sixteen million pixels."""
    blocks = (side // 8) ** 2
    runs = "011111111111111" * (blocks // 32767 + 1)
    run = int(runs.ljust(-(-len(runs) // 8) * 8, "1"), 2).to_bytes(-(-len(runs) // 8), "big")

    def segment(marker: int, content: bytes) -> bytes:
        return bytes([0xFF, marker]) + (len(content) + 2).to_bytes(2, "big") + content

    size = side.to_bytes(2, "big") * 2
    return b"".join(
        [
            b"\xff\xd8",
            segment(0xDB, b"\0" + b"\x10" * 64),
            segment(0xC2, b"\x08" + size + b"\x01\x01\x11\x00"),
            segment(0xC4, b"\x00\x01" + bytes(15) + b"\x00"),
            segment(0xC4, b"\x10\x01" + bytes(15) + b"\xe0"),
            segment(0xDA, b"\x01\x01\x00\x00\x00\x00") + bytes(blocks // 8 + 1),
            (segment(0xDA, b"\x01\x01\x00\x01\x3f\x00") + run.replace(b"\xff", b"\xff\0")) * count,
            b"\xff\xd9",
        ]
    )


def test_a_jpeg_of_a_million_scans_is_refused_before_it_is_decoded() -> None:
    wire = Wire(TRACKER.build())
    began_s = time.process_time()
    (answer,) = wire.send(photograph(NOON_NS, data=scans(1_000_000), width=4096, height=4096))
    assert time.process_time() - began_s < 10
    assert answer.reason == "image_too_large: the JPEG has more than 64 scans: send a JPEG that is not progressive"
    assert wire.node.counters.rejects == {"image_too_large": 1}


def test_a_progressive_jpeg_is_decoded() -> None:
    wire = Wire(TRACKER.build())
    (answer,) = wire.send(photograph(NOON_NS, data=scans(10, side=112)))
    assert answer.reason is None or answer.reason.startswith("black_image")
