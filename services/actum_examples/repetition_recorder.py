"""Stores a stream in which one action is repeated, counts the repetitions along and marks them at the end."""

from collections.abc import Callable

from actum.codec import DecodeError
from actum.messages import CUT, Message, Skeleton
from actum_examples.cutting.counting import RepetitionCounter
from actum_examples.cutting.marks import free_names, marks_of
from actum_examples.cutting.repetitions import Cuts
from actum_examples.stream_recorder import StreamRecorder


class RepetitionRecorder:
    """Hands on everything to the recorder of streams, and adds labelled marks of the repetitions when it is closed.

    Attributes:
        cuts: what was cut, after `close`; None where nothing counts, see `why_none`.
    """

    def __init__(
        self, stream: StreamRecorder, label: str, asked: int, counted: Callable[[int], None], done: Callable[[], None]
    ) -> None:
        self.cuts: Cuts | None = None
        self._stream = stream
        self._label = label
        self._counted = counted
        self._done = done
        self._counter = RepetitionCounter(asked)
        self._sensor = ""
        self._told = 1

    @property
    def first_ns(self) -> int | None:
        """Stamp of the first skeleton, None before it came."""
        return self._counter.first_ns

    @property
    def why_none(self) -> str:
        """Why nothing counts, and what to do."""
        return self._counter.why_none

    @property
    def lacks_some(self) -> bool:
        """Whether somebody moved and fewer repetitions were cut than were asked for."""
        if self.cuts is None:
            return self._counter.so_far is not None
        return len(self.cuts.repetitions) < self._counter.asked

    def take(self, message: Message, received_ns: int) -> None:
        """Take one message and the time it was received at (ns)."""
        self._stream.take(message, received_ns)
        if not isinstance(message, Skeleton):
            return
        self._sensor = message.sensor
        if self._counter.take(message):
            self._count_along()

    def reject(self, error: DecodeError) -> None:
        """Count a payload that does not decode."""
        self._stream.reject(error)

    def close(self) -> None:
        """Cut the repetitions, store their marks and whatever is still held back."""
        self.cuts = self._counter.cuts()
        if self.cuts is not None:
            for mark in marks_of(self.cuts, free_names((), CUT), self._label, self._sensor):
                assert mark.stamp_ns is not None
                self._stream.take(mark, mark.stamp_ns)
        self._stream.close()

    def _count_along(self) -> None:
        """Tell when there are more repetitions, and when the last is followed by a long rest."""
        if self._counter.count > self._told:
            self._told = self._counter.count
            self._counted(self._told)
        if self._counter.finished:
            self._done()
