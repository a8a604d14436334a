"""Stores a stream in which one action is repeated, counts the repetitions along and marks them at the end."""

from collections.abc import Callable

from actum.codec import DecodeError
from actum.messages import CUT, Message, Skeleton
from actum.node import SECOND_NS
from actum_command.labelled_segments import free_names, marks_of
from actum_command.stream_recorder import StreamRecorder
from actum_model_trainer.cutting.courses import PersonTracks
from actum_model_trainer.cutting.repetitions import Cuts, cut, cut_so_far

COUNT_EVERY_S = 0.5
"""Shortest time between two counts: a repetition is noticed soon after its end."""
COUNT_SHARE = 0.05
"""Time between two counts as a share of the stream so far: counting takes longer the longer the stream is."""
LAST_REST_S = 3.0
"""Rest after which the last repetition is over, as the person is told."""
REST_RATIO = 2.0
"""That rest is also longer than any before, by this factor: a stop within each of them is no end."""


class RepetitionRecorder:
    """Hands on everything to the recorder of streams, and adds labelled marks of the repetitions when it is closed.

    Attributes:
        cuts: what was cut, after `close`; None where nobody moved.
        first_ns: stamp of the first skeleton, None before it came.
    """

    def __init__(
        self, stream: StreamRecorder, label: str, asked: int, counted: Callable[[int], None], done: Callable[[], None]
    ) -> None:
        self.cuts: Cuts | None = None
        self.first_ns: int | None = None
        self._stream = stream
        self._label = label
        self._asked = asked
        self._counted = counted
        self._done = done
        self._tracks = PersonTracks()
        self._sensor = ""
        self._count = 0
        self._next_count_ns = 0

    def take(self, message: Message, received_ns: int) -> None:
        """Take one message and the time it was received at (ns)."""
        self._stream.take(message, received_ns)
        if not isinstance(message, Skeleton):
            return
        if self.first_ns is None or message.stamp_ns < self.first_ns:
            self.first_ns = self._next_count_ns = message.stamp_ns
            self._sensor = message.sensor
        self._tracks.take(message)
        if message.stamp_ns >= self._next_count_ns:
            so_far_ns = message.stamp_ns - self.first_ns
            self._next_count_ns = message.stamp_ns + round(max(COUNT_EVERY_S * SECOND_NS, COUNT_SHARE * so_far_ns))
            self._count_along(self.first_ns)

    def reject(self, error: DecodeError) -> None:
        """Count a payload that does not decode."""
        self._stream.reject(error)

    def close(self) -> None:
        """Cut the repetitions, store their marks and whatever is still held back."""
        if self.first_ns is not None:
            self.cuts = cut(self._tracks.courses(), self._asked, self.first_ns)
        if self.cuts is not None:
            for mark in marks_of(self.cuts, free_names((), CUT), self._label, self._sensor):
                assert mark.stamp_ns is not None
                self._stream.take(mark, mark.stamp_ns)
        self._stream.close()

    def _count_along(self, first_ns: int) -> None:
        """Count the repetitions so far, tell when there are more, and when the last is followed by a long rest."""
        so_far = cut_so_far(self._tracks.courses(), self._asked, first_ns)
        if so_far is None:
            return
        count = len(so_far.repetitions)
        if count > max(self._count, 1):
            self._count = count
            self._counted(count)
        if count >= self._asked and so_far.resting_s > max(LAST_REST_S, REST_RATIO * so_far.longest_pause_s):
            self._done()
