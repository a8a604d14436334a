"""The service `event_recorder`: stores marks, final actions and events as they come."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from pathlib import Path

from actum import keys, steady_clock
from actum.codec import encode
from actum.messages import Action, Event, Message, Segment
from actum.node import Counters, Tick
from actum.runtime import run
from actum.states import State
from actum_command.history.event_files import EventFiles
from actum_command.history.settings import Settings
from actum_examples.unstamped_marks import Placed, UnstampedMarks


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
        self._marks = UnstampedMarks()
        self._recovered = False
        self._before = frozenset[int]()

    def handle(self, message: Message | Tick) -> list[Message]:
        """Store one message, or do on a tick what has become due; nothing is put."""
        try:
            if not self._recovered:  # what a killed process has left: this instance has its place now
                self._recovered = True
                for problem in self._files.recover():
                    self.counters.reject("unreadable_history", problem)
                self._before = frozenset(map(hash, self._files.newest()))
            match message:
                case Tick():
                    self._tick(message.monotonic_ns)
                case Segment():
                    if message.stamp_ns is not None:
                        self._write(message)
                    self._place(self._marks.receive(message, self._now_ns))
                case Action(final=True):
                    self._write(message)
                    self._place(self._marks.answer(message, self._now_ns))
                case Event():
                    self._write(message)
        except OSError as error:
            self._tell(error)
        return []

    def close(self) -> None:
        """Finish the open file, once nothing more will come.

        Raises:
            OSError: it cannot be finished; it is readable under its unfinished name.
        """
        self._place(self._marks.close())
        self._files.finish()

    def _tick(self, now_ns: int) -> None:
        self._now_ns = now_ns
        self._files.tick(now_ns)
        self._place(self._marks.tick(now_ns))
        self.counters.counts.update(
            Counter(files=self._files.finished, deleted=self._files.deleted) - self.counters.counts
        )

    def _place(self, marks: Iterable[Placed]) -> None:
        """Store marks with the stamps of their answers; those that nothing has answered are counted."""
        for mark, _ in marks:
            if mark.stamp_ns is None:
                self.counters.reject("mark_without_stamp", f"{mark.segment_id}: nothing has answered it")
            else:
                self._write(mark)

    def _write(self, message: Message) -> None:
        """Store a message, unless it has been stored before this process: the last ones come once more."""
        if self._before and hash(encode(message)[:2]) in self._before:
            return
        try:
            self._files.write(message, self._received_ns(), self._now_ns)
            self.counters.state = State.RUNNING
        except OSError as error:
            self._tell(error)

    def _tell(self, error: OSError) -> None:
        """Count what could not be written, and say so in the state."""
        self.counters.reject("unwritable_history", f"{error.strerror} ({error.filename or 'the disk'})")
        self.counters.state = f"history not written: {error.strerror}; it tries again with each message"


def keep_events(folder: Path, arguments: Sequence[str]) -> None:
    """Store events in a folder until SIGTERM or SIGINT, and finish the file that is open then."""
    with ExitStack() as ending:

        def build(settings: Settings) -> EventRecorder:
            if folder.suffix == ".mcap" or folder.is_file():
                raise ValueError(f"{folder} looks like a file, but --events writes several files: give a folder")
            files = EventFiles(folder, settings.sensor, settings)
            recorder = EventRecorder(files, steady_clock.now_ns)
            ending.callback(recorder.close)
            return recorder

        run(Settings, build, arguments)
