"""Encodes and decodes messages: a msgpack map, an encoding that names the schema, a small attachment."""

import re
import threading
from functools import cache, lru_cache
from typing import Any, NamedTuple

import msgpack
from pydantic import BaseModel, ValidationError

from actum import keys
from actum.messages import Image, Message

ENCODING = re.compile(r"application/msgpack;(?P<schema>[a-z0-9_.]+)/(?P<version>\d{1,6})")
"""The Zenoh encoding of a message: the schema's name and version."""
UNPACK_ERRORS = (ValueError, TypeError, RecursionError, msgpack.exceptions.UnpackException)
"""What msgpack raises on bytes that it cannot unpack, for one because they are nested too deeply."""
MOST_VALUES = 100_000
"""Most values in all maps and lists of a message: one takes a byte on the wire, up to a hundred once unpacked."""
LONGEST_ORIGIN = 32
"""Characters of an origin: those of the id of a Zenoh session."""
KNOWN_ENCODINGS = 256
"""Entries in the cache of accepted encodings: a few per schema are in use."""


class DecodeError(ValueError):
    """A payload that is no valid message for its key; `kind` is the name it is counted under."""

    def __init__(self, kind: str, detail: str) -> None:
        super().__init__(f"{kind}: {detail}")
        self.kind = kind


class Frame(NamedTuple):
    """An encoded message, with the key to put it on."""

    key: str
    payload: bytes
    encoding: str
    attachment: bytes


def encodable(text: str) -> str:
    """Return a text with escapes for what UTF-8 cannot hold, such as the halves of pairs in names of files."""
    return text.encode("utf-8", "backslashreplace").decode()


def schema_name(message: Message | type[Message]) -> str:
    """Name a message's schema with its version, e.g. `actum.skeleton/1`."""
    return f"{message.SCHEMA}/{message.VERSION}"


def encode(message: Message, origin: str = "", seq: int | None = None) -> Frame:
    """Pack a message, under a number where one is given.

    The attachment repeats `[version, seq, stamp_ns]` and adds who puts it, if that is given.
    """
    number = message.seq if seq is None else seq
    fields = vars(message) | {"seq": number}
    # a packer keeps the room that its largest message took: an image gets one of its own
    payload = _packing().pack(fields) if isinstance(message, Image) else _PACKING.packer.pack(fields)
    attachment = _PACKING.packer.pack([message.VERSION, number, message.stamp_ns, *filter(None, [origin])])
    return Frame(keys.key_of(message), payload, _encoding_of(type(message)), attachment)


@cache
def _encoding_of(kind: type[Message]) -> str:
    return f"application/msgpack;{schema_name(kind)}"


def _fields_of(part: Any) -> dict[str, Any]:
    """Return the fields of a part of a message; `model_dump` would copy the whole message first.

    Raises:
        OverflowError: it is a whole number of more than 64 bits.
        TypeError: it is neither a number, text or container nor a part of a message.
    """
    if isinstance(part, BaseModel):
        return vars(part)
    if isinstance(part, int):
        raise OverflowError(f"the integer {part} in a message does not fit into 64 bits: use a smaller integer")
    raise TypeError(
        f"a message contains a value of the Python type {type(part).__name__}, which cannot be encoded: use numbers, "
        "text, bytes, lists and maps"
    )


def _packing() -> msgpack.Packer:
    return msgpack.Packer(default=_fields_of, use_bin_type=True)


class _Packing(threading.local):
    """Each thread's packer: to make one costs as much as to pack a small message."""

    def __init__(self) -> None:
        self.packer = _packing()


_PACKING = _Packing()


def origin_of(attachment: bytes) -> str:
    """Return who put a message, as its attachment says; "" where it does not say so, or is none of ours."""
    try:
        match msgpack.unpackb(attachment):
            case [_, _, _, str(origin), *_]:
                return origin[:LONGEST_ORIGIN]
    except UNPACK_ERRORS:
        pass
    return ""


def decode(key: str, payload: bytes, encoding: str = "") -> Message:
    """Decode a payload received on a key. Unknown fields are ignored; a missing `sensor` is taken from the key.

    Raises:
        DecodeError: of kind `unknown_key`, `too_large`, `wrong_schema`, `higher_version`, `not_msgpack`,
            `not_a_map`, `wrong_fields` or `wrong_key`.
    """
    try:
        address = keys.parse(key)
    except keys.InvalidKeyError as error:
        raise DecodeError("unknown_key", str(error)) from None
    topic = address.topic
    if len(payload) > topic.max_bytes:
        raise DecodeError(
            "too_large",
            f"the message on {key} has {len(payload)} bytes; at most {topic.max_bytes} bytes are allowed: send a "
            "smaller message",
        )
    _check_encoding(encoding, topic.message)
    return _validated(key, address, _unpack(key, payload))


