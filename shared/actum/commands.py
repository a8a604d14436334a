"""Commands: what a service does when asked by a Zenoh query, beside the messages that it handles."""

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

import msgpack
from pydantic import BaseModel, ConfigDict, ValidationError
from pydantic_core import ErrorDetails

from actum.codec import MOST_VALUES, UNPACK_ERRORS, check_count, encodable, unpack, with_different_names

Q = TypeVar("Q", bound="Request")
A = TypeVar("A", bound=BaseModel)
JSON = "application/json"
"""Encoding of requests and replies unless the asker uses MessagePack."""
MSGPACK = "application/msgpack"
"""The other encoding: it holds bytes as they are."""
MAX_REQUEST_BYTES = 8_000_000
"""Largest request (bytes): a piece of an uploaded video, as base64, and room to spare."""
INTEGERS = range(-(2**63), 2**64)
"""The integers that MessagePack can hold."""
MOST_LEVELS = 32
"""How deeply the values of a request may be nested: ours are four deep."""
MOST_PROBLEMS = 5
"""How many of a request's wrong fields a refusal names."""
BEFORE_VALUES = (b"[", b"{", b",")
"""What stands before values in JSON, and now and then within one."""


class Refusal(ValueError):  # noqa: N818 - it is an answer, not a fault
    """A command that is not carried out; the text says why and what to do."""

    def __init__(self, text: str) -> None:
        super().__init__(encodable(text))


class Request(BaseModel):
    """The fields of a command; unknown ones are refused, since a misspelt option would be silently ignored."""

    model_config = ConfigDict(extra="forbid", allow_inf_nan=False)


class NoFields(Request):
    """A command without fields."""


@dataclass(frozen=True)
class Command(Generic[Q, A]):
    """A command that a service offers.

    Attributes:
        name: the last chunk of its key.
        request: its fields.
        reply: what is answered.
        handler: does it; quickly, since the service handles no message meanwhile. Its docstring's first line describes
            the command. It raises `Refusal` where the command cannot be carried out.
    """

    name: str
    request: type[Q]
    reply: type[A]
    handler: Callable[[Q], A]

    @property
    def description(self) -> str:
        """What it does, in a line."""
        return (self.handler.__doc__ or "").strip().partition("\n")[0]

    def obey(self, fields: dict[str, Any]) -> dict[str, Any]:
        """Carry the command out and return the reply's fields, plain values and bytes.

        Raises:
            Refusal: the fields are wrong or hold what cannot be encoded, or the handler refuses.
        """
        _check_encodable(fields)
        try:
            request = self.request.model_validate(fields)
        except ValidationError as error:
            raise Refusal(problems(error)) from None
        return self.handler(request).model_dump()


class CommandDescription(BaseModel):
    """A command in the list of a service's commands."""

    name: str
    """The last chunk of its key."""
    description: str
    """What it does, in a line."""
    request: dict[str, Any]
    """JSON Schema of its fields."""
    reply: dict[str, Any]
    """JSON Schema of the answer."""


class Commands(BaseModel):
    """All commands of a service."""

    commands: list[CommandDescription]
    """In the order of their names."""


@runtime_checkable
class Commanded(Protocol):
    """A node or source that offers commands."""

    @property
    def commands(self) -> Sequence[Command[Any, Any]]:
        """The commands, with different names."""
        ...


def described(commands: Sequence[Command[Any, Any]]) -> Commands:
    """Return the list of commands that a service answers with when it is asked for none of them."""
    return Commands(
        commands=[
            CommandDescription(
                name=each.name,
                description=each.description,
                request=each.request.model_json_schema(),
                reply=each.reply.model_json_schema(),
            )
            for each in sorted(commands, key=lambda each: each.name)
        ]
    )


