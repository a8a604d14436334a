"""Stores a stream in which one action is repeated, counts the repetitions along and marks them at the end."""

from collections.abc import Callable

from actum.codec import DecodeError
from actum.messages import Message, Skeleton
from actum_examples.cutting.counting import RepetitionCounter
from actum_examples.cutting.repetitions import Cuts
from actum_examples.marking import cut_marks
from actum_examples.stream_recorder import StreamRecorder


class RepetitionRecorder:
    """Passes everything to the recorder of streams, and adds labelled marks of the repetitions when it is closed.

    Attributes:
        counter: of the repetitions.
        cuts: what was cut, after `close`; None where nothing counts, see `RepetitionCounter.why_none`.
    """

    def __init__(
        self, stream: StreamRecorder, label: str, asked: int, counted: Callable[[int], None], done: Callable[[], None]
    ) -> None:
        self.counter = RepetitionCounter(asked)
        self.cuts: Cuts | None = None
        self._stream = stream
        self._label = label
        self._counted = counted
        self._done = done
        self._reported = 1

    @property
    def lacks_some(self) -> bool:
        """Whether somebody moved and fewer repetitions were cut than were asked for."""
        if self.cuts is None:
            return self.counter.so_far is not None
        return len(self.cuts.repetitions) < self.counter.asked

    def receive(self, message: Message, received_ns: int) -> None:
        """Receive one message and the time it was received at (ns); report a higher count, and the end."""
        self._stream.receive(message, received_ns)
        if not isinstance(message, Skeleton) or not self.counter.receive(message):
            return
        if self.counter.count > self._reported:
            self._reported = self.counter.count
            self._counted(self._reported)
        if self.counter.finished:
            self._done()

    def reject(self, error: DecodeError) -> None:
        """Count a payload that does not decode."""
        self._stream.reject(error)

    def close(self) -> None:
        """Cut the repetitions, store their marks and whatever is still held back."""
        self.cuts = self.counter.cuts()
        if self.cuts is not None:
            for mark in cut_marks(self.cuts, self._label, self.counter.sensor):
                assert mark.stamp_ns is not None
                self._stream.receive(mark, mark.stamp_ns)
        self._stream.close()