@lru_cache(KNOWN_ENCODINGS)
def _check_encoding(encoding: str, expected: type[Message]) -> None:
    """Raise an error for another schema or a newer version. An encoding that is not ours passes as version 1."""
    match = ENCODING.fullmatch(encoding)
    if match is None:
        return
    if match["schema"] != expected.SCHEMA:
        raise DecodeError(
            "wrong_schema",
            f"the message's encoding names the schema {match['schema']}, but this key requires {expected.SCHEMA}: "
            f"publish messages of the schema {expected.SCHEMA} on this key",
        )
    if int(match["version"]) > expected.VERSION:
        raise DecodeError(
            "higher_version",
            f"the message ({encoding}) has a newer version than {expected.VERSION}, the newest version that this "
            "program can read: update actum",
        )


def _unpack(key: str, payload: bytes) -> dict[str, Any]:
    try:
        # the values of a short payload take little memory, however many there are
        fields = msgpack.unpackb(payload) if len(payload) <= keys.MOST_BYTES else unpack(payload)
    except UNPACK_ERRORS as error:
        raise DecodeError(
            "not_msgpack",
            f"the message on {key} cannot be decoded as MessagePack ({type(error).__name__}: {error}): send one "
            "MessagePack map of field names to values",
        ) from None
    if not isinstance(fields, dict):
        raise DecodeError(
            "not_a_map",
            f"the message on {key} is not a MessagePack map, but decodes to a Python {type(fields).__name__}: send one "
            "map of field names to values",
        )
    return fields


def with_different_names(pairs: list[tuple[Any, Any]]) -> dict[Any, Any]:
    """Build a map of its entries.

    Raises:
        ValueError: a name comes twice, so that nobody knows which value is meant.
    """
    made = dict(pairs)
    if len(made) < len(pairs):
        raise ValueError(
            "a message contains two fields of the same name; each field of a map or JSON object needs a name of its own"
        )
    return made


def check_count(values: int) -> None:
    """Check that a message has no more than `MOST_VALUES` values.

    Raises:
        ValueError: it has more.
    """
    if values > MOST_VALUES:
        raise ValueError(
            f"a message contains more than {MOST_VALUES} values (the values in lists and maps count, too); send fewer "
            "values"
        )


def unpack(payload: bytes) -> Any:
    """Unpack msgpack, and refuse a payload that has too many values, or a name twice.

    One byte can become an empty list of 56 bytes in memory. Only images are large, and their pixels are one value.

    Raises:
        UNPACK_ERRORS: it is no msgpack, is nested too deeply, has too many values, or a name twice.
    """
    values = 0

    def counted(container: list[Any]) -> list[Any]:
        nonlocal values
        values += 1 + len(container)
        check_count(values)
        return container

    return msgpack.unpackb(
        payload,
        raw=False,
        strict_map_key=True,
        max_array_len=MOST_VALUES,
        max_map_len=MOST_VALUES,
        list_hook=counted,
        object_pairs_hook=lambda pairs: with_different_names(counted(pairs)),
    )


def _validated(key: str, address: keys.Address, fields: dict[str, Any]) -> Message:
    fields.setdefault("sensor", address.sensor)
    try:
        message: Message = address.topic.message.__pydantic_validator__.validate_python(fields)
        actual = keys.key_of(message)
    except (ValidationError, keys.InvalidKeyError) as error:
        raise DecodeError("wrong_fields", f"{key}: {_first_line(error)}") from None
    if actual != key:
        raise DecodeError(
            "wrong_key",
            f"the message arrived on the key {key}, but its fields sensor, agent and service belong to the key "
            f"{actual}: correct these fields, or publish the message on that other key",
        )
    return message


def _first_line(error: ValueError) -> str:
    if not isinstance(error, ValidationError):
        return str(error)
    first = error.errors(include_input=False, include_url=False)[0]
    field = ".".join(str(part) for part in first["loc"])
    return f"{field}: {first['msg']} ({error.error_count()} problems)"
