"""The service `event_recorder`: stores marks, final actions and events as they come."""

from collections import Counter, OrderedDict, deque
from collections.abc import Callable
from dataclasses import dataclass

from actum import keys
from actum.messages import Action, Event, Message, Segment
from actum.node import SETTLE_NS, Counters, Tick
from actum_command.history.event_files import EventFiles

MOST_WAITING = 1000
"""Most marks without a stamp that wait for their segment's answer."""
MOST_ANSWERED = 256
"""Most answered segments whose bounds are kept for marks that come after the answer."""


@dataclass(frozen=True)
class _Waiting:
    mark: Segment
    since_ns: int


class EventRecorder:
    """Writes what comes to files. A mark without a stamp waits for the final action, which has the one it was given.

    Args:
        files: where to.
        received_ns: the clock of receipts, ns since 1970.
    """

    name = "event_recorder"
    inputs = (keys.SEGMENT, keys.ACTION, keys.EVENT)

    def __init__(self, files: EventFiles, received_ns: Callable[[], int]) -> None:
        self.counters = Counters()
        self._files, self._received_ns, self._now_ns = files, received_ns, 0
        self._waiting: deque[_Waiting] = deque()
        self._bounds: OrderedDict[str, tuple[int, int]] = OrderedDict()
        self._recovered = False

    def handle(self, message: Message | Tick) -> list[Message]:
        """Store one message, or do on a tick what has become due; nothing is put."""
        try:
            self._recover()
            self._take(message)
        except OSError as error:
            self.counters.reject("unwritable_history", f"{error.strerror} ({error.filename or 'the disk'})")
            self.counters.state = f"history not written: {error.strerror}; it tries again with each message"
        return []

    def close(self) -> None:
        """Finish the open file, once nothing more will come.

        Raises:
            OSError: it cannot be finished; it is readable under its unfinished name.
        """
        self._files.finish()

    def _recover(self) -> None:
        """Finish what a killed process has left, once this instance has its place and before it writes anything."""
        if not self._recovered:
            self._recovered = True
            for problem in self._files.recover():
                self.counters.reject("unreadable_history", problem)

    def _take(self, message: Message | Tick) -> None:
        match message:
            case Tick():
                self._tick(message.monotonic_ns)
            case Segment(stamp_ns=None):
                self._take_unstamped(message)
            case Action(final=True):
                self._write(message)
                self._resolve(message)
            case Segment() | Event():
                self._write(message)

    def _tick(self, now_ns: int) -> None:
        self._now_ns = now_ns
        self._files.tick(now_ns)
        while self._waiting and now_ns - self._waiting[0].since_ns > SETTLE_NS:
            self._forget(self._waiting.popleft().mark)
        self.counters.counts.update(
            Counter(files=self._files.finished, deleted=self._files.deleted) - self.counters.counts
        )

    def _write(self, message: Message) -> None:
        self._files.write(message, self._received_ns(), self._now_ns)
        self.counters.state = "running"

    def _take_unstamped(self, mark: Segment) -> None:
        if mark.segment_id in self._bounds:
            self._write(_stamped(mark, self._bounds[mark.segment_id]))
            return
        self._waiting.append(_Waiting(mark, self._now_ns))
        if len(self._waiting) > MOST_WAITING:
            self._forget(self._waiting.popleft().mark)

    def _resolve(self, final: Action) -> None:
        """Store the marks that wait for a segment's answer, and keep its bounds for those that are late."""
        bounds = self._bounds[final.segment_id] = (final.start_ns, final.end_ns or final.stamp_ns or final.start_ns)
        if len(self._bounds) > MOST_ANSWERED:
            self._bounds.popitem(last=False)
        resolved = [waiting for waiting in self._waiting if waiting.mark.segment_id == final.segment_id]
        for waiting in resolved:
            self._waiting.remove(waiting)
            self._write(_stamped(waiting.mark, bounds))

    def _forget(self, mark: Segment) -> None:
        self.counters.reject("mark_without_stamp", f"{mark.segment_id}: nothing has answered it")


def _stamped(mark: Segment, bounds: tuple[int, int]) -> Segment:
    return mark.model_copy(update={"stamp_ns": bounds[mark.kind == "end"]})
