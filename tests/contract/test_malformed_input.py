"""Malformed input to every node: counted by kind, survived, and what comes next is answered as if it had not been."""

import math
import tracemalloc
from functools import cache
from typing import Any

import msgpack
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from actum import codec, keys
from actum.messages import Message
from actum.node import Tick
from garbage import fields_of, one_of, spoiled, values
from node_cases import CASES, NOON_NS, Case, every_node
from wire import Wire, lasting, packed, without_seq

LONG_BEFORE_NS = NOON_NS - 1_000_000_000_000

every_kind_of_input = pytest.mark.parametrize(
    ("case", "message"), [pytest.param(c, m, id=f"{c}-{m.SCHEMA}") for c in CASES for m in c.one_of_each()]
)
thorough = settings(max_examples=15, suppress_health_check=list(HealthCheck))


def answers(case: Case, wire: Wire) -> list[bytes]:
    """Let the streams begin, then do the task: its answers to the last bit."""
    warm_up, task = at_noon(case)
    wire.send(*warm_up)
    return lasting([answer for answer in wire.send(*task) if case.wanted(answer, "task")])


@cache
def at_noon(case: Case) -> tuple[list[Message], list[Message]]:
    return case.warm_up(NOON_NS, "task"), case.task(NOON_NS, "task")


@cache
def undisturbed(case: Case) -> list[bytes]:
    return answers(case, Wire(case.build()))


@every_node
def test_the_task_is_answered(case: Case) -> None:
    wire = Wire(case.build())
    assert answers(case, wire)
    assert not wire.rejects


@every_node
@thorough
@given(data=st.data())
def test_any_bytes_and_any_map_are_counted(case: Case, data: st.DataObject) -> None:
    wire = Wire(case.build())
    sample = data.draw(one_of(case.one_of_each()))
    names = st.sampled_from(list(fields_of(sample)))
    payloads = st.binary(max_size=60) | st.dictionaries(names, values, max_size=6).map(msgpack.packb)
    drawn = data.draw(st.lists(payloads, min_size=1, max_size=5))
    for payload in drawn:
        assert wire.put(keys.key_of(sample), payload) == []
    assert wire.rejects == len(drawn)
    assert answers(case, wire) == undisturbed(case)


@every_node
@settings(thorough, max_examples=30)
@given(data=st.data())
def test_spoiled_messages_and_ticks_are_survived(case: Case, data: st.DataObject) -> None:
    """Whatever was wrong with them, each stream goes on with its fourth good message at the latest."""
    wire = Wire(case.build())
    good = one_of(case.messages(LONG_BEFORE_NS, "spoiled"))
    ticks = st.builds(Tick, st.integers(0, 2**62))
    for item in data.draw(st.lists(spoiled(good) | good | ticks, max_size=8)):
        if isinstance(item, codec.Frame):
            wire.put(item.key, item.payload, item.encoding)
        elif isinstance(item, Message):
            wire.send(item)
        else:
            wire.handle(item)
    assert answers(case, wire) == undisturbed(case)


@every_kind_of_input
def test_a_required_field_that_is_absent_or_of_another_type_is_counted(case: Case, message: Message) -> None:
    """The sensor need not be said: it stands in the key."""
    wire = Wire(case.build())
    fields = fields_of(message)
    required = [n for n, field in type(message).model_fields.items() if field.is_required() and n != "sensor"]
    for name in required:
        others = {key: value for key, value in fields.items() if key != name}
        for wrong in (others, fields | {name: msgpack.ExtType(5, b"")}):
            assert wire.put(keys.key_of(message), msgpack.packb(wrong)) == []
    assert wire.node.counters.rejects == {"wrong_fields": 2 * len(required)}


@every_kind_of_input
def test_unknown_fields_are_ignored(case: Case, message: Message) -> None:
    told, plain = Wire(case.build()), Wire(case.build())
    outputs = told.put(keys.key_of(message), msgpack.packb(fields_of(message) | {"mood": [{"sunny": math.nan}]}))
    assert without_seq(outputs) == without_seq(plain.send(message))
    assert told.node.counters.rejects == plain.node.counters.rejects


