"""Prepares recordings for `actum play`: one after another, with the stamps, numbers and names of one live session."""

from collections.abc import Collection, Iterator, Sequence
from typing import Any

from actum import keys
from actum.joining import joined
from actum.messages import AUTO, REPLAY, Message, Segment
from actum.recording import Recording

IMAGES = frozenset({keys.COLOR, keys.DEPTH})
"""Captured streams that objects are derived from."""


def schedule(
    recordings: Sequence[Recording],
    session_id: str,
    start_ns: int,
    sensor: str | None = None,
    topics: Collection[keys.Topic] | None = None,
) -> Iterator[Message]:
    """Yield the recordings' messages one recording after another in order of stamp, the first stamp being `start_ns`.

    Stamps rise by a second or more between recordings; intervals and gaps in the numbers inside a recording are
    exact. Streams get the session id of this playback. Marks keep their ids, with `#2` … added where an earlier
    recording has used one; they get the origin `replay`, and lose their labels (no live service may know them) and
    their numbers (this player numbers its own). Marks that a classifier put are left out, as its answers are: the one
    that hears the playback finds segments of its own. `sensor` renames the viewpoint. Only messages of `topics` are
    played, by default of each recording's `playable_topics`.

    Raises:
        RecordingError: a recording is damaged.
    """
    taken: set[str] = set()

    def renamed(recording: Recording) -> Iterator[Message]:
        chosen = playable_topics(recording) if topics is None else topics
        given = (message for message in recording.messages(chosen) if not _is_found(message))
        return map(_Names(session_id, sensor, taken).renamed, given)

    return joined(map(renamed, recordings), start_ns)


def playable_topics(recording: Recording) -> frozenset[keys.Topic]:
    """Choose marks and captured streams; a derived stream only where the stream it derives from was not recorded."""
    chosen = {keys.SKELETON, keys.SEGMENT, *IMAGES}
    if keys.SKELETON not in recording.topics:
        chosen.add(keys.POSTURE)
    if not IMAGES & recording.topics:
        chosen.add(keys.OBJECTS)
    return recording.topics & chosen


def _is_found(message: Message) -> bool:
    """Tell whether a message is the mark of a classifier."""
    return isinstance(message, Segment) and message.origin == AUTO


class _Names:
    """Renames one recording's sensor, sessions and segments. `taken` holds the segment ids used in this playback."""

    def __init__(self, session_id: str, sensor: str | None, taken: set[str]) -> None:
        self._session_id = session_id
        self._sensor = sensor
        self._taken = taken
        self._sessions: dict[str, str] = {}
        self._segments: dict[tuple[str, str], str] = {}

    def renamed(self, message: Message) -> Message:
        """Return a message under its new names."""
        update: dict[str, Any] = {} if self._sensor is None else {"sensor": self._sensor}
        if isinstance(message, Segment):
            name = self._segment(message.sensor, message.segment_id)
            update |= {"segment_id": name, "label": None, "origin": REPLAY, "seq": None}
        elif hasattr(message, "session_id"):
            update["session_id"] = self._session(message.session_id)
        return message.model_copy(update=update)

    def _session(self, recorded: str) -> str:
        if recorded not in self._sessions:
            count = len(self._sessions) + 1
            self._sessions[recorded] = self._session_id if count == 1 else f"{self._session_id}.{count}"
        return self._sessions[recorded]

    def _segment(self, sensor: str, recorded: str) -> str:
        if (sensor, recorded) not in self._segments:
            unique, count = recorded, 1
            while unique in self._taken:
                count += 1
                unique = f"{recorded}#{count}"
            self._taken.add(unique)
            self._segments[sensor, recorded] = unique
        return self._segments[sensor, recorded]
