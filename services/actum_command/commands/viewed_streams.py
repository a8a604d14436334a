"""What the commands for viewers share: where messages come from, and what is told of them at the end."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import typer

from actum.installing import adding
from actum.recording import Recording, RecordingError
from actum.runtime import Pace
from actum_command.commands.recording_options import tell_unread
from actum_command.commands.terminal import connect, fail, say
from actum_command.viewers.showing import LiveStreams, RecordedStreams, Showing, Streams

RecordingArgument = Annotated[
    Path | None,
    typer.Argument(metavar="[REC]", help="the recording to show; default: the live streams of the sensor (--sensor)"),
]


def refuse_without(module: str, package: str, extra: str) -> None:
    """Fail where a viewer's library is not installed."""
    if find_spec(module) is None:
        fail(f"{package} is not installed: {adding(extra)}")


@contextmanager
def streams_of(file: Path | None, pace: Pace | None = None) -> Iterator[Streams]:
    """Return a context with a recording's streams, or with the live ones of the sensor; fail where there are none."""
    if file is None:
        with connect() as client:
            yield LiveStreams(client)
        return
    try:
        recording = Recording(file)
        streams = RecordedStreams(recording, pace)
        if not streams.sensors:
            fail(f"{file} contains no message of actum: give a recording made by `actum record` or `actum import`")
        yield streams
    except RecordingError as error:
        fail(str(error))
    tell_unread([recording])


def tell_shown(showing: Showing, where: str) -> None:
    """Print how many messages were shown, and how many could not be."""
    say(f"{showing.shown} messages {where}")
    if showing.not_shown:
        say(f"not shown: {', '.join(f'{kind} {n}' for kind, n in sorted(showing.not_shown.items()))}", style="yellow")
