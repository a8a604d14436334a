"""Real messages with something wrong in them: their bytes, fields, types, sizes, nesting, versions or keys."""

import copy
import json
from collections.abc import Sequence
from random import Random
from typing import Any

import msgpack

from actum.codec import Frame
from garbage import ABSURD

TEXTS = (
    "",
    "\0",
    "\u202egnp",
    "é" * 300,
    "𝔘" * 250,
    "../../etc/passwd",
    "a\nb",
    "NaN",
    "null",
    "actum/**",
    "kitchen",
    "self",
    "\ud800",
)
NUMBERS = (0, -1, 1, 2**31, 2**53 + 1, 2**62 - 1, 2**62, 2**63 - 1, -(2**63), 2**64 - 1, 1e-308, 1e308, -0.0)
DEEPEST = 2000
MOST_COPIES = 3000
REGIONS = 64


def mutated(rng: Random, frame: Frame, others: Sequence[Frame]) -> Frame:
    """Return a frame with one to three things wrong."""
    payload, encoding, key = frame.payload, frame.encoding, frame.key
    for _ in range(rng.randint(1, 3)):
        match rng.randrange(10):
            case 0:
                encoding = _other_encoding(rng, encoding)
            case 1:
                key = _other_key(rng, key, others)
            case 2 | 3:
                payload = of_bytes(rng, payload, rng.choice(others).payload)
            case _:
                payload = _of_fields(rng, payload)
    return Frame(key, payload, encoding, frame.attachment)


def of_bytes(rng: Random, payload: bytes, other: bytes) -> bytes:
    """Return bytes with some flipped, cut out, repeated, or those of another message behind them."""
    data = bytearray(payload)
    at = rng.randrange(len(data) + 1)
    length = rng.randint(1, REGIONS)
    match rng.randrange(6):
        case 0:
            for _ in range(rng.randint(1, 8)):
                if data:
                    data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        case 1:
            del data[at:]
        case 2:
            del data[at : at + length]
        case 3:
            data[at:at] = rng.randbytes(length)
        case 4:
            data[at:at] = data[at : at + length] * rng.randint(1, 20)
        case 5:
            data[at:] = other[rng.randrange(len(other) + 1) :]
    return bytes(data)


def _of_fields(rng: Random, payload: bytes) -> bytes:
    try:
        fields = msgpack.unpackb(payload)
        spoil(rng, fields)
        return bytes(msgpack.packb(fields))
    except (ValueError, TypeError, OverflowError, msgpack.exceptions.UnpackException):
        return payload + rng.randbytes(4)


def spoil(rng: Random, fields: Any) -> None:
    """Change one value of maps and lists at any depth."""
    if not isinstance(fields, dict | list):
        return
    container, place = _place(rng, fields)
    if place is None:
        return
    match rng.randrange(8):
        case 0:
            del container[place]
        case 1 if isinstance(container, list):
            container[place:place] = [container[place]] * rng.choice((1, 2, 100, MOST_COPIES))
        case 2:
            container[place] = nested(rng.randint(1, DEEPEST) if rng.random() < 0.02 else 3)
        case 3:
            container[place] = _near(rng, container[place])
        case 4 if isinstance(container, dict):
            container[rng.choice(TEXTS)] = value(rng)
        case _:
            container[place] = value(rng)


def value(rng: Random) -> Any:
    """Return any value, mostly one that nobody expects."""
    match rng.randrange(6):
        case 0:
            return rng.choice(TEXTS)
        case 1:
            return rng.choice(NUMBERS)
        case 2:
            return rng.randbytes(rng.randrange(20))
        case 3:
            return [rng.uniform(-3, 3) for _ in range(rng.choice((3, 4, 5, 9, 15, 16)))]
        case 4:
            return rng.randint(-5, 200)
        case _:
            return copy.deepcopy(rng.choice(ABSURD))


def nested(depth: int) -> list[Any]:
    """Return a list in a list in a list."""
    inner: list[Any] = []
    for _ in range(depth):
        inner = [inner]
    return inner


def _near(rng: Random, before: Any) -> Any:
    """Return a value of the same type that is a little or a lot off."""
    if isinstance(before, bool | list):
        return rng.sample(before, len(before)) if isinstance(before, list) else not before
    if isinstance(before, int):
        return before + rng.choice((-(10**10), -1, 1, 10**7, 10**9, 10**11))
    if isinstance(before, float):
        return before * rng.choice((-1.0, 0.0, 1.001, 1e3, 1e300))
    if isinstance(before, str):
        return before + rng.choice(TEXTS)
    return of_bytes(rng, before, before) if isinstance(before, bytes) else value(rng)


def _place(rng: Random, fields: Any) -> tuple[Any, Any]:
    """Walk down from the top and stop anywhere."""
    container = fields
    while container:
        place = rng.choice(list(container)) if isinstance(container, dict) else rng.randrange(len(container))
        inner = container[place]
        if not (isinstance(inner, dict | list) and inner and rng.random() < 0.7):
            return container, place
        container = inner
    return container, None


def _other_encoding(rng: Random, encoding: str) -> str:
    schema, _, version = encoding.rpartition("/")
    return rng.choice(
        (
            f"{schema}/{int(version) + 1 if version.isdecimal() else 2}",
            f"{schema}/0",
            f"{schema}/{'9' * 40}",
            f"{schema[:-1]}/1",
            "application/json",
            "",
            "\0" * 100,
        )
    )


def _other_key(rng: Random, key: str, others: Sequence[Frame]) -> str:
    head, _, tail = key.rpartition("/")
    return rng.choice(
        (
            rng.choice(others).key,
            f"{head}/{rng.randrange(2**31)}",
            f"{head}/{rng.randrange(5)}",
            f"{key}/{tail}",
            f"{head}/{'9' * 300}",
            key.upper(),
            key.replace("kinect0", "kinect1"),
        )
    )


def request(rng: Random, names: Sequence[str]) -> bytes:
    """Return a command's fields as JSON: some of its own, some not, with any values."""
    chosen = rng.sample(names, rng.randint(0, len(names)))
    fields: dict[str, Any] = {name: value(rng) for name in chosen}
    if rng.random() < 0.3:
        fields[rng.choice(TEXTS)] = value(rng)
    packed = json.dumps(fields, default=_as_text).encode()
    return of_bytes(rng, packed, packed) if rng.random() < 0.2 else packed


def _as_text(data: Any) -> str:
    return data.decode("latin-1") if isinstance(data, bytes) else repr(data)
