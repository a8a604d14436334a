"""The one table of topics, and the only code that builds or parses a Zenoh key."""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from actum import messages as m

BASE = "actum"
"""The first chunk of every key."""
CHUNK = re.compile(r"[a-z0-9_-]+")
"""What one chunk of a key may hold: what every Zenoh key expression, file name and label can."""

MEGABYTE = 1_000_000
"""Bytes."""
CACHED_KEYS = 1024
"""Keys remembered with what they mean."""


class InvalidKeyError(ValueError):
    """A key or one of its chunks is not of the table's form."""


@dataclass(frozen=True)
class Topic:
    """One row of the table: what a key carries and how it is sent.

    `leaf` is the key below `actum/<sensor>/`, with `{}` for the agent or service. `ring` is the depth of a
    subscriber's ring. `cached` topics go through an advanced publisher, so that late or interrupted
    subscribers recover them.
    """

    leaf: str
    message: type[m.Message]
    congestion: Literal["drop", "block"] = "drop"
    priority: Literal["interactive_high", "data_high", "data_low", "background"] = "data_high"
    ring: int = 256
    cached: bool = False
    max_bytes: int = MEGABYTE


SKELETON = Topic("skeleton", m.Skeleton)
"""Joints in the camera frame, of everybody in view."""
COLOR = Topic("image/color", m.Image, priority="data_low", ring=1, max_bytes=64 * MEGABYTE)
"""Colour images: only the newest counts, so they may be dropped."""
DEPTH = Topic("image/depth", m.Image, priority="data_low", ring=1, max_bytes=64 * MEGABYTE)
"""Depth images, likewise."""
POSTURE = Topic("posture/{}", m.Posture)
"""Joints in the frame of one person."""
OBJECTS = Topic("objects", m.Objects)
"""Every object's pose."""
SEGMENT = Topic("segment", m.Segment, congestion="block", priority="interactive_high", cached=True)
"""Start and end marks: none may be lost."""
ACTION = Topic("action/{}", m.Action, max_bytes=4 * MEGABYTE)
"""The classifier's estimates; with maps and traces they are large."""
EVENT = Topic("event/{}", m.Event, cached=True)
"""Verb, object and result, one for each segment."""
STATUS = Topic("status/{}", m.Status, priority="background")
"""A service's health, once a second."""
INFO = Topic("info/{}", m.Info)
"""What a service is; a queryable."""
TRUTH = Topic("truth", m.Truth, cached=True)
"""What the simulated scene really did."""

TOPICS: tuple[Topic, ...] = (
    SKELETON,
    COLOR,
    DEPTH,
    POSTURE,
    OBJECTS,
    SEGMENT,
    ACTION,
    EVENT,
    STATUS,
    INFO,
    TRUTH,
)
_BY_HEAD = {topic.leaf.removesuffix("/{}"): topic for topic in TOPICS}
"""Topics by the part of the key that names them."""


@dataclass(frozen=True)
class Address:
    """A parsed key: its topic, the sensor, and the agent or service chunk where the topic has one."""

    topic: Topic
    sensor: str
    name: str | None


def chunk(text: str) -> str:
    """Return `text` if it may stand as a key chunk.

    Raises:
        InvalidKeyError: it holds anything but a-z, 0-9, `_` and `-`.
    """
    if not CHUNK.fullmatch(text):
        raise InvalidKeyError(f"{text!r} cannot stand in a key: use a-z, 0-9, '_' and '-'")
    return text


@lru_cache(CACHED_KEYS)
def key(topic: Topic, sensor: str, name: str | int | None = None) -> str:
    """Build the concrete key of a topic, e.g. `actum/kinect0/posture/1`.

    Raises:
        InvalidKeyError: the name is missing or is not for this topic, or a chunk cannot stand in a key.
    """
    if ("{}" in topic.leaf) != (name is not None):
        raise InvalidKeyError(f"{topic.leaf!r} does not go with the name {name!r}")
    leaf = topic.leaf if name is None else topic.leaf.format(chunk(str(name)))
    return f"{BASE}/{chunk(sensor)}/{leaf}"


def pattern(topic: Topic, sensor: str = "*") -> str:
    """Build the key expression that matches every key of a topic, of one sensor or of any."""
    return f"{BASE}/{sensor if sensor == '*' else chunk(sensor)}/{topic.leaf.format('*')}"


def everything(sensor: str = "*") -> str:
    """Build the key expression that matches all that a sensor's services put."""
    return f"{BASE}/{sensor}/**"


def alive(sensor: str, service: str, instance: str) -> str:
    """Build the key of an instance's liveliness token."""
    return f"{BASE}/{chunk(sensor)}/alive/{chunk(service)}/{chunk(instance)}"


@dataclass(frozen=True)
class Claim:
    """Who is a service of a sensor (`alive`), or is to be it: when nobody is, or in the other's place."""

    role: Literal["alive", "candidate", "successor"]
    instance: str
    session: str = ""


def wish(claim: Claim, sensor: str, service: str) -> str:
    """Build the key of the token of one that is to be a service."""
    return f"{BASE}/{chunk(sensor)}/{claim.role}/{chunk(service)}/{chunk(claim.instance)}/{chunk(claim.session)}"


def claims(sensor: str, service: str) -> str:
    """Build the key expression that matches the tokens of all that are a service or are to be."""
    return f"{BASE}/{chunk(sensor)}/*/{chunk(service)}/**"


def claim_of(text: str) -> Claim | None:
    """Take the key of such a token apart; None where it is none."""
    match text.split("/"):
        case [_, _, "alive", _, instance]:
            return Claim("alive", instance)
        case [_, _, ("candidate" | "successor") as role, _, instance, session]:
            return Claim(role, instance, session)
        case _:
            return None


@lru_cache(CACHED_KEYS)
def parse(text: str) -> Address:
    """Take a concrete key apart.

    Raises:
        InvalidKeyError: it is none of the table's keys.
    """
    base, _, rest = text.partition("/")
    sensor, _, leaf = rest.partition("/")
    if base == BASE and CHUNK.fullmatch(sensor):
        if leaf in _BY_HEAD and "{}" not in _BY_HEAD[leaf].leaf:
            return Address(_BY_HEAD[leaf], sensor, None)
        head, _, name = leaf.rpartition("/")
        topic = _BY_HEAD.get(head)
        if topic is not None and "{}" in topic.leaf and CHUNK.fullmatch(name):
            return Address(topic, sensor, name)
    raise InvalidKeyError(f"{text!r} is no actum key")


def address_of(message: m.Message) -> Address:
    """Tell where a message belongs."""
    sensor = message.sensor
    match message:
        case m.Image():
            return Address(DEPTH if message.format == "depth16_mm" else COLOR, sensor, None)
        case m.Posture() | m.Action() | m.Event():
            return Address(_BY_HEAD[message.SCHEMA.removeprefix("actum.")], sensor, str(message.agent))
        case m.Status() | m.Info():
            return Address(_BY_HEAD[message.SCHEMA.removeprefix("actum.")], sensor, message.service)
        case _:
            return Address(_BY_HEAD[message.SCHEMA.removeprefix("actum.")], sensor, None)


def key_of(message: m.Message) -> str:
    """Build the key a message is put on."""
    address = address_of(message)
    return key(address.topic, address.sensor, address.name)
