"""Stores messages for `actum record`; a mark without a stamp gets the one that the classifier resolved it to."""

from collections import Counter
from collections.abc import Collection, Iterable

from actum import keys
from actum.codec import DecodeError
from actum.limits import MAX_SKEW_NS
from actum.messages import MANUAL, Action, Message, Posture, Segment, Skeleton
from actum.node import Counters
from actum.recorder import Recorder
from actum_examples.unstamped_marks import Placed, UnstampedMarks

STREAMS = frozenset(
    {
        keys.SKELETON,
        keys.POSTURE,
        keys.OBJECTS,
        keys.SEGMENT,
        keys.ACTION,
        keys.HELD_BACK,
        keys.EVENT,
        keys.INTENT,
        keys.TRUTH,
    },
)
"""The topics that are stored of every sensor."""

IMAGES = frozenset({keys.COLOR, keys.DEPTH})
"""The topics that are stored only on request: faces are personal data."""


def origin_of(mark: Segment) -> str:
    """Return a mark's origin, `manual` where it names none."""
    return mark.origin or MANUAL


class StreamRecorder:
    """Stores the messages of the given topics, of the marks only those of the given origins.

    A mark without a stamp waits for its segment's final action, which has the bounds that the classifier used. Those
    that wait in vain get the stamp of the frame that was newest when they came. Start marks without a label get
    `label`.

    Attributes:
        stored: number of messages in the file.
        actions: number of start marks among them, by origin and label.
        unended: the segments that have a start and no end so far.
        left_out: number of start marks that were not stored because of their origin, by origin.
        undecodable: number of payloads that do not decode, by kind.
        counters: count the marks that were discarded.
    """

    def __init__(
        self,
        recorder: Recorder,
        topics: Collection[keys.Topic] = STREAMS,
        label: str | None = None,
        origins: Collection[str] | None = (MANUAL,),
    ) -> None:
        self.stored = 0
        self.actions: Counter[tuple[str, str | None]] = Counter()
        self.unended: set[str] = set()
        self.left_out: Counter[str] = Counter()
        self.undecodable: Counter[str] = Counter()
        self.counters = Counters()
        self._recorder = recorder
        self._topics = topics
        self._label = label
        self._origins = origins
        self._newest_ns: int | None = None
        self._marks = UnstampedMarks()
        self._frames_ns: tuple[int, int] | None = None

    def receive(self, message: Message, received_ns: int) -> None:
        """Receive one message and the time it was received at (ns)."""
        if isinstance(message, Skeleton | Posture):
            self._newest_ns = message.stamp_ns
            first_ns, last_ns = self._frames_ns or (message.stamp_ns, message.stamp_ns)
            self._frames_ns = min(first_ns, message.stamp_ns), max(last_ns, message.stamp_ns)
        self._place(self._marks.tick(received_ns))
        if isinstance(message, Action) and message.final:
            self._place(self._marks.answer(message, received_ns))
        if keys.address_of(message).topic not in self._topics:
            return
        if isinstance(message, Segment):
            self._take_mark(message, received_ns)
        else:
            self._store(message, received_ns)

    def reject(self, error: DecodeError) -> None:
        """Count a payload that does not decode."""
        self.undecodable[error.kind] += 1

    def close(self) -> None:
        """Store the marks that still wait; one without an answer that came before any frame is counted and dropped."""
        self._place(self._marks.close())

    def _take_mark(self, mark: Segment, received_ns: int) -> None:
        origin = origin_of(mark)
        if self._origins is not None and origin not in self._origins:
            self.left_out[origin] += mark.kind == "start"
            return
        if mark.kind == "start" and mark.label is None:
            mark = mark.model_copy(update={"label": self._label})
        if mark.stamp_ns is not None:
            first_ns, last_ns = self._frames_ns or (mark.stamp_ns, mark.stamp_ns)
            if not first_ns - MAX_SKEW_NS <= mark.stamp_ns <= last_ns + MAX_SKEW_NS:  # of no frame, past or to come
                self.counters.reject("mark_outside_frames", f"{mark.segment_id} at {mark.stamp_ns} ns, none of theirs")
                return
            self._store(mark, received_ns)
        self._place(self._marks.receive(mark, received_ns, self._newest_ns))

    def _place(self, marks: Iterable[Placed]) -> None:
        for mark, since_ns in marks:
            if mark.stamp_ns is None:
                self.counters.reject("mark_without_stamp", f"{mark.segment_id}: it came before any frame")
            else:
                self._store(mark, since_ns)

    def _store(self, message: Message, received_ns: int) -> None:
        self._recorder.write(message, received_ns)
        self.stored += 1
        if isinstance(message, Segment) and message.kind == "start":
            self.actions[origin_of(message), message.label] += 1
            self.unended.add(message.segment_id)
        elif isinstance(message, Segment):
            self.unended.discard(message.segment_id)