def unpacked(payload: bytes, encoding: str) -> dict[str, Any]:
    """Decode the fields of a request or a reply; without payload there are none.

    Raises:
        Refusal: it is too large, or no JSON object or MessagePack map.
    """
    if len(payload) > MAX_REQUEST_BYTES:
        raise Refusal(
            f"the request has {len(payload)} bytes; at most {MAX_REQUEST_BYTES} bytes are allowed: send a smaller "
            "request"
        )
    if not payload:
        return {}
    try:
        fields = unpack(payload) if encoding.startswith(MSGPACK) else _from_json(payload)
    except UNPACK_ERRORS as error:
        raise Refusal(
            f"the request cannot be decoded ({error}): send a JSON object, or a MessagePack map (encoding "
            f"{MSGPACK}). Either can have at most {MOST_VALUES} values, and each field name once only"
        ) from None
    if not isinstance(fields, dict) or not all(isinstance(name, str) for name in fields):
        raise Refusal(
            f"the request decodes to a Python {type(fields).__name__}: send a JSON object, or a MessagePack map whose "
            "keys are text"
        )
    return fields


def _from_json(payload: bytes) -> Any:
    """Parse JSON; one of many values is refused, for each takes many times its bytes once parsed."""
    check_count(sum(map(payload.count, BEFORE_VALUES)))
    return json.loads(payload, object_pairs_hook=with_different_names)


def packed(fields: Mapping[str, Any], encoding: str) -> bytes:
    """Encode fields as MessagePack where that is the encoding, and as JSON elsewhere.

    Raises:
        Refusal: they hold what the encoding has no form for, such as a number of 70 bits, or in JSON NaN.
    """
    try:
        if encoding.startswith(MSGPACK):
            return bytes(msgpack.packb(fields, use_bin_type=True))
        return json.dumps(fields, ensure_ascii=False, allow_nan=False).encode()
    except (ValueError, TypeError, OverflowError, RecursionError) as error:
        raise Refusal(
            f"the value of a field cannot be encoded as {encoding} ({error}): use text, finite numbers of at most 64 "
            "bits, lists and maps"
        ) from None


def _check_encodable(fields: dict[str, Any]) -> None:
    """Raise a refusal of what one of the encodings cannot hold: a reply or an error text may repeat it."""
    values: list[Any] = [fields]
    for _ in range(MOST_LEVELS):
        values = [inner for value in values for inner in _inner(value)]
        if not values:
            return
    raise Refusal(f"the request is nested too deeply: use at most {MOST_LEVELS} levels")


def _inner(value: Any) -> Iterator[Any]:
    """Yield what a container holds, names included; raise a refusal of a single value that cannot be encoded."""
    match value:
        case dict():
            for name, inner in value.items():
                if not isinstance(name, str):
                    raise Refusal(f"the request has a field named {name!r}: field names have to be text")
                yield from (name, inner)
        case list():
            yield from value
        case str() if encodable(value) != value:
            raise Refusal("a text in the request is not valid Unicode (half of a surrogate pair): send valid UTF-8")
        case float() if not math.isfinite(value):
            raise Refusal(f"the request contains the number {value}: send finite numbers")
        case int() if value not in INTEGERS:
            raise Refusal("the request contains an integer of more than 64 bits: send a smaller integer")
        case None | str() | float() | int() | bytes():
            return
        case _:
            raise Refusal(
                f"the request contains a value of the Python type {type(value).__name__}: use only JSON types and bytes"
            )


def problems(error: ValidationError) -> str:
    """Say in words what is wrong with fields, naming at most `MOST_PROBLEMS` of them."""
    found = error.errors(include_url=False, include_input=False)
    named = [_sentence(each) for each in found[:MOST_PROBLEMS]]
    return "; ".join(named + [f"and {len(found) - len(named)} more"] * (len(found) > len(named)))


def _sentence(problem: ErrorDetails) -> str:
    """Say what is wrong with one field: in pydantic's words about it, or in those of our own check, which name it."""
    place = ".".join(map(str, problem["loc"])) or "the request"
    match problem["type"]:
        case "missing":
            return f"{place} is missing"
        case "extra_forbidden":
            return f"there is no field {place}"
        case "value_error":
            return str(problem["ctx"]["error"])
    subject, should, rest = problem["msg"].partition(" should ")
    return f"{place} should {rest}" if should else f"{place}: {subject}"
