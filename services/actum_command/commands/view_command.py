"""`actum view`: live streams, or a recording, in the Rerun viewer."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event as Flag
from typing import TYPE_CHECKING, Annotated

import typer

from actum.runtime import stop_on_signals
from actum.runtime.stopping import wait_for
from actum_command.commands.recording_options import refuse_output
from actum_command.commands.terminal import failing_on, refuse_without, say
from actum_command.commands.viewed_streams import RecordingArgument, Showing, streams_of, tell_shown

if TYPE_CHECKING:
    from actum_command.viewers.rerun_program import RerunStream


def view(
    recording: RecordingArgument = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="write a Rerun file (.rrd) instead of opening a viewer")
    ] = None,
    web: Annotated[
        bool,
        typer.Option(
            "--web",
            help=(
                "show the viewer in a browser on this machine instead of in a window; the command prints the address "
                "to open"
            ),
        ),
    ] = False,
    port: Annotated[int, typer.Option(min=1, max=65535, help="port on which the Rerun viewer receives data")] = 9876,
    web_port: Annotated[
        int, typer.Option(min=1, max=65535, help="port of the Rerun viewer's web page; used only with --web")
    ] = 9090,
) -> None:
    """Show live streams or a recording in the Rerun viewer until Ctrl-C.

    The viewer shows people, objects, images, plots and events. A recording is loaded completely, so that you can move
    back and forth in it.
    """
    refuse_without("rerun", "rerun-sdk", "view")
    if output is not None:
        refuse_output(output, ".rrd")
    from actum_command.viewers.rerun_program import ViewerError

    stop = stop_on_signals()
    with (
        failing_on(ViewerError),
        streams_of(recording) as streams,
        _opened(streams.sensors, output, web, port, web_port, stop) as rerun,
    ):
        showing = Showing(rerun.show)
        streams.give(showing, stop)
        tell_shown(showing, f"written to {output}" if output else "sent to Rerun")
        if recording is not None and output is None:
            say("Ctrl-C stops")
            wait_for(stop)


@contextmanager
def _opened(
    sensors: list[str], output: Path | None, web: bool, port: int, web_port: int, stop: Flag
) -> "Iterator[RerunStream]":
    """Open what the options name: a file, a page, or a window, whose end sets `stop`."""
    from actum_command.viewers.rerun_program import own_address, page, saved, viewer

    if output is not None:
        with saved(output, sensors) as stream:
            yield stream
        return
    address = own_address()
    with viewer(sensors, address, port, web_port if web else None, stop) as stream:
        if web:
            say(f"open {page(address, port, web_port)}; Ctrl-C stops")
        yield stream
