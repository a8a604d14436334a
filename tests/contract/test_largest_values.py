"""The largest numbers and the longest names that a message may hold: sums over them still fit, memory does too."""

from typing import Any

import msgpack
import pytest

from actum import codec, keys
from actum.messages import Message
from garbage import fields_of
from node_cases import CASES, Case, every_node
from wire import Wire

every_kind_of_input = pytest.mark.parametrize(
    ("case", "message"), [pytest.param(c, m, id=f"{c}-{m.SCHEMA}") for c in CASES for m in c.one_of_each()]
)
LONG = "n" * 2000


def accepts(message: Message, **fields: Any) -> bool:
    try:
        codec.decode(keys.key_of(message), msgpack.packb(fields_of(message) | fields))
    except codec.DecodeError:
        return False
    return True


def largest(message: Message, field: str) -> int:
    """The largest of some numbers that the field may hold."""
    return next(n for n in (2**64 - 1, 2**63 - 1, 2**62 - 1, 2**40 - 1) if accepts(message, **{field: n}))


@every_node
def test_numbers_that_jump_as_far_as_they_can_are_counted_up_without_overflow(case: Case) -> None:
    """Every second message is the last there may be, and says that as many were lost before it."""
    wire = Wire(case.build())
    for i, message in enumerate(case.messages()):
        update = {"seq": largest(message, "seq") if i % 2 else 0}
        if hasattr(message, "missed"):
            update["missed"] = largest(message, "missed")
        wire.send(message.model_copy(update=update))
    assert not wire.rejects


def texts(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Where text stands in a message, or may stand instead of nothing."""
    if isinstance(value, dict):
        return [found for key, inner in value.items() for found in texts(inner, (*path, key))]
    if isinstance(value, list):
        return [found for i, inner in enumerate(value) for found in texts(inner, (*path, i))]
    return [path] if isinstance(value, str | None) else []


@every_kind_of_input
def test_names_and_reasons_have_an_end(case: Case, message: Message) -> None:
    """They are held with every sample of a minute."""
    wire = Wire(case.build())
    places = texts(fields_of(message))
    for path in places:
        fields: Any = fields_of(message)
        inner = fields
        for step in path[:-1]:
            inner = inner[step]
        inner[path[-1]] = LONG
        assert wire.put(keys.key_of(message), msgpack.packb(fields)) == []
    assert wire.rejects == len(places) > 0


@every_kind_of_input
def test_lists_have_an_end(case: Case, message: Message) -> None:
    wire = Wire(case.build())
    lists = [name for name, value in fields_of(message).items() if isinstance(value, list) and value]
    for name in lists:
        fields = fields_of(message)
        wire.put(keys.key_of(message), msgpack.packb(fields | {name: fields[name] * 2000}))
    assert wire.rejects == len(lists)
