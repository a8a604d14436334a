"""Records a sensor's live streams, and plays recordings on its keys as one live session."""

import threading
import time
from collections.abc import Iterator, Sequence
from itertools import tee
from typing import Any, Protocol

from actum import keys, steady_clock
from actum.codec import DecodeError
from actum.joining import joined
from actum.messages import AUTO, REPLAY, Message, Segment, Skeleton
from actum.node import SECOND_NS
from actum.recording import Recording
from actum.runtime import Client, Listening, Pace

LEAD_IN_S = 0.3  # longer than a service takes to reset at a new session
POLL_S = 0.005  # a sixth of a frame's interval
IMAGES = frozenset({keys.COLOR, keys.DEPTH})
"""Captured streams that objects are derived from."""
ON_ITS_WAY_S = 0.3  # longest delay of a message that was put before the recording was stopped


class Storing(Protocol):
    """What stores messages: `actum_examples.stream_recorder`, or what stands before it."""

    def receive(self, message: Message, received_ns: int) -> None:
        """Receive one message and the time it was received at (ns)."""

    def reject(self, error: DecodeError) -> None:
        """Take note of a payload that does not decode."""

    def close(self) -> None:
        """Store what is still held back."""


def store_all(listening: Sequence[Listening], recorder: Storing, stop: threading.Event, deadline_s: float) -> None:
    """Store messages until stopped or until the deadline (monotonic clock), then those that were put before."""
    while not stop.is_set() and time.monotonic() < deadline_s:
        if not _store(listening, recorder):
            stop.wait(POLL_S)
    time.sleep(ON_ITS_WAY_S)
    while _store(listening, recorder):
        pass
    recorder.close()


def _store(listening: Sequence[Listening], recorder: Storing) -> bool:
    """Store one message of each subscription that has one; tell whether any had."""
    come = [received for each in listening if (received := each.receive()) is not None]
    for received in come:
        if received.message is not None:
            recorder.receive(received.message, steady_clock.now_ns())
        elif received.error is not None:
            recorder.reject(received.error)
    return bool(come)


def put_all(client: Client, recordings: Sequence[Recording], speed: float, stop: threading.Event) -> int:
    """Put recordings at a multiple of their pace, and return how many messages were put.

    An empty frame of the new session goes before them, so that all services reset before the first mark. Its number is
    that before the first frame's, so that none counts as lost between.

    Raises:
        RecordingError: a recording is damaged.
    """
    session_id, start_ns = f"play-{client.run}", steady_clock.now_ns()
    played, ahead = tee(schedule(recordings, session_id, start_ns, client.sensor))
    first = next((message.seq for message in ahead if isinstance(message, Skeleton)), None)
    del ahead  # it would keep all that is played in memory
    seq = None if first is None else max(first - 1, 0)
    client.put(Skeleton(stamp_ns=start_ns - SECOND_NS, seq=seq, sensor=client.sensor, agents=[], session_id=session_id))
    stop.wait(LEAD_IN_S)
    pace, count = Pace(speed), 0
    for message in played:
        if not pace.wait(message.stamp_ns, stop):
            break
        client.put(message)
        count += 1
    return count


def schedule(recordings: Sequence[Recording], session_id: str, start_ns: int, sensor: str) -> Iterator[Message]:
    """Yield the recordings' messages one recording after another in order of stamp, the first stamp being `start_ns`.

    Stamps rise by a second or more between recordings; intervals and gaps in the numbers inside a recording are
    exact. Streams get the session id of this playback. Marks keep their ids, with `#2` … added where an earlier
    recording has used one; they get the origin `replay`, and lose their labels (no live service may know them) and
    their numbers (this player numbers its own). Marks that a classifier put are left out, as its answers are: the one
    that hears the playback finds segments of its own. `sensor` renames the viewpoint. Only messages of
    `playable_topics` are played.

    Raises:
        RecordingError: a recording is damaged.
    """
    taken: set[str] = set()

    def renamed(recording: Recording) -> Iterator[Message]:
        names = _Names(session_id, sensor, taken)
        for message in recording.messages(playable_topics(recording)):
            if not isinstance(message, Segment) or message.origin != AUTO:
                yield names.renamed(message)

    return joined(map(renamed, recordings), start_ns)


def playable_topics(recording: Recording) -> frozenset[keys.Topic]:
    """Choose marks and captured streams; a derived stream only where the stream it derives from was not recorded."""
    chosen = {keys.SKELETON, keys.SEGMENT, *IMAGES}
    if keys.SKELETON not in recording.topics:
        chosen.add(keys.POSTURE)
    if not IMAGES & recording.topics:
        chosen.add(keys.OBJECTS)
    return recording.topics & chosen


class _Names:
    """Renames one recording's sensor, sessions and segments. `taken` holds the segment ids used in this playback."""

    def __init__(self, session_id: str, sensor: str, taken: set[str]) -> None:
        self._session_id, self._sensor, self._taken = session_id, sensor, taken
        self._sessions: dict[str, str] = {}
        self._segments: dict[tuple[str, str], str] = {}

    def renamed(self, message: Message) -> Message:
        """Return a message under its new names."""
        update: dict[str, Any] = {"sensor": self._sensor}
        if isinstance(message, Segment):
            update |= {"segment_id": self._segment(message), "label": None, "origin": REPLAY, "seq": None}
        elif hasattr(message, "session_id"):
            count = len(self._sessions) + 1
            name = self._session_id if count == 1 else f"{self._session_id}.{count}"
            update["session_id"] = self._sessions.setdefault(message.session_id, name)
        return message.model_copy(update=update)

    def _segment(self, mark: Segment) -> str:
        recorded = mark.sensor, mark.segment_id
        if recorded not in self._segments:
            unique, count = mark.segment_id, 1
            while unique in self._taken:
                count += 1
                unique = f"{mark.segment_id}#{count}"
            self._taken.add(unique)
            self._segments[recorded] = unique
        return self._segments[recorded]
