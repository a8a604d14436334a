"""`actum up` and `actum router`: the whole system, or its router alone."""

import logging
import threading
import time
from pathlib import Path
from typing import Annotated, get_args

import typer
from pydantic import ValidationError

from actum.installing import adding
from actum.runtime import serve_router, stop_on_signals
from actum.settings import DEFAULT_ENDPOINT, ServiceSettings, SettingsError, complaint, host_and_port
from actum_command import processes
from actum_command.commands.service_flags import with_service_flags
from actum_command.commands.terminal import fail, say, settings
from actum_command.introduction import how_found, lack_of_model, segments_of, source_of
from actum_command.model_in_use import ModelInUse, Reminder, model_in_use
from actum_command.service_settings import Given
from actum_command.startup import CHECK_S, chosen_source, refuse_marks, refuse_taken, wait_for_router
from actum_command.supervising import Program, Supervisor, UnusableError
from sensor_gateway.settings import SourceName

SOURCES = [name for name in get_args(SourceName) if name != "marker-camera"]
"""The sources of the gateway that `actum up` can start: a marker camera runs only beside another source."""


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
        Path | None,
        typer.Option(
            help="the model, which is only read and may come or change later; default: the one that was put into use "
            "last, at first, for the simulated scene, the one that ships",
            envvar="ACTUM_MODEL",
        ),
    ] = None,
    marked: Annotated[
        bool, typer.Option("--marked", help="the simulated scene marks its own actions, as a switch would")
    ] = False,
    page: Annotated[bool, typer.Option("--page/--no-page", help="serve the web page, whose address is printed")] = True,
    *,
    given: Given,
) -> None:
    """Run router and all services here, restart what ends, until Ctrl-C."""
    here = settings()
    if here.credentials is not None:
        fail("'actum up' runs everything on this machine, without credentials: unset ACTUM_CREDENTIALS")
    try:
        source = chosen_source(source, given, path)
        segments = segments_of(given)
        refuse_marks(marked, source, segments)
        refuse_taken(here.connect)
        with model_in_use(model, source, given) as chosen:
            programs = processes.system(here, source, path, chosen, given)
            programs += [processes.scene(here)] if marked else []
            say(f"actum starts on {here.connect}, sensor {here.sensor}: try 'actum watch'; Ctrl-C ends")
            _introduce(chosen, segments, marked)
            run(here, _with_page(here, programs, given) if page else programs, chosen)
    except (SettingsError, ValidationError) as error:
        fail(complaint(error))


def _introduce(model: ModelInUse, segments: str, marked: bool) -> None:
    """Print how actions are found, which model is used, and what is missing."""
    say(how_found(segments, marked))
    if (model.original or model.file).exists():
        say(f"model: {source_of(model)}")
    if (lack := lack_of_model(model, segments, marked)) is not None:
        say(lack, style="bold yellow")


def _with_page(here: ServiceSettings, programs: list[Program], given: Given) -> list[Program]:
    """Return the programs with the page; print how to install it where it is not."""
    showing = processes.with_page(here, programs, given)
    if showing[-1].name != processes.PAGE:
        say(f"no web page: {adding('web-dashboard')}", style="yellow")
    return showing


def run(here: ServiceSettings, programs: list[Program], model: ModelInUse) -> None:
    """Run a router and programs until stopped."""
    stop = stop_on_signals()
    with Supervisor() as supervisor:
        supervisor.start(processes.router(here))
        wait_for_router(here, stop)
        supervise(supervisor, programs, stop, Reminder(model, time.monotonic()))


def supervise(supervisor: Supervisor, programs: list[Program], stop: threading.Event, reminder: Reminder) -> None:
    """Keep programs running until stopped; fail where one cannot be used as it is set."""
    for program in programs:
        supervisor.start(program)
    try:
        while not stop.wait(CHECK_S):
            for line in (*supervisor.restart_ended(), *reminder.lines(time.monotonic())):
                say(line, style="yellow")
    except UnusableError as error:
        fail(str(error))