@every_kind_of_input
@given(version=st.integers(2, 999_999))
def test_a_higher_version_is_named(case: Case, message: Message, version: int) -> None:
    wire = Wire(case.build())
    encoding = f"application/msgpack;{message.SCHEMA}/{version}"
    assert wire.put(keys.key_of(message), packed(message), encoding) == []
    assert wire.node.counters.rejects == {"higher_version": 1}


WRONG_PAYLOADS: dict[str, tuple[str, bytes]] = {
    "nothing": ("not_msgpack", b""),
    "no map": ("not_a_map", msgpack.packb([1, 2, 3])),
    "keys that are no strings": ("not_msgpack", msgpack.packb({1: 2})),
    "an empty map": ("wrong_fields", msgpack.packb({})),
    "an extension type": ("wrong_fields", msgpack.packb({"stamp_ns": msgpack.Timestamp(1, 2)})),
    "nested without end": ("not_msgpack", b"\x91" * 30_000),
    "an array said to hold 2³² - 1 values": ("not_msgpack", b"\x81\xa1x\xdd\xff\xff\xff\xff"),
}


@every_kind_of_input
@pytest.mark.parametrize(("kind", "payload"), WRONG_PAYLOADS.values(), ids=WRONG_PAYLOADS.keys())
def test_a_payload_that_is_no_message_is_named(case: Case, message: Message, kind: str, payload: bytes) -> None:
    wire = Wire(case.build())
    assert wire.put(keys.key_of(message), payload) == []
    assert wire.node.counters.rejects == {kind: 1}


@every_kind_of_input
def test_a_message_of_another_key_is_named(case: Case, message: Message) -> None:
    wire = Wire(case.build())
    key = keys.key_of(message)
    assert wire.put(key, msgpack.packb(fields_of(message) | {"sensor": "elsewhere"})) == []
    assert wire.put(f"{key}/more", packed(message)) == []
    assert wire.put(key, packed(message), "application/msgpack;actum.status/1") == []
    assert wire.node.counters.rejects == {"wrong_key": 1, "unknown_key": 1, "wrong_schema": 1}


ROW_BYTES = 65_538


def empty_maps(rows: int) -> bytes:
    """A map with so many rows of 65,535 empty maps: each takes one byte here, and 64 where it is unpacked."""
    row = b"\xdc\xff\xff" + b"\x80" * 65_535
    return b"\x81\xa1x\xdc" + rows.to_bytes(2, "big") + row * rows


@every_kind_of_input
def test_a_payload_that_unpacks_to_many_times_its_size_is_counted(case: Case, message: Message) -> None:
    wire = Wire(case.build())
    largest = keys.parse(keys.key_of(message)).topic.max_bytes
    tracemalloc.start()
    assert wire.put(keys.key_of(message), empty_maps(largest // ROW_BYTES)) == []
    assert tracemalloc.get_traced_memory()[1] < 200_000_000
    tracemalloc.stop()
    assert wire.rejects == 1


@pytest.fixture(scope="module")
def hundred_megabytes() -> bytes:
    """An array of 100 million zeros, as its header and one allocation."""
    return b"\xdd" + (100_000_000).to_bytes(4, "big") + bytes(100_000_000)


@every_kind_of_input
def test_a_hundred_megabytes_are_not_even_unpacked(case: Case, message: Message, hundred_megabytes: bytes) -> None:
    wire = Wire(case.build())
    assert wire.put(keys.key_of(message), hundred_megabytes) == []
    assert wire.node.counters.rejects == {"too_large": 1}


@every_kind_of_input
def test_complaints_stay_short(case: Case, message: Message) -> None:
    """A status repeats the last one every second."""
    wire = Wire(case.build())
    fields: dict[str, Any] = fields_of(message) | {"sensor": "a" * 100_000}
    assert wire.put(keys.key_of(message), msgpack.packb(fields)) == []
    assert len(wire.node.counters.last_error or "") <= 500
