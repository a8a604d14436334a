"""The one table of topics, and the only code that builds or parses a Zenoh key."""

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

from actum import messages as m

BASE = "actum"
"""The first chunk of every key."""
CHUNK = re.compile(r"[a-z0-9_-]{1,64}")
"""One chunk of a key: characters that Zenoh keys, file names and labels all allow, and few enough for a name."""

MOST_BYTES = 250_000
"""Largest payload without pixels (bytes), ten times that of a busy scene. A full ring of them takes 64 MB."""
MOST_IMAGE_BYTES = 64_000_000
"""Largest payload of an image (bytes): 16 million pixels as `bgr8`. Only one waits."""
CACHED_KEYS = 1024
"""Entries in each cache of built and of parsed keys."""


class InvalidKeyError(ValueError):
    """A key, or one of its chunks, does not fit the table of topics."""


@dataclass(frozen=True, eq=False)
class Topic:
    """One row of the table: what a key carries and how it is sent.

    `leaf` is the key below `actum/<sensor>/`, with `{}` for the agent or service. `ring` is the depth of a
    subscriber's ring, `max_bytes` the largest payload that is taken. A publisher keeps its last `cache` messages on
    each key, so that late or interrupted subscribers recover them; 0 where nobody does.
    """

    leaf: str
    message: type[m.Message]
    congestion: Literal["drop", "block"] = "drop"
    priority: Literal["interactive_high", "data_high", "data_low", "background"] = "data_high"
    ring: int = 256
    cache: int = 0
    max_bytes: int = MOST_BYTES


TEN_SECONDS = 300
"""Messages of a stream in ten seconds, at 30 a second: a link that was cut for less loses none."""
ROOM_FOR_MANY = 2048
"""Depth of a ring that takes ten seconds of several people's postures at once, as when a link is back."""

