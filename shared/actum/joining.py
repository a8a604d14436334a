"""Concatenates recordings into one stream with rising stamps; intervals and gaps inside a recording stay."""

from collections.abc import Iterable, Iterator

from actum import keys
from actum.messages import Message, Posture
from actum.node import SECOND_NS

PAUSE_NS = SECOND_NS
"""Time between two recordings (ns): so long that filters over time restart."""


def joined(recordings: Iterable[Iterable[Message]], start_ns: int | None = None) -> Iterator[Message]:
    """Yield the messages of recordings, one recording after another, each in the order of its stamps.

    All stamps of a recording are shifted by one constant: the first begins at `start_ns`, or keeps its stamps where
    that is None; every other begins `PAUSE_NS` after the newest stamp before it. The numbers on a key are shifted by
    one constant per recording and session, so that a gap inside stays and none arises between.
    """
    numbers = _Numbers()
    begin_ns = start_ns
    for recording in recordings:
        numbers.next_recording()
        shift_ns: int | None = None
        newest_ns = 0
        for message in recording:
            if shift_ns is None:
                shift_ns = 0 if begin_ns is None else begin_ns - message.stamp_ns
            newest_ns = max(newest_ns, message.stamp_ns + shift_ns)
            changes = {"stamp_ns": message.stamp_ns + shift_ns, "seq": numbers.shifted(message)}
            if isinstance(message, Posture) and message.previous_ns is not None:
                changes["previous_ns"] = max(message.previous_ns + shift_ns, 0)
            yield message.model_copy(update=changes)
        if shift_ns is not None:
            begin_ns = newest_ns + PAUSE_NS


class _Numbers:
    """Continues the sequence numbers of each key from one recording to the next."""

    def __init__(self) -> None:
        self._next: dict[str, int] = {}
        self._base: dict[str, int] = {}
        self._shifts: dict[tuple[str, str], int] = {}

    def next_recording(self) -> None:
        self._base = dict(self._next)
        self._shifts = {}

    def shifted(self, message: Message) -> int | None:
        """Return the message's number in the joined stream; None where it has none."""
        if message.seq is None:
            return None
        key = keys.key_of(message)
        run = key, getattr(message, "session_id", "")
        shift = self._shifts.setdefault(run, self._base.get(key, message.seq) - message.seq)
        self._next[key] = max(self._next.get(key, 0), message.seq + shift + 1)
        return message.seq + shift
