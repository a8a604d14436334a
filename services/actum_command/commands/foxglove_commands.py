"""`actum foxglove` and `actum export`: live streams, or a recording, for Foxglove."""

from pathlib import Path
from threading import Event as Flag
from typing import Annotated
from urllib.parse import urlsplit

import typer

from actum.recording import Recording
from actum.runtime import Pace, stop_on_signals
from actum.runtime.stopping import wait_for
from actum_command.commands.recording_options import refuse_output
from actum_command.commands.terminal import fail, failing_on, refuse_without, say
from actum_command.commands.viewed_streams import RecordingArgument, Showing, streams_of, tell_shown

POLL_S = 0.1  # how soon a stop takes effect while nobody has subscribed
MOST_REFUSALS = 20  # distinct refusals that are printed
SUBSCRIBING_S = 0.5  # from a client's first subscription to its last: a viewer's panels subscribe one after another


def foxglove(
    recording: RecordingArgument = None,
    host: Annotated[
        str,
        typer.Option(
            help=(
                "address to listen on. With 127.0.0.1, only this machine can connect. With any other address, "
                "everybody on your network can watch"
            )
        ),
    ] = ("127.0.0.1"),
    port: Annotated[int, typer.Option(min=0, max=65535, help="port to listen on; 0 picks a free port")] = 8765,
    origin: Annotated[
        list[str] | None,
        typer.Option(
            help=(
                "address of a website that is allowed to connect, such as https://app.foxglove.dev. The option can be "
                "repeated. Default: no website can connect, only programs such as Foxglove's desktop program"
            )
        ),
    ] = None,
    speed: Annotated[
        float,
        typer.Option(min=0.01, help="playback speed of a recording; 1 is real time, 2 is twice as fast"),
    ] = 1.0,
) -> None:
    """Serve live streams or a recording to the Foxglove viewer, with people, objects, images and events, until Ctrl-C.

    Foxglove's desktop program can connect without further options. A website can connect only if --origin names the
    website; the command prints each website that it refuses. A recording starts to play when a viewer connects. To move
    back and forth in a recording, convert the recording with 'actum export', and open the converted file in Foxglove.
    """
    refuse_without("foxglove", "foxglove-sdk", "foxglove")
    from actum_command.viewers.foxglove_sinks import ServerError, served

    origins = [_origin(each) for each in origin or []]
    stop, subscribed = stop_on_signals(), Flag()
    with (
        failing_on(ServerError),
        streams_of(recording, Pace(speed)) as streams,
        served(streams.sensors, host, port, subscribed, origins, _Refusals()) as (stream, address),
    ):
        say(f"open a connection to {address} in Foxglove; Ctrl-C stops")
        if recording is not None:
            while not subscribed.is_set() and not stop.wait(POLL_S):
                pass
            wait_for(stop, SUBSCRIBING_S)
        showing = Showing(stream.show)
        streams.give(showing, stop)
        tell_shown(showing, "served")


class _Refusals:
    """Prints each refusal once, and no more than a few: a website may try again and again."""

    def __init__(self) -> None:
        self._told: set[str] = set()

    def __call__(self, refusal: str) -> None:
        if refusal not in self._told and len(self._told) < MOST_REFUSALS:
            self._told.add(refusal)
            say(f"refused: {refusal}", style="yellow")


def _origin(text: str) -> str:
    """Return an origin as browsers write it; fail where it stands for no site, or for any."""
    advice = (
        f"--origin {text} is not an origin: use the one that is printed for a refused page, such as "
        "https://app.foxglove.dev"
    )
    try:
        site = urlsplit(text)
    except ValueError:
        fail(advice)
    if (
        site.scheme not in ("http", "https", "file")
        or site.path.strip("/")
        or bool(site.netloc) == (site.scheme == "file")
    ):
        fail(advice)
    return f"{site.scheme}://{site.netloc.lower()}"


def export(
    file: Annotated[Path, typer.Argument(metavar="REC", help="the recording to convert (.mcap, written by actum)")],
    output: Annotated[Path, typer.Argument(metavar="OUT", help="the file to write (.mcap)")],
    for_foxglove: Annotated[
        bool,
        typer.Option(
            "--foxglove",
            help=(
                "write the messages in Foxglove's format; this option is required, because there is no other format yet"
            ),
        ),
    ] = False,
) -> None:
    """Convert a recording to a file that Foxglove can open.

    Example: actum export --foxglove wave.mcap out.mcap
    """
    if not for_foxglove:
        fail("no output format is given: add --foxglove")
    refuse_without("foxglove", "foxglove-sdk", "foxglove")
    refuse_output(output)
    from actum_command.viewers.foxglove_sinks import written

    try:
        with streams_of(file) as streams, written(output, Recording(file).metadata) as stream:
            showing = Showing(stream.show)
            streams.give(showing, stop_on_signals())
    except OSError as error:
        fail(f"{output} cannot be written ({error.strerror or error}): give another file")
    tell_shown(showing, f"written to {output}")
