"""What the commands for viewers share: where messages come from, how each is shown, and what is printed at the end."""

import threading
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from actum import keys
from actum.codec import DecodeError
from actum.messages import Message, Posture, Skeleton
from actum.recording import Recording, RecordingError
from actum.runtime import Client, Pace
from actum_command.commands.recording_options import tell_unread
from actum_command.commands.terminal import connect, fail, failing_on, say
from actum_command.streaming import store_all

RecordingArgument = Annotated[
    Path | None,
    typer.Argument(metavar="[REC]", help="the recording to show; default: the live streams of the sensor (--sensor)"),
]


class Showing:
    """Shows messages, each at its stamp; a mark without one gets that of the frame that is newest as it comes.

    Attributes:
        shown: number of messages given to the viewer.
        not_shown: number of those that could not be, by kind.
    """

    def __init__(self, show: Callable[[Message], None]) -> None:
        self.shown = 0
        self.not_shown: Counter[str] = Counter()
        self._show = show
        self._newest_ns: int | None = None

    def receive(self, message: Message, _received_ns: int = 0) -> None:
        """Show one message."""
        if isinstance(message, Skeleton | Posture):
            self._newest_ns = message.stamp_ns
        if message.stamp_ns is None:
            if self._newest_ns is None:
                self.not_shown["mark_without_stamp"] += 1
                return
            message = message.model_copy(update={"stamp_ns": self._newest_ns})
        self._show(message)
        self.shown += 1

    def reject(self, error: DecodeError) -> None:
        """Count a payload that does not decode."""
        self.not_shown[error.kind] += 1

    def close(self) -> None:
        """Do nothing: no message is held back."""


class LiveStreams:
    """What is put on a sensor's keys from now on."""

    def __init__(self, client: Client) -> None:
        self.sensors = [client.sensor]
        self._listening = client.listen(keys.everything(client.sensor))

    def give(self, showing: Showing, stop: threading.Event) -> None:
        """Show what comes until stopped."""
        store_all([self._listening], showing, stop, float("inf"))


class RecordedStreams:
    """A recording, at a pace or as fast as it is read.

    Raises:
        RecordingError: the file is damaged, also from `give`.
    """

    def __init__(self, recording: Recording, pace: Pace | None = None) -> None:
        self.sensors = sorted({sensor for topic in recording.topics for sensor in recording.sensors(topic)})
        self._recording, self._pace = recording, pace

    def give(self, showing: Showing, stop: threading.Event) -> None:
        """Show its messages to the end, or until stopped."""
        for message in self._recording.messages():
            if stop.is_set() or (self._pace is not None and not self._pace.wait(message.stamp_ns, stop)):
                return
            showing.receive(message)


@contextmanager
def streams_of(file: Path | None, pace: Pace | None = None) -> Iterator[LiveStreams | RecordedStreams]:
    """Return a context with a recording's streams, or with the live ones of the sensor; fail where there are none."""
    if file is None:
        with connect() as client:
            yield LiveStreams(client)
        return
    with failing_on(RecordingError):
        recording = Recording(file)
        streams = RecordedStreams(recording, pace)
        if not streams.sensors:
            fail(f"{file} contains no message of actum: give a recording made by `actum record` or `actum import`")
        yield streams
    tell_unread([recording])


def tell_shown(showing: Showing, where: str) -> None:
    """Print how many messages were shown, and how many could not be."""
    say(f"{showing.shown} messages {where}")
    if showing.not_shown:
        say(f"not shown: {', '.join(f'{kind} {n}' for kind, n in sorted(showing.not_shown.items()))}", style="yellow")
