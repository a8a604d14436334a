"""`actum up` and `actum router`: the whole system, or its router alone."""

import logging
import socket
import tempfile
import threading
import time
from pathlib import Path
from typing import Annotated

import typer

from actum.runtime import Client, RouterUnreachableError, serve_router, stop_on_signals
from actum.settings import DEFAULT_ENDPOINT, ServiceSettings, SettingsError, host_and_port
from actum_command import processes
from actum_command.context import fail, say, settings
from actum_command.service_flags import DECLARED, Given, arguments_of, flag_of, with_service_flags
from actum_command.supervising import Program, Supervisor, UnusableError
from som_classifier.model_loading import ModelError, load_model

CHECK_S = 0.2
ROUTER_S = 5.0
NO_FILES = {
    "simulator": "--source recording",
    "none": "--source recording",
    "camera": "a video file in ACTUM_CAMERA",
}
NO_CAMERA = ("simulator", "recording")
NO_MARKS = "nobody marks actions here: 'actum segment toggle' does, and 'actum play' beside --source none"
NO_MODEL = (
    "no --model: every action is answered with 'no model'. For the simulated scene: "
    "actum simulate examples.mcap; actum train examples.mcap -o model.npz; actum up --model model.npz"
)


def router(
    listen: Annotated[str | None, typer.Option(help=f"endpoint; default {DEFAULT_ENDPOINT} unless --config")] = None,
    config: Annotated[Path | None, typer.Option(help="a Zenoh JSON5 configuration", exists=True)] = None,
) -> None:
    """Run the embedded Zenoh router."""
    logging.basicConfig(level="INFO", format="router: %(message)s")
    endpoint = listen or (None if config else settings().connect)
    if endpoint is not None:
        refuse_taken(endpoint)
    try:
        serve_router(endpoint, config, stop_on_signals())
    except SettingsError as error:
        fail(str(error))


@with_service_flags
def up(
    source: Annotated[
        str | None,
        typer.Option(
            help="simulator, camera, realsense, openni2, recording or none; default: camera "
            "where --camera names one, else simulator"
        ),
    ] = None,
    path: Annotated[Path | None, typer.Option(help="what a source from files plays")] = None,
    model: Annotated[
        Path | None, typer.Option(help="the model; it may come or change later", envvar="ACTUM_MODEL")
    ] = None,
    *,
    given: Given,
) -> None:
    """Run router and all services here, restart what ends, until Ctrl-C."""
    here = settings()
    source = _source(source, given)
    refuse_taken(here.connect)
    if path is not None and source in NO_FILES:
        fail(f"source {source} takes no --path: to have {path} played, name {NO_FILES[source]}")
    objects = processes.simulated_objects() if source == "simulator" else {}
    programs = processes.services(here, model, objects, given)
    if source == "simulator":
        programs += [processes.simulator(here, arguments_of("scene_simulator", given)), processes.scene(here)]
    elif source != "none":
        play = ["--path", str(path)] if path else []
        programs.append(processes.gateway(here, ["--source", source, *play, *arguments_of("sensor_gateway", given)]))
    say(f"actum starts on {here.connect}, sensor {here.sensor}: try 'actum watch'; Ctrl-C ends")
    if source != "simulator":
        say(NO_MARKS)
    _tell_lack_of(model)
    stop = stop_on_signals()
    with Supervisor() as supervisor:
        supervisor.start(processes.router(here))
        _wait_for_router(here, stop)
        supervise(supervisor, programs, stop)


def _source(named: str | None, given: Given) -> str:
    """Tell which source is meant, or fail where what is given would be told to nobody."""
    source = named or ("camera" if "camera" in given else "simulator")
    if "camera" in given and source in NO_CAMERA:
        fail(f"source {source} takes no --camera: leave --source out, or name camera")
    sensor = {"none": [], "simulator": ["scene_simulator"]}.get(source, ["sensor_gateway"])
    heard = {name for service in (*processes.SERVICES, *sensor) for name in DECLARED[service].model_fields}
    for name in given.keys() - heard:
        service = next(service for service, settings in DECLARED.items() if name in settings.model_fields)
        fail(f"{flag_of(name)} is a setting of {service}, which --source {source} does not start")
    return source


def supervise(supervisor: Supervisor, programs: list[Program], stop: threading.Event) -> None:
    """Keep programs running until stopped."""
    for program in programs:
        supervisor.start(program)
    while not stop.wait(CHECK_S):
        restart_ended(supervisor)


def restart_ended(supervisor: Supervisor) -> None:
    """Restart what has ended and say so; fail when it cannot be used as it is set."""
    try:
        ended = supervisor.check()
    except UnusableError as error:
        fail(str(error))
    for line in ended:
        say(line, style="yellow")


def _tell_lack_of(model: Path | None) -> None:
    """Say so where there is no model that can be used yet."""
    if model is None:
        say(NO_MODEL, style="yellow")
    elif not model.exists():
        say(f"no {model} yet: every action is answered with 'no model' until it is there", style="yellow")
    else:
        try:
            load_model(model)
        except ModelError as error:
            say(str(error), style="yellow")


def _wait_for_router(here: ServiceSettings, stop: threading.Event) -> None:
    """Give the router time to come up, so that the services find it at once; if it does not, they wait for it."""
    deadline_s = time.monotonic() + ROUTER_S
    while time.monotonic() < deadline_s and not stop.wait(CHECK_S):
        try:
            with Client(here, wait_s=0):
                return
        except RouterUnreachableError:
            continue
        except SettingsError as error:
            fail(str(error))


def refuse_taken(endpoint: str) -> None:
    """Fail if nothing can listen where the router is to listen, or something already does."""
    try:
        address = host_and_port(endpoint)
        if address is not None and endpoint.startswith("tcp/"):
            _bind(*address)
    except SettingsError as error:
        fail(str(error))
    except OSError as error:
        fail(f"{endpoint} cannot be listened on ({error.strerror}): stop what runs there or set ACTUM_CONNECT")


def _bind(host: str, port: int) -> None:
    """Take an address for a moment, of whichever family it is."""
    family, kind, protocol, _, place = socket.getaddrinfo(
        host or "0.0.0.0", port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
    )[0]
    with socket.socket(family, kind, protocol) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        probe.bind(place)


def log_file(name: str, here: ServiceSettings) -> Path:
    """Where the output of background processes goes."""
    return Path(tempfile.gettempdir()) / f"actum-{name}-{here.instance}.log"
