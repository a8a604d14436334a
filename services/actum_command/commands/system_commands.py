"""`actum up` and `actum router`: the whole system, or its router alone."""

import logging
import threading
from pathlib import Path
from typing import Annotated, get_args

import typer

from actum.installing import adding
from actum.runtime import serve_router, stop_on_signals
from actum.settings import DEFAULT_ENDPOINT, SettingsError, host_and_port
from actum_command import processes
from actum_command.commands.service_flags import with_service_flags
from actum_command.commands.terminal import fail, say, settings
from actum_command.service_settings import Given
from actum_command.startup import CHECK_S, chosen_source, lack_of_model, refuse_taken, wait_for_router
from actum_command.supervising import Program, Supervisor, UnusableError
from sensor_gateway.settings import SourceName

SOURCES = [name for name in get_args(SourceName) if name != "marker-camera"]
"""The sources of the gateway that `actum up` can start: a marker camera runs only beside another source."""

NO_MARKS = (
    "nobody marks actions here, so those are told that the model finds by itself; to mark: 'actum segment toggle', "
    "or 'actum play' beside --source none"
)


def router(
    listen: Annotated[str | None, typer.Option(help=f"endpoint; default {DEFAULT_ENDPOINT} unless --config")] = None,
    config: Annotated[Path | None, typer.Option(help="a Zenoh JSON5 configuration", exists=True)] = None,
    credentials: Annotated[
        Path | None, typer.Option(help="the folder of a router's credentials", envvar="ACTUM_CREDENTIALS")
    ] = None,
    link: Annotated[
        str | None, typer.Option(help="endpoint of another host's router, to be one system with it")
    ] = None,
) -> None:
    """Run the embedded Zenoh router; with credentials it listens anew by itself when these are renewed."""
    logging.basicConfig(level="INFO", format="router: %(message)s")
    here = settings()
    endpoint = listen or (None if config else here.connect)
    try:
        if link is not None:
            host_and_port(link)
        if endpoint is not None:
            refuse_taken(endpoint)
        serve_router(endpoint, config, stop_on_signals(), credentials, here.health_file, link)
    except SettingsError as error:
        fail(str(error))


@with_service_flags
def up(
    source: Annotated[
        str | None,
        typer.Option(
            help=f"simulator, {', '.join(SOURCES)} or none; default: camera where --camera names one, else simulator"
        ),
    ] = None,
    path: Annotated[Path | None, typer.Option(help="what a source from files plays")] = None,
    model: Annotated[
        Path | None, typer.Option(help="the model; it may come or change later", envvar="ACTUM_MODEL")
    ] = None,
    page: Annotated[bool, typer.Option("--page/--no-page", help="serve the web page, whose address is printed")] = True,
    *,
    given: Given,
) -> None:
    """Run router and all services here, restart what ends, until Ctrl-C."""
    here = settings()
    if here.credentials is not None:
        fail("everything of 'actum up' runs on this machine and shows no credentials: leave ACTUM_CREDENTIALS unset")
    try:
        source = chosen_source(source, given, path)
        refuse_taken(here.connect)
        programs = processes.system(here, source, path, model, given)
        say(f"actum starts on {here.connect}, sensor {here.sensor}: try 'actum watch'; Ctrl-C ends")
        if processes.scene(here) not in programs:
            say(NO_MARKS)
        if page:
            programs = processes.with_page(here, programs, given)
            if programs[-1].name != processes.PAGE:
                say(f"no web page: {adding('web-dashboard')}", style="yellow")
        taught = processes.taught_model(given)
        if (lack := lack_of_model(taught if model is None and taught.exists() else model)) is not None:
            say(lack, style="yellow")
        stop = stop_on_signals()
        with Supervisor() as supervisor:
            supervisor.start(processes.router(here))
            wait_for_router(here, stop)
            supervise(supervisor, programs, stop)
    except SettingsError as error:
        fail(str(error))


def supervise(supervisor: Supervisor, programs: list[Program], stop: threading.Event) -> None:
    """Keep programs running until stopped; fail where one cannot be used as it is set."""
    for program in programs:
        supervisor.start(program)
    try:
        while not stop.wait(CHECK_S):
            for line in supervisor.restart_ended():
                say(line, style="yellow")
    except UnusableError as error:
        fail(str(error))
