"""Reads recordings, which `actum.recorder` writes."""

import json
from collections import Counter
from collections.abc import Collection, Iterator
from functools import cached_property
from heapq import merge
from itertools import groupby
from operator import attrgetter
from pathlib import Path

from actum import codec, keys
from actum.limits import MAX_SKEW_NS
from actum.mcap_file import REMEDY, McapFile, RecordingError, StoredMessage
from actum.messages import Image, Message, Segment
from actum.recorder import METADATA

__all__ = ["Recording", "RecordingError"]

ACTION_POINTS = "action_points_ns"
"""The metadata field of annotated action points: a JSON object with a stamp (ns) for each segment's id."""
MOST_HELD = 50
"""How many times its file's size the messages in memory may take: they are a few times as large as they are stored."""
LEAST_HELD_BYTES = 64_000_000
"""What they may take (bytes) however small the file is."""
MESSAGE_BYTES = 250
"""What a message in memory takes beside its payload (bytes)."""

FRAMES = (keys.SKELETON, keys.POSTURE, keys.OBJECTS, keys.COLOR, keys.DEPTH)
"""The topics of which a recording's frames are."""


class Recording:
    """A recording to read. Only its metadata is kept in memory; messages are read from the file on each pass.

    Raises:
        RecordingError: the file cannot be opened, is no MCAP, or is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.skipped: Counter[str] = Counter()
        """Messages that the latest pass skipped, by kind: those on foreign channels and those that do not decode."""
        self._file = McapFile(path)
        self.metadata = self._file.metadata(METADATA)

    @property
    def truncated(self) -> bool:
        """Whether a pass found that the file breaks off; the messages before the break were read."""
        return self._file.truncated

    @property
    def person(self) -> str:
        """Who acts, or "" where the file does not say."""
        return self.metadata.get("person", "")

    @property
    def source(self) -> str:
        """Where the recording comes from, or "" where the file does not say."""
        return self.metadata.get("source", "")

    @property
    def action_points_ns(self) -> dict[str, int]:
        """The annotated action points, the instants at which actions can be recognised, by segment id; mostly none.

        Raises:
            RecordingError: the field of the metadata is not of its form.
        """
        try:
            points: dict[str, int] = json.loads(self.metadata.get(ACTION_POINTS, "{}"))
            return {segment_id: int(stamp_ns) for segment_id, stamp_ns in points.items()}
        except (ValueError, TypeError, AttributeError):
            raise RecordingError(
                self.path,
                f"the metadata field {ACTION_POINTS} is not a JSON object that maps segment ids to time stamps",
                "import the recording again",
            ) from None

    @cached_property
    def topics(self) -> frozenset[keys.Topic]:
        """The topics of which the recording holds at least one message."""
        return frozenset(address.topic for address in self._addresses)

    def sensors(self, topic: keys.Topic) -> list[str]:
        """Return the sensors of which it holds at least one message of a topic, sorted."""
        return sorted({address.sensor for address in self._addresses if address.topic is topic})

    @cached_property
    def _addresses(self) -> list[keys.Address]:
        found = {stored.key: _address(stored.key) for stored in self._file.stored()}
        return [address for address in found.values() if address is not None]

    def messages(self, topics: Collection[keys.Topic] | None = None) -> Iterator[Message]:
        """Yield the messages of these topics, or of all, in order of `publish_time`.

        At one stamp, start marks come before everything else and end marks after it. Images are streamed, each key's
        in the order they were written; all other messages are sorted. A mark that lies further outside of its sensor's
        frames than a message may be late is skipped and counted as `mark_outside_frames`.

        Raises:
            RecordingError: the file is damaged.
        """
        self.skipped.clear()
        without_images, image_keys = self._indexed(topics)
        images = [self._of_key(key) for key in sorted(image_keys)]
        in_order = merge(without_images, *images, key=attrgetter("publish_ns"))
        for _, instant in groupby(in_order, key=attrgetter("publish_ns")):
            yield from sorted(self._decoded(instant), key=_rank)

    def _indexed(self, topics: Collection[keys.Topic] | None) -> tuple[list[StoredMessage], set[str]]:
        """Return the messages that are no images, sorted by stamp, and the keys of the images."""
        addresses: dict[str, keys.Address | None] = {}
        without_images: list[StoredMessage] = []
        image_keys: set[str] = set()
        spans = _Spans()
        left = LEAST_HELD_BYTES + MOST_HELD * self._size_bytes()
        for stored in self._file.stored():
            address = addresses.setdefault(stored.key, _address(stored.key))
            if address is None:
                self.skipped["unknown_key"] += 1
                continue
            spans.note(address, stored.publish_ns)
            if topics is None or address.topic in topics:
                if address.topic.message is Image:
                    image_keys.add(stored.key)
                else:
                    left -= MESSAGE_BYTES + len(stored.payload)
                    if left < 0:
                        raise RecordingError(
                            self.path, "the recording has far more messages than a file of its size can contain", REMEDY
                        )
                    without_images.append(stored)
        within = [each for each in without_images if _may_be_read(addresses[each.key], each.publish_ns, spans)]
        if len(within) < len(without_images):
            self.skipped["mark_outside_frames"] += len(without_images) - len(within)
        return sorted(within, key=attrgetter("publish_ns")), image_keys

    def _size_bytes(self) -> int:
        try:
            return self.path.stat().st_size
        except OSError as error:
            raise RecordingError(self.path, f"the file cannot be read ({error.strerror or error})", REMEDY) from None

    def _of_key(self, key: str) -> Iterator[StoredMessage]:
        return (stored for stored in self._file.stored() if stored.key == key)

    def _decoded(self, instant: Iterator[StoredMessage]) -> Iterator[Message]:
        for stored in instant:
            try:
                message = codec.decode(stored.key, stored.payload, stored.encoding)
            except codec.DecodeError as error:
                self.skipped[error.kind] += 1
                continue
            if message.stamp_ns is None:
                message = message.model_copy(update={"stamp_ns": stored.publish_ns})
            yield message


class _Spans:
    """From when to when each sensor's frames last (ns)."""

    def __init__(self) -> None:
        self._of_sensor: dict[str, tuple[int, int]] = {}

    def note(self, address: keys.Address, stamp_ns: int) -> None:
        """Note a message; only those that a sensor captured, or that follow from these, count."""
        if address.topic in FRAMES:
            first_ns, last_ns = self._of_sensor.get(address.sensor, (stamp_ns, stamp_ns))
            self._of_sensor[address.sensor] = min(first_ns, stamp_ns), max(last_ns, stamp_ns)

    def hold(self, sensor: str, stamp_ns: int) -> bool:
        """Tell whether a mark may belong to a sensor's frames; where it has none, every mark may."""
        if sensor not in self._of_sensor:
            return True
        first_ns, last_ns = self._of_sensor[sensor]
        return first_ns - MAX_SKEW_NS <= stamp_ns <= last_ns + MAX_SKEW_NS


def _may_be_read(address: keys.Address | None, stamp_ns: int, spans: _Spans) -> bool:
    """Tell whether a message is no mark, or one that may belong to its sensor's frames."""
    return address is None or address.topic is not keys.SEGMENT or spans.hold(address.sensor, stamp_ns)


def _address(key: str) -> keys.Address | None:
    try:
        return keys.parse(key)
    except keys.InvalidKeyError:
        return None


def _rank(message: Message) -> int:
    """Return a message's rank within one stamp: start marks first, end marks last, so frames at both belong to it."""
    if not isinstance(message, Segment):
        return 1
    return 0 if message.kind == "start" else 2
