"""Runs a node, a source or a front as this process's service: connects, serves, and ends cleanly."""

import gc
import logging
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext
from typing import Protocol, TypeVar

import zenoh
from pydantic import ValidationError

from actum.command_line import from_command_line
from actum.installing import install_command
from actum.node import Node, Source
from actum.runtime.client import Client
from actum.runtime.outbox import Outbox
from actum.runtime.place import RETURNING_S, SETTLING_S, PlaceTakenError
from actum.runtime.resuming import check_state_folder
from actum.runtime.service import SourceService
from actum.runtime.session import RETRY_S, open_session, secret_config
from actum.runtime.several import Served, end_at_bugs, name_sensors, serve_all
from actum.runtime.sharing import SharingService
from actum.runtime.step_service import NodeService
from actum.runtime.stopping import end_with_parent, stop_on_signals
from actum.settings import ServiceSettings, SettingsError, SharedSettings, complaint

log = logging.getLogger("actum")
S = TypeVar("S", bound=ServiceSettings)
N = TypeVar("N")
UNUSABLE = 2
"""Exit code of a process whose settings cannot be used."""
COLLECTION = (5_000, 4, 100)
"""When Python's collector looks for cycles: among its newest objects once so many were made; after every four of these
searches also among older ones; and after a hundred of those among all. With crowds there are a million objects, and to
search all of them stops the service for a tenth of a second. By Python's own limits that would be every second."""
TAKEN = 3
"""Exit code of a process whose service another process runs already."""
INTERRUPTED = 130
"""Exit code of a process that SIGINT ends while it starts, as shells have it."""


@contextmanager
def needs_extra(name: str) -> Iterator[None]:
    """Return a context in which to import the packages of an extra: if one is missing, say so and exit with code 2.

    An interrupt ends the process without a traceback.

    Raises:
        ModuleNotFoundError: a submodule of an installed package is missing, which is a bug.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        if "." in (error.name or "."):
            raise
        print(f"{error.name} is not installed: run {install_command(name)}", file=sys.stderr)
        sys.exit(UNUSABLE)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)


class Front(Node, Protocol):
    """A node with a thread of its own, such as a server's or a voice's, which runs also while there is no router."""

    def serving(self) -> AbstractContextManager[None]:
        """Run the thread until the context is left."""
        ...

    def attach(self, client: Client | None) -> None:
        """Take the session by which people's wishes go to other services; None where there is none any more."""
        ...

    @property
    def working(self) -> bool:
        """Whether the thread runs."""
        ...


class FrontService(NodeService):
    """Runs a front: gives it messages as any node gets them, and the session to put and ask by."""

    def __init__(self, front: Front, settings: ServiceSettings) -> None:
        super().__init__(front, settings)
        self._front = front

    def _work(self, session: zenoh.Session, outbox: Outbox, stop: threading.Event, vacant_s: float) -> None:
        self._front.attach(Client(self._settings, session=session))
        try:
            super()._work(session, outbox, stop, vacant_s)
        finally:
            self._front.attach(None)

    @property
    def is_healthy(self) -> bool:
        """Whether its subscriptions are read, and its thread runs."""
        return super().is_healthy and self._front.working


def run(settings_type: type[S], build: Callable[[S], Node], flags: Sequence[str] | None = None) -> None:
    """Run a node as this process's service until SIGTERM or SIGINT, set by this process's flags or given ones.

    Where the settings name several sensors, there is a node for each of them, and one session. Where these are shared
    with other processes, a node works only while its sensor is this process's.
    """
    settings, nodes = configured(settings_type, _for_each_sensor(build), flags)
    shares = isinstance(settings, SharedSettings) and settings.share
    live([_sharing(node, build, own) if shares else NodeService(node, own) for node, own in nodes], settings)


def _sharing(node: Node, build: Callable[[S], Node], settings: S) -> SharingService:
    return SharingService(node, lambda: build(settings), settings)


def run_source(settings_type: type[S], build: Callable[[S], Source]) -> None:
    """Run a source as this process's service until SIGTERM or SIGINT."""
    settings, source = configured(settings_type, build)
    live([SourceService(source, settings)], settings)


def run_front(settings_type: type[S], build: Callable[[S], Front]) -> None:
    """Run a front for each sensor as this process's service until SIGTERM or SIGINT."""
    settings, fronts = configured(settings_type, _for_each_sensor(build))

    @contextmanager
    def serving() -> Iterator[None]:
        with ExitStack() as threads:
            for front, _ in fronts:
                threads.enter_context(front.serving())
            yield

    live([FrontService(front, own) for front, own in fronts], settings, serving)


def _for_each_sensor(build: Callable[[S], N]) -> Callable[[S], list[tuple[N, S]]]:
    """Return what builds one for each sensor that settings name, and returns it with its own settings."""
    return lambda settings: [(build(own), own) for own in settings.of_each_sensor]


def configured(settings_type: type[S], build: Callable[[S], N], flags: Sequence[str] | None = None) -> tuple[S, N]:
    """Read the settings, from this process's flags or given ones, and build; if unusable, say why and exit with 2.

    An interrupt ends the process without a traceback.
    """
    end_with_parent()
    service = settings_type.__module__.partition(".")[0]
    try:
        settings = from_command_line(settings_type, f"python -m {service}", flags)
        log_level()
        secret_config(settings)  # a wrong one is refused now, before the build, which may take long
        check_state_folder(settings)
        return settings, build(settings)
    except ValidationError as error:
        print(f"{service}: {complaint(error)} (see --help)", file=sys.stderr)
    except ValueError as error:
        print(f"{service}: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        sys.exit(INTERRUPTED)
    sys.exit(UNUSABLE)


def log_level() -> str:
    """Return the level of the log that `ACTUM_LOG` names, `INFO` where it names none.

    Raises:
        SettingsError: there is no such level.
    """
    named = os.environ.get("ACTUM_LOG") or "INFO"
    if named.upper() not in logging.getLevelNamesMapping():
        raise SettingsError(f"ACTUM_LOG: {named!r} is not a log level: use DEBUG, INFO, WARNING or ERROR")
    return named.upper()


def live(
    services: Sequence[Served],
    settings: ServiceSettings,
    beside: Callable[[], AbstractContextManager[None]] = nullcontext,
) -> None:
    """Connect, serve until SIGTERM or SIGINT, and exit: with code 0, 1 after a bug, 3 where another runs already.

    The services are those of one name, each for a sensor. `beside` is entered before there is a router, and left at
    the end.
    """
    logging.basicConfig(level=log_level(), format=f"{services[0].name}: %(message)s")
    stop = stop_on_signals()
    if len(services) > 1:
        name_sensors(settings.sensor.split(","))
    end_at_bugs(services, stop)
    for service in services:
        service.introduce()
    with beside():
        _serve(services, settings, stop)
    sys.exit(1 if any(service.failed for service in services) else 0)


def _serve(services: Sequence[Served], settings: ServiceSettings, stop: threading.Event) -> None:
    began_s = time.monotonic()
    session = open_session(settings, stop)
    if session is None:
        return
    settling_s = SETTLING_S if time.monotonic() - began_s < RETRY_S else RETURNING_S
    gc.freeze()  # objects that exist now live as long as the process: collections need not visit them again
    gc.set_threshold(*COLLECTION)
    try:
        serve_all(services, session, stop, settling_s)
    except PlaceTakenError as error:
        log.error("%s", error)
        sys.exit(TAKEN)
    finally:
        session.close()
