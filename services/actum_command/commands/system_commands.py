"""`actum up`, `actum router` and `actum ros2`: the whole system, its router alone, or its bridge to ROS 2."""

import logging
import threading
import time
from pathlib import Path
from typing import Annotated, get_args

import typer
from pydantic import ValidationError

from actum.installing import install_command
from actum.runtime import needs_extra, run_bridge, serve_router, stop_on_signals
from actum.settings import DEFAULT_ENDPOINT, NodeSettings, ServiceSettings, SettingsError, complaint, host_and_port
from actum_command import processes
from actum_command.commands.service_flags import with_flags_of
from actum_command.commands.terminal import fail, failing_on, say, settings
from actum_command.model_in_use import ModelInUse, Reminder, model_in_use
from actum_command.service_settings import BRIDGE, DECLARED, Given, arguments_of
from actum_command.startup import (
    CHECK_S,
    chosen_source,
    how_found,
    lack_of_model,
    refuse_marks,
    refuse_shared_source,
    refuse_taken,
    segments_of,
    source_of,
    wait_for_router,
    with_page_ports,
)
from actum_command.supervising import Program, Supervisor, UnusableError
from ros2_bridge.settings import Settings as BridgeSettings
from sensor_gateway.settings import SourceName

SOURCES = [name for name in get_args(SourceName) if name != "marker-camera"]
"""The sources of the gateway that `actum up` can start: a marker camera runs only beside another source."""


def router(
    listen: Annotated[
        str | None,
        typer.Option(
            help=(
                "address to listen on; default: the address that the --config file or ACTUM_CONNECT sets, otherwise "
                f"{DEFAULT_ENDPOINT}"
            )
        ),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(
            help=(
                "a configuration file for the Zenoh router (JSON5). Default: the configuration that is built into actum"
            ),
            exists=True,
        ),
    ] = None,
    credentials: Annotated[
        Path | None,
        typer.Option(
            help=(
                "the folder with the certificate and key of this router, as written by 'actum deploy'; default: no TLS"
            ),
            envvar="ACTUM_CREDENTIALS",
        ),
    ] = None,
    link: Annotated[
        str | None,
        typer.Option(
            help=(
                "address of the router on another host, such as tcp/192.168.1.6:7447. The two routers connect, so that "
                "programs on both hosts exchange messages. Default: no connection to another router"
            )
        ),
    ] = None,
) -> None:
    """Run only the Zenoh router, for services that are started one by one or on several hosts.

    Do not run this command beside 'actum up', which starts its own router. With --credentials, the router restarts
    itself when its certificate is renewed.
    """
    logging.basicConfig(level="INFO", format="router: %(message)s")
    here = settings()
    endpoint = listen or (None if config else here.connect)
    with failing_on(SettingsError):
        if link is not None:
            host_and_port(link)
        if endpoint is not None:
            refuse_taken(endpoint)
        serve_router(endpoint, config, stop_on_signals(), credentials, here.health_file, link)


@with_flags_of(*DECLARED)
def up(
    source: Annotated[
        str | None,
        typer.Option(
            help=f"where skeletons come from: {', '.join(SOURCES)}, simulator (a simulated person), or none (another "
            "program publishes skeletons). Default: camera if --camera is given, otherwise simulator"
        ),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            help=(
                "the model file (.npz). The classifier loads this file as soon as the file exists, and again whenever "
                "the file changes. Default: the model that was last chosen on the web page. If no model was chosen "
                "there, simulated scenes use the model supplied with actum, and no action is recognised from a camera"
            ),
            envvar="ACTUM_MODEL",
        ),
    ] = None,
    marked: Annotated[
        bool,
        typer.Option(
            "--marked",
            help=(
                "mark the start and end of each action of the simulated person. Default: no marks, so the classifier "
                "has to find the actions by itself"
            ),
        ),
    ] = False,
    page: Annotated[
        bool, typer.Option("--page/--no-page", help="serve the web page and print its address; default: on")
    ] = True,
    *,
    given: Given,
) -> None:
    """Run the whole system on this machine until Ctrl-C: the router, all services and the web page.

    Without options, the system shows a simulated scene; use --camera 0 for a webcam. If a service ends, the command
    starts the service again.

    For two cameras, use --sensors left,right --camera 0 --camera 2. Each sensor then has its own camera and web page;
    every other service serves both sensors. An option of the camera or of the web page applies to all sensors if the
    option occurs once. To give each sensor a value of its own, repeat the option in the order of --sensors. Simulated
    scenes of several sensors have different seeds.
    """
    here = settings(NodeSettings)
    if here.credentials is not None:
        fail("'actum up' starts its own router and services, which use no credentials: unset ACTUM_CREDENTIALS")
    try:
        source = chosen_source(source, given)
        refuse_shared_source(source, given, here)
        segments = segments_of(given)
        refuse_marks(marked, source, segments)
        refuse_taken(here.connect)
        with model_in_use(model, source, given) as chosen:
            programs = processes.system(here, source, chosen, given)
            programs += processes.scenes(here) if marked else []
            say(_greeting(here))
            _introduce(chosen, segments, marked)
            if page:
                programs = processes.with_page(here, programs, with_page_ports(given, here))
                if programs[-1].module != processes.PAGE:
                    say(f"no web page: run {install_command('web-dashboard')}", style="yellow")
            run(here, programs, chosen)
    except (SettingsError, ValidationError) as error:
        fail(complaint(error))


def _greeting(here: ServiceSettings) -> str:
    """Return the first line that is printed: what starts where, and a command to try."""
    each = [own.sensor for own in here.of_each_sensor]
    several = len(each) > 1
    what = f"sensors {', '.join(each)}" if several else f"sensor {here.sensor}"
    command = f"actum watch --sensor {each[0]}" if several else "actum watch"
    return f"actum starts on {here.connect}, {what}: try '{command}'; Ctrl-C ends"


def _introduce(model: ModelInUse, segments: str, marked: bool) -> None:
    """Print how actions are found, which model is used, and what is missing."""
    say(how_found(segments, marked))
    if (model.original or model.file).exists():
        say(f"model: {source_of(model)}")
    if (lack := lack_of_model(model, segments, marked)) is not None:
        say(lack, style="bold yellow")


def run(here: ServiceSettings, programs: list[Program], model: ModelInUse) -> None:
    """Run a router and programs until stopped."""
    stop = stop_on_signals()
    with Supervisor() as supervisor:
        supervisor.start(processes.router(here))
        wait_for_router(here, stop)
        supervise(supervisor, programs, stop, Reminder(model, time.monotonic()))


def supervise(supervisor: Supervisor, programs: list[Program], stop: threading.Event, reminder: Reminder) -> None:
    """Keep programs running until stopped; fail where one cannot be used as it is set."""
    supervisor.start(*programs)
    with failing_on(UnusableError):
        while not stop.wait(CHECK_S):
            for line in (*supervisor.restart_ended(), *reminder.lines(time.monotonic())):
                say(line, style="yellow")


@with_flags_of(BRIDGE)
def ros2(*, given: Given) -> None:
    """Exchange messages with ROS 2 until Ctrl-C: publish skeletons, objects and events; receive start and end marks.

    The ROS 2 nodes must use rmw_zenoh and the same Zenoh router (--connect). ROS 2 need not be installed on this
    machine.
    """
    with needs_extra("ros2"):
        from ros2_bridge.bridge import Ros2Bridge
    run_bridge(BridgeSettings, Ros2Bridge, arguments_of(BRIDGE, given))
