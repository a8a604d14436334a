"""What may come over a wire: anything msgpack can hold, and messages of ours with something wrong in them."""

import copy
import math
from typing import Any

import msgpack
from hypothesis import strategies as st

from actum import codec
from actum.messages import Message

ABSURD = (
    math.nan, math.inf, -math.inf, 1e308, 5e-324, 2.0**31, -(2.0**31), -1, 0, 2**31, -(2**31), 2**40, 2**62 - 1, 2**62,
    2**64 - 1, "", "x" * 201, "é" * 1001, b"\xff\xd8", None, True, [], {}, [[]], [None] * 15, [[math.nan] * 3] * 15,
    [[2.0**31] * 3] * 15, [0.0] * 16, [1e308] * 16, [5e-324] * 16, [1.0] * 9, list(range(70)),
)  # fmt: skip
scalars = (
    st.none()
    | st.booleans()
    | st.integers(-(2**63), 2**64 - 1)
    | st.floats()
    | st.text(max_size=20)
    | st.binary(max_size=20)
)
values = st.sampled_from(ABSURD) | st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4)
)


def fields_of(message: Message) -> dict[str, Any]:
    """A message as a plain map, with nothing in common with it."""
    return copy.deepcopy(message.model_dump())


def one_of(messages: list[Message]) -> st.SearchStrategy[Message]:
    """One of the messages; unlike `sampled_from`, this strategy does not print them all."""
    return st.integers(0, len(messages) - 1).map(lambda i: messages[i])


@st.composite
def spoiled(draw: st.DrawFn, messages: st.SearchStrategy[Message]) -> codec.Frame:
    """A message with one to three of its values, at any depth, replaced, removed or added."""
    frame = codec.encode(draw(messages))
    fields = msgpack.unpackb(frame.payload)
    for _ in range(draw(st.integers(1, 3))):
        _spoil(draw, fields)
    return codec.Frame(frame.key, msgpack.packb(fields), frame.encoding, frame.attachment)


def _spoil(draw: st.DrawFn, fields: dict[str, Any]) -> None:
    container, place = _place(draw, fields)
    change = draw(st.sampled_from(("replace", "replace", "replace", "remove", "add")))
    if change == "remove":
        del container[place]
    elif change == "replace":
        container[place] = copy.deepcopy(draw(values))
    elif isinstance(container, dict):
        container[draw(st.text(max_size=8))] = copy.deepcopy(draw(values))
    else:
        container.insert(place, copy.deepcopy(draw(values)))


def _place(draw: st.DrawFn, fields: dict[str, Any]) -> tuple[Any, Any]:
    """Walk down from the map's top and stop anywhere."""
    container: Any = fields
    while True:
        keys = list(container) if isinstance(container, dict) else range(len(container))
        place = draw(st.sampled_from(keys)) if keys else None
        if place is None:
            return {"": None}, ""
        inner = container[place]
        if not (isinstance(inner, dict | list) and inner and draw(st.booleans())):
            return container, place
        container = inner