SKELETON = Topic("skeleton", m.Skeleton, ring=512, cache=TEN_SECONDS, max_bytes=MOST_BYTES // 2)
"""Joints in the camera frame, of everybody in view."""
COLOR = Topic("image/color", m.Image, priority="data_low", ring=1, max_bytes=MOST_IMAGE_BYTES)
"""Colour images: only the newest counts, so they may be dropped."""
DEPTH = Topic("image/depth", m.Image, priority="data_low", ring=1, max_bytes=MOST_IMAGE_BYTES)
"""Depth images, sent as colour images are."""
POSTURE = Topic("posture/{}", m.Posture, ring=ROOM_FOR_MANY, cache=TEN_SECONDS, max_bytes=MOST_BYTES // 8)
"""Joints of one person, in the frames of that person's body."""
OBJECTS = Topic("objects", m.Objects, ring=512, cache=TEN_SECONDS, max_bytes=MOST_BYTES // 2)
"""Every object's pose."""
SEGMENT = Topic("segment", m.Segment, congestion="block", priority="interactive_high", cache=256)
"""Start and end marks: none may be lost. Two a second for two minutes are kept."""
ACTION = Topic("action/{}", m.Action, cache=64)
"""The classifier's estimates."""
HELD_BACK = Topic("held_back/{}", m.HeldBack, cache=64)
"""What the classifier found and did not publish as an action."""
EVENT = Topic("event/{}", m.Event, cache=64)
"""Events, one for each segment: verb, object and result."""
INTENT = Topic("intent/{}", m.Intent)
"""What people are about to touch. None is kept: an older one is outdated."""
CONTINUATION = Topic("continuation/{}", m.Continuation)
"""How postures go on. None is kept, and none is put while nobody listens: an older one is outdated."""
STATUS = Topic("status/{}", m.Status, priority="background")
"""A service's health, once a second."""
INFO = Topic("info/{}", m.Info)
"""A service's description; a queryable."""
TRUTH = Topic("truth", m.Truth, cache=64)
"""The simulated scene's ground truth."""
TRAINING = Topic("training", m.Training, cache=64)
"""What the trainer does and has."""

TOPICS: tuple[Topic, ...] = (
    SKELETON,
    COLOR,
    DEPTH,
    POSTURE,
    OBJECTS,
    SEGMENT,
    ACTION,
    HELD_BACK,
    EVENT,
    INTENT,
    CONTINUATION,
    STATUS,
    INFO,
    TRUTH,
    TRAINING,
)
_BY_PREFIX = {topic.leaf.removesuffix("/{}"): topic for topic in TOPICS}
"""Topics by their leaf without `/{}`, such as `posture`."""
_BY_AGENT, _BY_SERVICE = (POSTURE, ACTION, HELD_BACK, EVENT, INTENT, CONTINUATION), (STATUS, INFO)
_NAMED_BY = {**dict.fromkeys(_BY_AGENT, "agent"), **dict.fromkeys(_BY_SERVICE, "service")}
"""The field that gives the last chunk of the key, for the topics whose keys have one."""
_PLACES = {topic.message.SCHEMA: (topic, _NAMED_BY.get(topic)) for topic in TOPICS if topic is not DEPTH}
"""Topics, and that field, by their messages' schema; for images the topic of colour."""


@dataclass(frozen=True)
class Address:
    """A parsed key: its topic, the sensor, and the agent or service chunk where the topic has one."""

    topic: Topic
    sensor: str
    name: str | None


def chunk(text: str) -> str:
    """Return `text` unchanged if it is a valid chunk of a key.

    Raises:
        InvalidKeyError: it holds anything but a-z, 0-9, `_` and `-`, or more than 64 of them.
    """
    if not CHUNK.fullmatch(text):
        raise InvalidKeyError(
            f"{text!r} is not a valid part of a key: use 1 to 64 of the characters a-z, 0-9, '_' and '-'"
        )
    return text


@lru_cache(CACHED_KEYS)
def key(topic: Topic, sensor: str, name: str | int | None = None) -> str:
    """Build the concrete key of a topic, e.g. `actum/kinect0/posture/1`.

    Raises:
        InvalidKeyError: the topic needs a name and none is given, or has none and one is given, or a chunk is invalid.
    """
    if ("{}" in topic.leaf) != (name is not None):
        problem = "needs a name" if name is None else f"takes no name: leave out {name!r}"
        raise InvalidKeyError(f"the topic {topic.leaf!r} {problem}")
    leaf = topic.leaf if name is None else topic.leaf.format(chunk(str(name)))
    return f"{BASE}/{chunk(sensor)}/{leaf}"


def pattern(topic: Topic, sensor: str = "*") -> str:
    """Build the key expression that matches every key of a topic, of one sensor or of any."""
    return f"{BASE}/{sensor if sensor == '*' else chunk(sensor)}/{topic.leaf.format('*')}"


def everything(sensor: str = "*") -> str:
    """Build the key expression that matches every key of a sensor, or of all sensors."""
    return f"{BASE}/{sensor}/**"


def commands_key(sensor: str, service: str) -> str:
    """Build the key that lists a service's commands; those of the commands themselves have their name below it."""
    return f"{BASE}/{chunk(sensor)}/command/{chunk(service)}"


def alive(sensor: str, service: str, instance: str) -> str:
    """Build the key of an instance's liveliness token."""
    return f"{BASE}/{chunk(sensor)}/alive/{chunk(service)}/{chunk(instance)}"


@dataclass(frozen=True)
class Claim:
    """An instance's claim to be the only instance of its service for a sensor.

    Attributes:
        role: `alive` runs, `candidate` is about to start, `successor` asks the running instance to stop, `member`
            serves the sensor whenever it falls to this instance's share.
        instance: the instance's name.
        session: the id of its Zenoh session, which a key with the role `alive` does not hold.
    """

    role: Literal["alive", "candidate", "successor", "member"]
    instance: str
    session: str = ""


def claim_key(claim: Claim, sensor: str, service: str) -> str:
    """Build the key of the liveliness token of a candidate, a successor or a member."""
    return f"{BASE}/{chunk(sensor)}/{claim.role}/{chunk(service)}/{chunk(claim.instance)}/{chunk(claim.session)}"


def claims(sensor: str, service: str) -> str:
    """Build the key expression that matches the liveliness tokens of all claims to a service."""
    return f"{BASE}/{chunk(sensor)}/*/{chunk(service)}/**"


def claim_of(text: str) -> Claim | None:
    """Parse the key of such a token; None for any other key."""
    match text.split("/"):
        case [_, _, "alive", _, instance]:
            return Claim("alive", instance)
        case [_, _, ("candidate" | "successor" | "member") as role, _, instance, session]:
            return Claim(role, instance, session)
        case _:
            return None


@lru_cache(CACHED_KEYS)
def parse(text: str) -> Address:
    """Parse a concrete key.

    Raises:
        InvalidKeyError: no topic of the table has such a key.
    """
    base, _, rest = text.partition("/")
    sensor, _, leaf = rest.partition("/")
    if base == BASE and CHUNK.fullmatch(sensor):
        if leaf in _BY_PREFIX and "{}" not in _BY_PREFIX[leaf].leaf:
            return Address(_BY_PREFIX[leaf], sensor, None)
        prefix, _, name = leaf.rpartition("/")
        topic = _BY_PREFIX.get(prefix)
        if topic is not None and "{}" in topic.leaf and CHUNK.fullmatch(name):
            return Address(topic, sensor, name)
    raise InvalidKeyError(f"{text!r} is not a key of actum: use one of the keys that docs/messages.md lists")


def address_of(message: m.Message) -> Address:
    """Return the parsed form of the key that a message is put on."""
    topic, name = _topic_and_name(message)
    return Address(topic, message.sensor, None if name is None else str(name))


def key_of(message: m.Message) -> str:
    """Build the key a message is put on."""
    topic, name = _topic_and_name(message)
    return key(topic, message.sensor, name)


def _topic_and_name(message: m.Message) -> tuple[Topic, str | int | None]:
    topic, named_by = _PLACES[message.SCHEMA]
    if topic is COLOR:
        topic = DEPTH if isinstance(message, m.Image) and message.format == "depth16_mm" else COLOR
    return topic, None if named_by is None else getattr(message, named_by)
